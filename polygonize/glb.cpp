// Writing glTF; reading is in glb_reader.cpp.
#include "polygonize/glb.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "libfield/base/atomic_file.h"
#include "polygonize/mesh_output.h"

namespace cs2mesh {
namespace {

using Json = nlohmann::ordered_json;
using Index = TriangleMesh::Index;
using Vec3f = Vec3<float>;

// Numbers of the glTF 2.0 specification.
constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;
constexpr int kVertexBuffer = 34962, kIndexBuffer = 34963;
constexpr std::uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

class GlbBuilder {
 public:
  explicit GlbBuilder(const GlbOptions& options)
      : options_(options), turn_(rotation_to_y_up(options.up)) {
    json_["asset"] = {{"version", "2.0"},
                      {"generator", "cs2mesh"},
                      {"extras", {{"cs2mesh_up", {options.up.x, options.up.y, options.up.z}}}}};
    json_["scene"] = 0;
    json_["scenes"] = Json::array({Json::object()});
  }

  /// False if a coordinate does not fit float32.
  bool add(const MeshPart& part) {
    if (part.mesh.empty()) return true;
    Json primitives = Json::array();
    if (part.patches.empty() && !add_primitive(part.mesh, part.name, primitives)) return false;
    for (const SourcePatch& patch : part.patches) {
      if (!add_primitive(patch.mesh, part.sources[patch.source], primitives)) return false;
    }
    const std::size_t index = json_["meshes"].size();
    json_["meshes"].push_back({{"name", part.name}, {"primitives", std::move(primitives)}});
    json_["nodes"].push_back({{"name", part.name}, {"mesh", index}});
    json_["scenes"][0]["nodes"].push_back(index);
    return true;
  }

  /// Header and JSON chunk; the binary chunk with its header in binary(). Empty if over 4 GiB.
  std::string head() {
    if (!binary_.empty()) json_["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
    std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::size_t tail = binary_.empty() ? 0 : 8 + binary_.size();
    const std::size_t total = 12 + 8 + text.size() + tail;
    if (total > std::numeric_limits<std::uint32_t>::max()) return {};
    std::string out;
    for (const std::size_t word :
         {std::size_t{kMagic}, std::size_t{2}, total, text.size(), std::size_t{kJsonChunk}}) {
      append_little_endian(out, static_cast<std::uint32_t>(word));
    }
    out += text;
    if (tail > 0) {
      append_little_endian(out, static_cast<std::uint32_t>(binary_.size()));
      append_little_endian(out, kBinaryChunk);
    }
    return out;
  }
  const std::string& binary() const { return binary_; }

 private:
  bool add_primitive(const TriangleMesh& mesh, const std::string& material, Json& primitives) {
    const bool colors = options_.colors && mesh.colors.size() == mesh.positions.size();
    const bool normals = options_.normals && mesh.normals.size() == mesh.positions.size();
    Json attributes;
    if (!add_positions(mesh, attributes)) return false;
    if (normals) attributes["NORMAL"] = add_normals(mesh);
    if (colors) attributes["COLOR_0"] = add_colors(mesh);
    const std::size_t index = json_["materials"].size();
    const double albedo = colors ? 1.0 : 0.8;
    json_["materials"].push_back({{"name", material},
                                  {"pbrMetallicRoughness",
                                   {{"baseColorFactor", {albedo, albedo, albedo, 1.0}},
                                    {"metallicFactor", 0.0},
                                    {"roughnessFactor", 0.5}}},
                                  {"doubleSided", false}});
    primitives.push_back({{"attributes", std::move(attributes)},
                          {"indices", add_indices(mesh)},
                          {"material", index},
                          {"mode", 4}});
    return true;
  }

  std::size_t add_view(std::size_t begin, int target) {
    json_["bufferViews"].push_back({{"buffer", 0},
                                    {"byteOffset", begin},
                                    {"byteLength", binary_.size() - begin},
                                    {"target", target}});
    binary_.resize((binary_.size() + 3) / 4 * 4, '\0');
    return json_["bufferViews"].size() - 1;
  }

  std::size_t add_accessor(std::size_t view, int type, std::size_t count, const char* shape) {
    json_["accessors"].push_back(
        {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}});
    return json_["accessors"].size() - 1;
  }

  void append(const Vec3f& v) {
    // Adding 0 makes -0, which the turn brings in, a 0.
    for (const float component : {v.x, v.y, v.z}) append_little_endian(binary_, component + 0.0F);
  }

  bool add_positions(const TriangleMesh& mesh, Json& attributes) {
    constexpr float kLargest = std::numeric_limits<float>::max();
    const std::size_t begin = binary_.size();
    Vec3f low{kLargest, kLargest, kLargest}, high = -low;
    for (const Vec3d& position : mesh.positions) {
      const Vec3f p(turn_ * position);
      if (!is_finite(Vec3d(p))) return false;
      low = min(low, p);
      high = max(high, p);
      append(p);
    }
    const std::size_t accessor =
        add_accessor(add_view(begin, kVertexBuffer), kFloat, mesh.positions.size(), "VEC3");
    const auto numbers = [](const Vec3f& v) {
      return Json::array({double{v.x + 0.0F}, double{v.y + 0.0F}, double{v.z + 0.0F}});
    };
    json_["accessors"][accessor]["min"] = numbers(low);
    json_["accessors"][accessor]["max"] = numbers(high);
    attributes["POSITION"] = accessor;
    return true;
  }

  std::size_t add_normals(const TriangleMesh& mesh) {
    const std::size_t begin = binary_.size();
    for (const Vec3f& normal : mesh.normals) {
      const Vec3d n = turn_ * Vec3d(normal);
      const double length = norm(n);
      append(length > 0 ? Vec3f(n / length) : Vec3f(0, 1, 0));
    }
    return add_accessor(add_view(begin, kVertexBuffer), kFloat, mesh.normals.size(), "VEC3");
  }

  std::size_t add_colors(const TriangleMesh& mesh) {
    const std::size_t begin = binary_.size();
    for (const Vec3f& color : mesh.colors) append(max(Vec3f(), min(Vec3f(1, 1, 1), color)));
    return add_accessor(add_view(begin, kVertexBuffer), kFloat, mesh.colors.size(), "VEC3");
  }

  std::size_t add_indices(const TriangleMesh& mesh) {
    // The largest value of a type is reserved for restarting strips.
    const bool narrow = mesh.positions.size() <= 65535;
    const std::size_t begin = binary_.size();
    for (const auto& triangle : mesh.triangles) {
      for (const Index vertex : triangle) {
        if (narrow) {
          append_little_endian(binary_, static_cast<std::uint16_t>(vertex));
        } else {
          append_little_endian(binary_, std::uint32_t{vertex});
        }
      }
    }
    return add_accessor(add_view(begin, kIndexBuffer), narrow ? kUnsignedShort : kUnsignedInt,
                        3 * mesh.triangles.size(), "SCALAR");
  }

  GlbOptions options_;
  Mat3 turn_;
  Json json_;
  std::string binary_;
};

}  // namespace

Mat3 rotation_to_y_up(const Vec3d& up) {
  const Vec3d u = normalized(up);
  // Rodrigues: I + [v] + [v]^2 / (1 + c) with v = u x y and c = u . y, written out.
  // 1 / (1 + c) loses its digits near c = -1, so it is (1 - c) / |v|^2 there.
  const double c = u.y;
  const double sine_squared = u.x * u.x + u.z * u.z;
  if (c < 0 && sine_squared == 0) return {{Vec3d{1, 0, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, -1}}};
  const double k = c < 0 ? (1 - c) / sine_squared : 1 / (1 + c);
  return {{Vec3d{1 - k * u.x * u.x, -u.x, -k * u.x * u.z}, u,
           Vec3d{-k * u.x * u.z, -u.z, 1 - k * u.z * u.z}}};
}

Result<Done> write_glb(const Model& model, const std::string& path, const GlbOptions& options) {
  AtomicFile file(path);
  GlbBuilder builder(options);
  for (const MeshPart& part : model.parts) {
    if (!builder.add(part)) {
      return error_at({path}, "a coordinate is too large for glTF, which has float32",
                      Failure::output);
    }
  }
  const std::string head = builder.head();
  if (head.empty()) return error_at({path}, "a GLB file ends at 4 GiB", Failure::output);
  file.write(head);
  file.write(builder.binary());
  return file.commit();
}

}  // namespace cs2mesh
