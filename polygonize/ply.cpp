#include "polygonize/ply.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "libfield/base/atomic_file.h"
#include "libfield/base/color.h"
#include "polygonize/mesh_input.h"
#include "polygonize/mesh_output.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

// ---- Writing ----

std::string header(const Model& model, bool normals, bool colors) {
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment written by cs2mesh\n";
  std::size_t first_face = 0;
  for (const MeshPart& part : model.parts) {
    out += "comment part " + printable_name(part.name) + ' ' + std::to_string(first_face) + ' ' +
           std::to_string(part.mesh.triangles.size()) + '\n';
    first_face += part.mesh.triangles.size();
  }
  out += "element vertex " + std::to_string(model.vertex_count()) + '\n';
  for (const char* name : {"x", "y", "z"}) out += std::string("property double ") + name + '\n';
  if (normals) out += "property float nx\nproperty float ny\nproperty float nz\n";
  if (colors) out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  out += "element face " + std::to_string(model.triangle_count()) + '\n';
  return out + "property list uchar uint vertex_indices\nend_header\n";
}

void append_vertex(std::string& out, const TriangleMesh& mesh, std::size_t i, bool normals,
                   bool colors) {
  for (std::size_t axis = 0; axis < 3; ++axis) append_little_endian(out, mesh.positions[i][axis]);
  for (std::size_t axis = 0; normals && axis < 3; ++axis) {
    append_little_endian(out, mesh.normals[i][axis]);
  }
  for (std::size_t axis = 0; colors && axis < 3; ++axis) {
    const double coded = linear_to_srgb(std::clamp<double>(mesh.colors[i][axis], 0, 1));
    append_little_endian(out, static_cast<std::uint8_t>(std::lround(255 * coded)));
  }
}

// ---- Reading ----

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Type> type_named(std::string_view word) {
  constexpr std::pair<std::string_view, Type> kTypes[] = {
      {"char", Type::int8},      {"int8", Type::int8},       {"uchar", Type::uint8},
      {"uint8", Type::uint8},    {"short", Type::int16},     {"int16", Type::int16},
      {"ushort", Type::uint16},  {"uint16", Type::uint16},   {"int", Type::int32},
      {"int32", Type::int32},    {"uint", Type::uint32},     {"uint32", Type::uint32},
      {"float", Type::float32},  {"float32", Type::float32}, {"double", Type::float64},
      {"float64", Type::float64}};
  for (const auto& [name, type] : kTypes) {
    if (name == word) return type;
  }
  return std::nullopt;
}

std::size_t size_of(Type type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

struct Property {
  std::string name;
  Type type = Type::float32;
  std::optional<Type> count_type;  ///< set for lists
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  std::optional<std::size_t> find(std::string_view property) const {
    for (std::size_t i = 0; i < properties.size(); ++i) {
      if (properties[i].name == property) return i;
    }
    return std::nullopt;
  }
};

struct PartRange {
  std::string name;
  std::uint64_t first = 0, count = 0;
};

struct Header {
  enum class Format { none, ascii, little, big } format = Format::none;
  std::vector<PlyElement> elements;
  std::vector<PartRange> parts;
};

/// Where the numbers of the body come from.
class NumberSource {
 public:
  NumberSource(TextCursor cursor, Header::Format format)
      : cursor_(cursor), bytes_(cursor.remaining()), format_(format) {}

  bool next(Type type, double& out) {
    if (format_ == Header::Format::ascii) {
      const std::optional<double> value = read_decimal(cursor_.word_of_any_line());
      if (value) out = *value;
      return value.has_value();
    }
    if (bytes_.size() < size_of(type)) return false;
    out = read(type, bytes_.data(), format_ == Header::Format::big);
    bytes_.remove_prefix(size_of(type));
    return true;
  }
  int line() const { return format_ == Header::Format::ascii ? cursor_.line() : 0; }

 private:
  static double read(Type type, const char* at, bool big) {
    switch (type) {
      case Type::int8:
        return decode<std::int8_t>(at, big);
      case Type::uint8:
        return decode<std::uint8_t>(at, big);
      case Type::int16:
        return decode<std::int16_t>(at, big);
      case Type::uint16:
        return decode<std::uint16_t>(at, big);
      case Type::int32:
        return decode<std::int32_t>(at, big);
      case Type::uint32:
        return decode<std::uint32_t>(at, big);
      case Type::float32:
        return decode<float>(at, big);
      case Type::float64:
        break;
    }
    return decode<double>(at, big);
  }

  TextCursor cursor_;
  std::string_view bytes_;
  Header::Format format_;
};

class PlyReader {
 public:
  PlyReader(std::string_view bytes, const std::string& file) : cursor_(bytes), file_(file) {}

  Result<Model> read() {
    if (!cursor_.next_line() || cursor_.word() != "ply") {
      return error_at({file_, 1}, "not a PLY file: it does not begin with 'ply'");
    }
    if (!read_header()) return error_at({file_, cursor_.line()}, error_);
    NumberSource source(cursor_, header_.format);
    for (const PlyElement& element : header_.elements) {
      if (!read_element(element, source)) return error_at({file_, source.line()}, error_);
    }
    if (!has_vertices_) return error_at({file_}, "no element vertex");
    if (!check_indices()) return error_at({file_}, error_);
    if (output_.mesh.normals.size() != output_.mesh.positions.size()) output_.mesh.normals.clear();
    if (output_.mesh.colors.size() != output_.mesh.positions.size()) output_.mesh.colors.clear();
    assign_parts();
    return split_into_parts(std::move(output_), stem_of(file_));
  }

 private:
  bool fail(std::string message) {
    error_ = std::move(message);
    return false;
  }

  bool read_header() {
    while (cursor_.next_line()) {
      const std::string_view keyword = cursor_.word();
      bool good = true;
      if (keyword == "end_header") {
        return header_.format != Header::Format::none || fail("the header has no format line");
      }
      if (keyword == "format") {
        good = read_format();
      } else if (keyword == "comment") {
        read_comment();
      } else if (keyword == "element") {
        good = read_element_line();
      } else if (keyword == "property") {
        good = read_property_line();
      }
      if (!good) return false;
    }
    return fail("the header has no end");
  }

  bool read_format() {
    const std::string_view word = cursor_.word();
    if (word == "ascii") {
      header_.format = Header::Format::ascii;
    } else if (word == "binary_little_endian") {
      header_.format = Header::Format::little;
    } else if (word == "binary_big_endian") {
      header_.format = Header::Format::big;
    } else {
      return fail("unknown format '" + std::string(word.substr(0, 40)) + "'");
    }
    return true;
  }

  void read_comment() {
    if (cursor_.word() != "part") return;
    const std::string_view text = cursor_.rest_of_line();
    const std::size_t last = text.rfind(' ');
    if (last == std::string_view::npos || last == 0) return;
    const std::size_t middle = text.rfind(' ', last - 1);
    if (middle == std::string_view::npos) return;
    const auto first = parse_integer(text.substr(middle + 1, last - middle - 1));
    const auto count = parse_integer(text.substr(last + 1));
    if (!first || !count || *first < 0 || *count < 0) return;
    header_.parts.push_back({std::string(text.substr(0, middle)),
                             static_cast<std::uint64_t>(*first),
                             static_cast<std::uint64_t>(*count)});
  }

  bool read_element_line() {
    PlyElement element;
    element.name = std::string(cursor_.word());
    const auto count = parse_integer(cursor_.word());
    if (!count || *count < 0) return fail("an element needs a name and a count");
    element.count = static_cast<std::uint64_t>(*count);
    header_.elements.push_back(std::move(element));
    return true;
  }

  bool read_property_line() {
    if (header_.elements.empty()) return fail("a property before the first element");
    Property property;
    std::string_view word = cursor_.word();
    if (word == "list") {
      property.count_type = type_named(cursor_.word());
      if (!property.count_type) return fail("a list needs a type for its count");
      word = cursor_.word();
    }
    const std::optional<Type> type = type_named(word);
    if (!type) return fail("unknown type '" + std::string(word.substr(0, 40)) + "'");
    property.type = *type;
    property.name = std::string(cursor_.word());
    header_.elements.back().properties.push_back(std::move(property));
    return true;
  }

  bool read_element(const PlyElement& element, NumberSource& source) {
    if (element.properties.empty()) return true;  // rows without bytes
    const bool vertices = element.name == "vertex" && !has_vertices_;
    const bool faces = element.name == "face";
    std::size_t x[9];  // x y z, nx ny nz, red green blue
    if (vertices && !vertex_columns(element, x)) return false;
    std::optional<std::size_t> indices;
    if (faces) {
      indices = element.find("vertex_indices");
      if (!indices) indices = element.find("vertex_index");
      if (!indices || !element.properties[*indices].count_type) {
        return fail("the faces have no list vertex_indices");
      }
    }
    // The loop is bounded by the bytes: a row takes at least one, and an end of file ends it.
    std::vector<double> row(element.properties.size());
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t k = 0; k < row.size(); ++k) {
        const bool wanted = indices && k == *indices;
        if (!read_property(element.properties[k], source, row[k], wanted)) return false;
      }
      if (vertices && !add_vertex(element, row, x)) return false;
      if (faces) append_fan(output_.mesh, corners_);
      if (faces) face_end_.push_back(output_.mesh.triangles.size());
    }
    has_vertices_ = has_vertices_ || vertices;
    return true;
  }

  bool read_property(const Property& property, NumberSource& source, double& value, bool wanted) {
    const auto missing = [&] {
      return fail("the file ends too early, or something is no number, in property " +
                  property.name);
    };
    if (!property.count_type) return source.next(property.type, value) || missing();
    double count = 0;
    if (!source.next(*property.count_type, count)) return missing();
    if (!(count >= 0) || count != std::floor(count)) return fail("a list has a negative length");
    if (wanted) corners_.clear();
    for (double k = 0; k < count; ++k) {
      double item = 0;
      if (!source.next(property.type, item)) return missing();
      if (!wanted) continue;
      if (!(item >= 0 && item < static_cast<double>(kMostVertices)) || item != std::floor(item)) {
        return fail("a face has an index that is no vertex");
      }
      corners_.push_back(static_cast<Index>(item));
    }
    return true;
  }

  bool vertex_columns(const PlyElement& element, std::size_t (&x)[9]) {
    constexpr const char* kNames[9] = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"};
    for (int i = 0; i < 9; ++i) {
      const std::optional<std::size_t> column = element.find(kNames[i]);
      if (i < 3 && !column) return fail(std::string("the vertices have no ") + kNames[i]);
      x[i] = column.value_or(kNoColumn);
    }
    return true;
  }

  bool add_vertex(const PlyElement& element, const std::vector<double>& row,
                  const std::size_t (&x)[9]) {
    TriangleMesh& mesh = output_.mesh;
    const Vec3d p{row[x[0]], row[x[1]], row[x[2]]};
    if (!is_finite(p)) return fail("a coordinate is not finite");
    if (mesh.positions.size() >= kMostVertices) return fail("too many vertices");
    mesh.positions.push_back(p);
    const auto has = [&](int first) {
      return x[first] != kNoColumn && x[first + 1] != kNoColumn && x[first + 2] != kNoColumn;
    };
    if (has(3)) mesh.normals.push_back(Vec3<float>(Vec3d(row[x[3]], row[x[4]], row[x[5]])));
    if (has(6)) {
      Vec3d color;
      for (std::size_t i = 0; i < 3; ++i) {
        const Type type = element.properties[x[6 + i]].type;
        const double full = type == Type::uint8 ? 255 : type == Type::uint16 ? 65535 : 1;
        color[i] = srgb_to_linear(std::clamp(row[x[6 + i]] / full, 0.0, 1.0));
      }
      mesh.colors.push_back(Vec3<float>(color));
    }
    return true;
  }

  bool check_indices() {
    const std::size_t count = output_.mesh.positions.size();
    for (const auto& triangle : output_.mesh.triangles) {
      if (*std::max_element(triangle.begin(), triangle.end()) >= count) {
        return fail("a face has an index that is no vertex");
      }
    }
    return true;
  }

  /// Uses the part comments if they describe all faces in order, and only then.
  void assign_parts() {
    std::uint64_t expected = 0;
    for (const PartRange& part : header_.parts) {
      if (part.first != expected || part.count > face_end_.size() - expected) return;
      expected += part.count;
    }
    if (header_.parts.empty() || expected != face_end_.size()) return;
    output_.names.clear();
    std::uint64_t face = 0;
    for (const PartRange& part : header_.parts) {
      const auto index = static_cast<std::uint32_t>(output_.names.size());
      output_.names.push_back(part.name);
      face += part.count;
      output_.part_of.resize(face == 0 ? 0 : face_end_[face - 1], index);
    }
  }

  static constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

  TextCursor cursor_;
  const std::string& file_;
  std::string error_;
  Header header_;
  SharedVertexMesh output_;
  bool has_vertices_ = false;
  std::vector<Index> corners_;
  std::vector<std::size_t> face_end_;  ///< for each face, the number of triangles up to its end
};

}  // namespace

Result<Done> write_ply(const Model& model, const std::string& path, const PlyOptions& options) {
  const auto all_have = [&](auto attribute) {
    return std::all_of(model.parts.begin(), model.parts.end(), [&](const MeshPart& part) {
      return (part.mesh.*attribute).size() == part.mesh.positions.size();
    });
  };
  const bool normals = options.normals && all_have(&TriangleMesh::normals);
  const bool colors = options.colors && all_have(&TriangleMesh::colors);
  AtomicFile file(path);
  if (model.vertex_count() > kMostVertices) {
    return error_at({path}, "too many vertices for PLY", Failure::output);
  }
  file.write(header(model, normals, colors));
  std::string out;
  for (const MeshPart& part : model.parts) {
    for (std::size_t i = 0; i < part.mesh.positions.size(); ++i) {
      append_vertex(out, part.mesh, i, normals, colors);
      if (i % 4096 == 4095) file.write(std::exchange(out, {}));
    }
  }
  file.write(std::exchange(out, {}));
  std::size_t base = 0;
  for (const MeshPart& part : model.parts) {
    for (const auto& triangle : part.mesh.triangles) {
      out += '\3';
      for (const Index vertex : triangle) {
        append_little_endian(out, static_cast<std::uint32_t>(base + vertex));
      }
      if (out.size() > (std::size_t{1} << 16)) file.write(std::exchange(out, {}));
    }
    base += part.mesh.positions.size();
  }
  file.write(out);
  return file.commit();
}

Result<Model> read_ply(std::string_view bytes, const std::string& file) {
  return PlyReader(bytes, file).read();
}

}  // namespace cs2mesh
