#include "polygonize/obj.h"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

#include "libfield/base/atomic_file.h"
#include "libfield/base/color.h"
#include "polygonize/mesh_input.h"
#include "polygonize/mesh_output.h"
#include "polygonize/source_patches.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

// ---- Writing ----

void append_vector(std::string& out, const char* keyword, const auto& v) {
  out += keyword;
  for (const auto component : {v.x, v.y, v.z}) {
    out += ' ';
    append_number(out, component);
  }
}

void append_color(std::string& out, const Vec3<float>& linear) {
  for (const float channel : {linear.x, linear.y, linear.z}) {
    out += ' ';
    append_number(out, static_cast<float>(linear_to_srgb(std::clamp<double>(channel, 0, 1))));
  }
}

std::string material_name(const std::string& part) {
  std::string name = printable_name(part);
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

void append_material(std::string& out, const std::string& part, const TriangleMesh& mesh) {
  Vec3d sum;
  for (const Vec3<float>& color : mesh.colors) sum += Vec3d(color);
  out += "newmtl " + material_name(part) + "\nKd";
  append_color(out, Vec3<float>(sum / static_cast<double>(mesh.colors.size())));
  out += "\n\n";
}

/// A material for each part, and for each source of a united one.
std::string material_library(const Model& model) {
  std::string out;
  for (const MeshPart& part : model.parts) {
    if (part.mesh.colors.empty()) continue;
    if (part.sources.empty()) append_material(out, part.name, part.mesh);
    for (SourcePatch& patch : split_by_source(part)) {
      for (const Index v : patch.vertex) patch.mesh.colors.push_back(part.mesh.colors[v]);
      append_material(out, part.sources[patch.source], patch.mesh);
    }
  }
  return out;
}

void append_faces(std::string& out, const MeshPart& part, bool normals, bool colors,
                  std::size_t base, AtomicFile& file) {
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
    const auto& triangle = part.mesh.triangles[t];
    const bool first_of_source =
        !part.sources.empty() && (t == 0 || part.source_of[t] != part.source_of[t - 1]);
    if (colors && first_of_source) {
      out += "usemtl " + material_name(part.sources[part.source_of[t]]) + '\n';
    }
    out += 'f';
    for (const Index vertex : triangle) {
      const std::size_t index = base + vertex;
      out += ' ';
      append_number(out, index);
      // Every vertex has its normal at the same place in the list of normals, or no part has any.
      if (normals) {
        out += "//";
        append_number(out, index);
      }
    }
    out += '\n';
    if (out.size() > (std::size_t{1} << 20)) {
      file.write(out);
      out.clear();
    }
  }
}

void write_parts(const Model& model, const ObjOptions& options, AtomicFile& file) {
  const bool normals =
      options.normals && std::all_of(model.parts.begin(), model.parts.end(), [](const MeshPart& p) {
        return p.mesh.normals.size() == p.mesh.positions.size();
      });
  std::string out;
  std::size_t base = 1;
  for (const MeshPart& part : model.parts) {
    const TriangleMesh& mesh = part.mesh;
    const bool colors = options.colors && !mesh.colors.empty();
    out += "o " + printable_name(part.name) + '\n';
    if (colors && part.sources.empty()) out += "usemtl " + material_name(part.name) + '\n';
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      append_vector(out, "v", mesh.positions[i]);
      if (colors) append_color(out, mesh.colors[i]);
      out += '\n';
    }
    for (std::size_t i = 0; normals && i < mesh.normals.size(); ++i) {
      append_vector(out, "vn", mesh.normals[i]);
      out += '\n';
    }
    append_faces(out, part, normals, colors, base, file);
    base += mesh.positions.size();
  }
  file.write(out);
}

// ---- Reading ----

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& file) : cursor_(text), file_(file) {}

  Result<Model> read() {
    while (cursor_.next_line()) {
      const std::string_view keyword = cursor_.word();
      bool good = true;
      if (keyword == "v") {
        good = vertex();
      } else if (keyword == "vn") {
        good = normal();
      } else if (keyword == "f") {
        good = face();
      } else if (keyword == "o" || keyword == "g") {
        begin_part(std::string(cursor_.rest_of_line()));
      }
      if (!good) return error_at({file_, cursor_.line()}, error_);
    }
    if (mesh_.positions.empty()) return error_at({file_}, "no vertices: not a Wavefront OBJ file");
    finish_attributes();
    output_.mesh = std::move(mesh_);
    return split_into_parts(std::move(output_), stem_of(file_));
  }

 private:
  bool fail(std::string message) {
    error_ = std::move(message);
    return false;
  }

  bool numbers(int count, double* out) {
    for (int i = 0; i < count; ++i) {
      const std::string_view word = cursor_.word();
      const std::optional<double> value = read_decimal(word);
      if (!value) {
        return fail(word.empty()
                        ? "a coordinate is missing"
                        : "not a finite number: '" + std::string(word.substr(0, 40)) + "'");
      }
      out[i] = *value;
    }
    return true;
  }

  bool vertex() {
    double p[3];
    if (!numbers(3, p)) return false;
    if (mesh_.positions.size() >= kMostVertices) return fail("too many vertices");
    mesh_.positions.emplace_back(p[0], p[1], p[2]);
    // Three more numbers are a colour; a single one is a weight, which surfaces do not use.
    double color[3];
    int count = 0;
    while (count < 3) {
      const std::optional<double> value = read_decimal(cursor_.word());
      if (!value) break;
      color[count++] = srgb_to_linear(*value);
    }
    if (count == 3 && mesh_.colors.size() + 1 == mesh_.positions.size()) {
      mesh_.colors.push_back(Vec3<float>(Vec3d(color[0], color[1], color[2])));
    }
    return true;
  }

  bool normal() {
    double n[3];
    if (!numbers(3, n)) return false;
    normals_.push_back(Vec3<float>(Vec3d(n[0], n[1], n[2])));
    return true;
  }

  /// A 1-based or negative index into a list of `count` things; nothing if there is no such thing.
  static std::optional<std::size_t> resolve(std::string_view word, std::size_t count) {
    const std::optional<std::int64_t> index = parse_integer(word);
    const auto size = static_cast<std::int64_t>(count);
    if (!index || *index == 0 || *index > size || *index < -size) return std::nullopt;
    return static_cast<std::size_t>(*index > 0 ? *index - 1 : size + *index);
  }

  bool corner(std::string_view word) {
    const std::size_t slash = word.find('/');
    const std::string_view first = word.substr(0, slash);
    const auto vertex = resolve(first, mesh_.positions.size());
    if (!vertex) return fail("no such vertex: '" + std::string(first.substr(0, 40)) + "'");
    corners_.push_back(static_cast<Index>(*vertex));

    const std::size_t last = word.rfind('/');
    if (last == slash || last + 1 == word.size()) return true;  // no normal: v, v/t, v/t/
    const auto normal = resolve(word.substr(last + 1), normals_.size());
    if (!normal) return fail("no such normal: '" + std::string(word.substr(0, 40)) + "'");
    set_normal(*vertex, *normal);
    return true;
  }

  void set_normal(std::size_t vertex, std::size_t normal) {
    if (one_normal_each_ && normal_of_.size() <= vertex) normal_of_.resize(vertex + 1, kNoNormal);
    if (!one_normal_each_) return;
    std::size_t& known = normal_of_[vertex];
    if (known != kNoNormal && !(normals_[known] == normals_[normal])) one_normal_each_ = false;
    known = normal;
  }

  bool face() {
    corners_.clear();
    for (std::string_view word = cursor_.word(); !word.empty() && word[0] != '#';
         word = cursor_.word()) {
      if (!corner(word)) return false;
    }
    if (corners_.size() < 3) return fail("a face needs three corners");
    append_fan(mesh_, corners_);
    output_.part_of.resize(mesh_.triangles.size(), part_);
    return true;
  }

  void begin_part(std::string name) {
    const auto [known, fresh] =
        part_of_name_.emplace(name, static_cast<std::uint32_t>(output_.names.size()));
    if (fresh) output_.names.push_back(std::move(name));
    part_ = known->second;
  }

  void finish_attributes() {
    if (mesh_.colors.size() != mesh_.positions.size()) mesh_.colors.clear();
    if (!one_normal_each_ || normal_of_.size() != mesh_.positions.size()) return;
    for (const std::size_t normal : normal_of_) {
      if (normal == kNoNormal) {
        mesh_.normals.clear();
        return;
      }
      mesh_.normals.push_back(normals_[normal]);
    }
  }

  static constexpr std::size_t kNoNormal = static_cast<std::size_t>(-1);

  TextCursor cursor_;
  const std::string& file_;
  std::string error_;
  TriangleMesh mesh_;
  SharedVertexMesh output_;
  std::vector<Vec3<float>> normals_;
  std::vector<std::size_t> normal_of_;  ///< for each vertex, as far as one was seen
  bool one_normal_each_ = true;
  std::vector<Index> corners_;
  std::unordered_map<std::string, std::uint32_t> part_of_name_;
  std::uint32_t part_ = 0;
};

}  // namespace

Result<Done> write_obj(const Model& model, const std::string& path, const ObjOptions& options) {
  const std::string materials = options.colors ? material_library(model) : std::string();
  AtomicFile file(path);
  if (!materials.empty()) {
    const std::size_t slash = path.rfind('/');
    const std::string folder = slash == std::string::npos ? "" : path.substr(0, slash + 1);
    const std::string name = stem_of(path) + ".mtl";
    file.write("mtllib " + printable_name(name) + '\n');
    write_parts(model, options, file);
    // The library first: an OBJ file that is there must not name one that is not.
    if (file.ok()) {
      Result<Done> written = write_file(folder + name, materials);
      if (!written) return written;
    }
  } else {
    write_parts(model, options, file);
  }
  return file.commit();
}

Result<Model> read_obj(std::string_view text, const std::string& file) {
  return ObjReader(text, file).read();
}

}  // namespace cs2mesh
