#include "polygonize/off.h"

#include <optional>

#include "polygonize/mesh_input.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// Goes to the next line that holds something but a comment, and returns its first word; empty at
/// the end.
std::string_view first_word_of_next_line(TextCursor& cursor) {
  while (cursor.next_line()) {
    const std::string_view word = cursor.word();
    if (!word.empty() && word[0] != '#') return word;
  }
  return {};
}

class OffReader {
 public:
  OffReader(std::string_view text, const std::string& file) : cursor_(text), file_(file) {}

  Result<Model> read() {
    if (!counts() || !vertices() || !faces()) return error_at({file_, cursor_.line()}, error_);
    return split_into_parts(std::move(output_), stem_of(file_));
  }

 private:
  bool fail(const char* message) {
    error_ = message;
    return false;
  }

  bool counts() {
    std::string_view word = first_word_of_next_line(cursor_);
    if (word != "OFF" && word != "COFF" && word != "NOFF" && word != "CNOFF" && word != "STOFF") {
      return fail("not an ASCII OFF file");
    }
    word = cursor_.word();  // the counts may stand on the line of the keyword
    if (word.empty() || word[0] == '#') word = first_word_of_next_line(cursor_);
    const auto vertices = parse_integer(word), faces = parse_integer(cursor_.word());
    if (!vertices || !faces || *vertices < 0 || *faces < 0) {
      return fail("the counts of vertices and faces are missing");
    }
    if (static_cast<std::uint64_t>(*vertices) > kMostVertices) return fail("too many vertices");
    vertex_count_ = *vertices;
    face_count_ = *faces;
    return true;
  }

  bool vertices() {
    TriangleMesh& mesh = output_.mesh;
    for (std::int64_t i = 0; i < vertex_count_; ++i) {
      std::string_view word = first_word_of_next_line(cursor_);
      Vec3d p;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::optional<double> value = read_decimal(word);
        if (!value) return fail("a vertex needs three finite numbers");
        p[axis] = *value;
        if (axis < 2) word = cursor_.word();
      }
      mesh.positions.push_back(p);
    }
    return true;
  }

  bool faces() {
    std::vector<Index> corners;
    for (std::int64_t i = 0; i < face_count_; ++i) {
      const auto count = parse_integer(first_word_of_next_line(cursor_));
      if (!count || *count < 0) return fail("a face needs the number of its corners");
      corners.clear();
      for (std::int64_t k = 0; k < *count; ++k) {
        const auto index = parse_integer(cursor_.word());
        if (!index || *index < 0 || *index >= vertex_count_) {
          return fail("a face has an index that is no vertex");
        }
        corners.push_back(static_cast<Index>(*index));
      }
      append_fan(output_.mesh, corners);
    }
    return true;
  }

  TextCursor cursor_;
  const std::string& file_;
  std::string error_;
  std::int64_t vertex_count_ = 0, face_count_ = 0;
  SharedVertexMesh output_;
};

}  // namespace

Result<Model> read_off(std::string_view text, const std::string& file) {
  return OffReader(text, file).read();
}

}  // namespace cs2mesh
