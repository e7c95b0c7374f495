// What the readers of mesh files share. Files come from any tool and may be broken: nothing here
// trusts a count, and memory stays proportional to the size of the file.
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libfield/base/result.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// The bytes of a file. Errors: there is none, it cannot be read.
Result<std::string> read_file_bytes(const std::string& path);

/// The lines of a text, each cut into words at blanks.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : rest_(text) {}

  /// Goes to the next line; false at the end. Line ends are LF, CR LF or CR.
  bool next_line();
  /// The next word of the current line, empty at its end.
  std::string_view word();
  /// What is left of the current line, without blanks at either end.
  std::string_view rest_of_line();
  /// The next word of this or a later line, empty at the end of the text.
  std::string_view word_of_any_line();

  int line() const { return line_; }  ///< counts from 1
  /// Bytes after the current line.
  std::string_view remaining() const { return rest_; }

 private:
  std::string_view rest_;
  std::string_view current_;
  int line_ = 0;
};

/// Decimal numbers, independent of the locale; the whole word must be one. A leading + is allowed;
/// what is too small for a double is 0, what is too large or no number is nothing.
std::optional<double> read_decimal(std::string_view word);
std::optional<std::int64_t> parse_integer(std::string_view word);

/// Little-endian or big-endian numbers out of a block of bytes.
template <class T>
T decode(const char* bytes, bool big_endian = false) {
  char copy[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) copy[i] = bytes[big_endian ? sizeof(T) - 1 - i : i];
  T value;
  std::memcpy(&value, copy, sizeof(T));
  return value;
}

/// A mesh as most formats have it: one list of vertices, and faces that belong to named parts.
struct SharedVertexMesh {
  TriangleMesh mesh;
  std::vector<std::string> names{""};  ///< of the parts
  std::vector<std::uint32_t> part_of;  ///< for each triangle; empty: all in part 0
};

/// Makes the parts separate meshes, in the order of names, leaving out those without triangles.
/// Parts that share a vertex become one, under the first name: a closed part cannot share one, so
/// they are regions of one surface. A mesh of one part keeps its vertices as they are, used or not;
/// unnamed parts are called `fallback_name`.
Model split_into_parts(SharedVertexMesh input, const std::string& fallback_name);

/// Makes vertices at equal positions one (the first), for formats that must repeat them. Normals or
/// colours are dropped where vertices that meet disagree on them.
void merge_equal_vertices(TriangleMesh& mesh);

/// Appends a polygon as a fan from its first corner; nothing for fewer than three corners.
void append_fan(TriangleMesh& mesh, const std::vector<TriangleMesh::Index>& corners);

/// The most vertices an index can tell apart.
inline constexpr std::size_t kMostVertices = std::numeric_limits<TriangleMesh::Index>::max();

/// File name without folders and extension: the name of a mesh whose file gives none.
std::string stem_of(const std::string& path);

}  // namespace cs2mesh
