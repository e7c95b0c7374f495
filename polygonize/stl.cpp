#include "polygonize/stl.h"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "libfield/base/atomic_file.h"
#include "polygonize/mesh_input.h"
#include "polygonize/mesh_output.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

// A file is a header of 80 bytes, a count, and 50 bytes a triangle: normal, corners, two unused.
constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kTriangleBytes = 50;

void append_vector(std::string& out, const Vec3<float>& v) {
  append_little_endian(out, v.x);
  append_little_endian(out, v.y);
  append_little_endian(out, v.z);
}

void append_triangle(std::string& out, const Vec3<float> (&corner)[3]) {
  // The normal of the triangle as written; 0 where it has none, as the format allows.
  const Vec3d a(corner[0]);
  const Vec3d n = cross(Vec3d(corner[1]) - a, Vec3d(corner[2]) - a);
  const double length = norm(n);
  append_vector(out, length > 0 ? Vec3<float>(n / length) : Vec3<float>());
  for (const Vec3<float>& p : corner) append_vector(out, p);
  out.append(2, '\0');
}

std::optional<Index> append_corner(TriangleMesh& mesh, const Vec3d& p) {
  if (!is_finite(p) || mesh.positions.size() >= kMostVertices) return std::nullopt;
  mesh.positions.push_back(p);
  return static_cast<Index>(mesh.positions.size() - 1);
}

Result<Model> finish(Model model, const std::string& file) {
  std::vector<MeshPart> parts;
  for (MeshPart& part : model.parts) {
    merge_equal_vertices(part.mesh);
    if (part.name.empty()) part.name = stem_of(file);
    if (!part.mesh.empty()) parts.push_back(std::move(part));
  }
  return Model{std::move(parts)};
}

Result<Model> read_binary(std::string_view bytes, std::uint32_t count, const std::string& file) {
  Model model{{{"", {}}}};
  TriangleMesh& mesh = model.parts[0].mesh;
  mesh.positions.reserve(3 * std::size_t{count});
  mesh.triangles.reserve(count);
  const char* at = bytes.data() + kHeaderBytes + 4;
  for (std::uint32_t t = 0; t < count; ++t, at += kTriangleBytes) {
    std::array<Index, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const char* corner = at + 12 * (k + 1);
      const auto index = append_corner(
          mesh, Vec3d(decode<float>(corner), decode<float>(corner + 4), decode<float>(corner + 8)));
      if (!index) {
        return error_at({file}, "triangle " + std::to_string(t) + " has a corner that is no point");
      }
      triangle[k] = *index;
    }
    mesh.triangles.push_back(triangle);
  }
  return finish(std::move(model), file);
}

Result<Model> read_ascii(std::string_view text, const std::string& file) {
  TextCursor cursor(text);
  Model model;
  std::vector<Index> corners;
  const auto error = [&](const char* message) { return error_at({file, cursor.line()}, message); };
  while (cursor.next_line()) {
    const std::string_view keyword = cursor.word();
    if (keyword == "solid") {
      model.parts.push_back({std::string(cursor.rest_of_line()), {}});
    } else if (keyword == "vertex") {
      if (model.parts.empty()) return error("a vertex before the first solid");
      Vec3d p;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::optional<double> value = read_decimal(cursor.word());
        if (!value) return error("a vertex needs three finite numbers");
        p[axis] = *value;
      }
      const auto index = append_corner(model.parts.back().mesh, p);
      if (!index) return error("too many vertices");
      corners.push_back(*index);
    } else if (keyword == "endfacet") {
      if (corners.size() < 3) return error("a facet needs three vertices");
      append_fan(model.parts.back().mesh, corners);
      corners.clear();
    } else if (keyword == "facet" || keyword == "endsolid") {
      if (!corners.empty()) return error("the facet before has no end");
    } else if (!keyword.empty() && keyword != "outer" && keyword != "endloop") {
      return error("not a line of an ASCII STL file");
    }
  }
  if (!corners.empty()) return error("the last facet has no end");
  return finish(std::move(model), file);
}

}  // namespace

Result<Done> write_stl(const Model& model, const std::string& path) {
  const std::size_t count = model.triangle_count();
  if (count > std::numeric_limits<std::uint32_t>::max()) {
    return error_at({path}, "too many triangles for STL", Failure::output);
  }
  // A header that begins with "solid" would make readers take the file for ASCII.
  std::string out = "binary STL written by cs2mesh";
  out.resize(kHeaderBytes, ' ');
  append_little_endian(out, static_cast<std::uint32_t>(count));
  AtomicFile file(path);
  for (const MeshPart& part : model.parts) {
    for (const auto& triangle : part.mesh.triangles) {
      Vec3<float> corner[3];
      for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = Vec3<float>(part.mesh.positions[triangle[k]]);
        if (!is_finite(Vec3d(corner[k]))) {
          return error_at({path}, "a coordinate is too large for STL, which has float32",
                          Failure::output);
        }
      }
      append_triangle(out, corner);
      if (out.size() > (std::size_t{1} << 16)) file.write(std::exchange(out, {}));
    }
  }
  file.write(out);
  return file.commit();
}

Result<Model> read_stl(std::string_view bytes, const std::string& file) {
  // Some binary files begin with "solid" too, so the size decides first.
  const bool headed = bytes.size() >= kHeaderBytes + 4;
  const std::uint32_t count = headed ? decode<std::uint32_t>(bytes.data() + kHeaderBytes) : 0;
  const std::uint64_t binary_size = kHeaderBytes + 4 + kTriangleBytes * std::uint64_t{count};
  if (headed && bytes.size() == binary_size) return read_binary(bytes, count, file);
  const std::size_t text = bytes.find_first_not_of(" \t\r\n");
  if (text != std::string_view::npos && bytes.substr(text, 5) == "solid") {
    return read_ascii(bytes, file);
  }
  if (headed && bytes.size() > binary_size) return read_binary(bytes, count, file);
  return error_at({file}, headed ? "the file ends before its last triangle: its header counts " +
                                       std::to_string(count)
                                 : "not an STL file");
}

}  // namespace cs2mesh
