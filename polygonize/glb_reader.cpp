// Reading glTF 2.0. The format is a graph of indices into arrays; each is checked where it is
// followed, and what is read in all is bounded by the size of the file.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "polygonize/glb.h"
#include "polygonize/mesh_input.h"
#include "polygonize/source_patches.h"

namespace cs2mesh {
namespace {

using Json = nlohmann::json;
using Index = TriangleMesh::Index;

constexpr std::uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

/// The member, or null (as a JSON value) if there is none or `object` is no object.
const Json& member(const Json& object, const char* key) {
  static const Json kNull;
  if (!object.is_object()) return kNull;
  const auto found = object.find(key);
  return found == object.end() ? kNull : *found;
}

/// A non-negative integer that fits a size, or `otherwise` if the member is absent or no such.
std::optional<std::uint64_t> integer(const Json& value,
                                     std::optional<std::uint64_t> otherwise = std::nullopt) {
  if (!value.is_number_integer()) return otherwise;
  if (!value.is_number_unsigned() && value.get<std::int64_t>() < 0) return std::nullopt;
  const std::uint64_t number = value.get<std::uint64_t>();
  // Sums and products of two of these with a stride cannot overflow.
  return number < (std::uint64_t{1} << 48) ? std::optional(number) : std::nullopt;
}

/// Element `index` of an array, or null.
const Json& element(const Json& array, std::optional<std::uint64_t> index) {
  static const Json kNull;
  return array.is_array() && index && *index < array.size() ? array[*index] : kNull;
}

template <std::size_t kCount>
bool read_numbers(const Json& array, std::array<double, kCount>& out) {
  if (array.is_null()) return true;
  if (!array.is_array() || array.size() != kCount) return false;
  for (std::size_t i = 0; i < kCount; ++i) {
    if (!array[i].is_number()) return false;
    out[i] = array[i].get<double>();
    if (!std::isfinite(out[i])) return false;
  }
  return true;
}

std::optional<std::string> decode_base64(std::string_view text) {
  std::string out;
  out.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  for (const char c : text) {
    std::uint32_t digit = 0;
    if (c >= 'A' && c <= 'Z') {
      digit = static_cast<std::uint32_t>(c - 'A');
    } else if (c >= 'a' && c <= 'z') {
      digit = static_cast<std::uint32_t>(c - 'a' + 26);
    } else if (c >= '0' && c <= '9') {
      digit = static_cast<std::uint32_t>(c - '0' + 52);
    } else if (c == '+' || c == '/') {
      digit = c == '+' ? 62 : 63;
    } else {
      return std::nullopt;
    }
    bits = (bits << 6) | digit;
    count += 6;
    if (count >= 8) {
      count -= 8;
      out += static_cast<char>((bits >> count) & 0xFF);
    }
  }
  return out;
}

/// Numbers of an accessor inside the bytes of its buffer.
struct AccessorView {
  const char* data = nullptr;
  std::size_t count = 0, stride = 0;
  int type = 0;
  int components = 0;
  bool normalized = false;

  static std::size_t size_of(int type) {
    switch (type) {
      case 5120:
      case 5121:
        return 1;
      case 5122:
      case 5123:
        return 2;
      case 5125:
      case 5126:
        return 4;
      default:
        return 0;
    }
  }
  double number(std::size_t row, int component) const {
    const char* at = data + row * stride + static_cast<std::size_t>(component) * size_of(type);
    switch (type) {
      case 5120:
        return decode<std::int8_t>(at) / (normalized ? 127.0 : 1.0);
      case 5121:
        return decode<std::uint8_t>(at) / (normalized ? 255.0 : 1.0);
      case 5122:
        return decode<std::int16_t>(at) / (normalized ? 32767.0 : 1.0);
      case 5123:
        return decode<std::uint16_t>(at) / (normalized ? 65535.0 : 1.0);
      case 5125:
        return decode<std::uint32_t>(at);
      default:
        return decode<float>(at);
    }
  }
  Vec3d vector(std::size_t row) const { return {number(row, 0), number(row, 1), number(row, 2)}; }
};

class GltfReader {
 public:
  GltfReader(std::string_view bytes, const std::string& file)
      : file_(file), budget_((std::uint64_t{1} << 20) + 16 * bytes.size()) {
    good_ = split(bytes);
  }

  Result<Model> read() {
    if (!good_ || !check_extensions() || !load_buffers() || !walk_scene()) {
      return error_at({file_}, error_, limit_ ? Failure::limit : Failure::bad_input);
    }
    return std::move(model_);
  }

 private:
  bool fail(std::string message) {
    error_ = std::move(message);
    return false;
  }

  // ---- The container ----

  bool split(std::string_view bytes) {
    std::string_view text = bytes;
    if (bytes.size() >= 4 && decode<std::uint32_t>(bytes.data()) == kMagic) {
      if (bytes.size() < 20) return fail("the GLB header is cut off");
      if (decode<std::uint32_t>(bytes.data() + 4) != 2) return fail("not glTF version 2");
      if (decode<std::uint32_t>(bytes.data() + 16) != kJsonChunk) {
        return fail("the first chunk is not JSON");
      }
      const std::size_t length = decode<std::uint32_t>(bytes.data() + 12);
      if (length > bytes.size() - 20) return fail("the JSON chunk is cut off");
      text = bytes.substr(20, length);
      const std::string_view rest = bytes.substr(20 + length);
      if (rest.size() >= 8 && decode<std::uint32_t>(rest.data() + 4) == kBinaryChunk) {
        binary_ = rest.substr(8, decode<std::uint32_t>(rest.data()));
        has_binary_ = true;
      }
    }
    json_ = Json::parse(text, nullptr, false);
    if (json_.is_discarded() || !json_.is_object()) return fail("not a glTF file: broken JSON");
    const Json& asset = member(json_, "asset");
    const Json& version = member(asset, "version");
    if (!version.is_string() || version.get_ref<const std::string&>().substr(0, 2) != "2.") {
      return fail("not glTF version 2");
    }
    const Json& up = member(member(asset, "extras"), "cs2mesh_up");
    std::array<double, 3> u{0, 0, 1};
    ours_ = !up.is_null();
    if (!read_numbers(up, u) || !(norm(Vec3d(u[0], u[1], u[2])) > 0)) {
      return fail("asset.extras.cs2mesh_up is no direction");
    }
    turn_back_ = transpose(rotation_to_y_up({u[0], u[1], u[2]}));
    return true;
  }

  bool check_extensions() {
    const Json& required = member(json_, "extensionsRequired");
    if (!required.is_array()) return true;
    for (const Json& name : required) {
      if (!name.is_string()) continue;
      const std::string& text = name.get_ref<const std::string&>();
      // What changes only how a surface looks is none of our business.
      const bool looks_only = text.rfind("KHR_materials_", 0) == 0 ||
                              text.rfind("KHR_texture_", 0) == 0 || text == "KHR_lights_punctual";
      if (!looks_only) return fail("the file requires the extension " + text + ", not read here");
    }
    return true;
  }

  bool load_buffers() {
    const Json& buffers = member(json_, "buffers");
    if (!buffers.is_array()) return true;
    decoded_.reserve(buffers.size());
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      const Json& uri = member(buffers[i], "uri");
      const auto length = integer(member(buffers[i], "byteLength"));
      if (!length) return fail("a buffer has no byteLength");
      std::string_view bytes;
      if (uri.is_null()) {
        if (i != 0 || !has_binary_) return fail("a buffer has no bytes");
        bytes = binary_;
      } else {
        const std::string text = uri.is_string() ? uri.get<std::string>() : std::string();
        const std::size_t comma = text.find(";base64,");
        if (text.rfind("data:", 0) != 0 || comma == std::string::npos) {
          return fail("a buffer is in a file of its own; only embedded buffers are read");
        }
        auto decoded = decode_base64(std::string_view(text).substr(comma + 8));
        if (!decoded) return fail("a buffer is not base64");
        decoded_.push_back(std::move(*decoded));
        bytes = decoded_.back();
      }
      if (*length > bytes.size()) return fail("a buffer is shorter than its byteLength");
      buffers_.push_back(bytes.substr(0, *length));
    }
    return true;
  }

  bool accessor(const Json& reference, AccessorView& out) {
    const Json& source = element(member(json_, "accessors"), integer(reference));
    if (!source.is_object()) return fail("there is no such accessor");
    if (!member(source, "sparse").is_null()) return fail("sparse accessors are not read");
    const Json& view = element(member(json_, "bufferViews"), integer(member(source, "bufferView")));
    const auto buffer = integer(member(view, "buffer"));
    if (!buffer || *buffer >= buffers_.size()) return fail("an accessor has no bytes");
    const auto begin = integer(member(view, "byteOffset"), 0);
    const auto length = integer(member(view, "byteLength"));
    const auto offset = integer(member(source, "byteOffset"), 0);
    const auto count = integer(member(source, "count"));
    const auto type = integer(member(source, "componentType"));
    if (!begin || !length || !offset || !count || !type) return fail("an accessor is malformed");

    const Json& shape = member(source, "type");
    out.components = shape == "SCALAR" ? 1 : shape == "VEC3" ? 3 : shape == "VEC4" ? 4 : 0;
    out.type = *type < 6000 ? static_cast<int>(*type) : 0;
    out.normalized = member(source, "normalized") == true;
    const std::uint64_t size =
        AccessorView::size_of(out.type) * static_cast<std::uint64_t>(out.components);
    const auto stride = integer(member(view, "byteStride"), size);
    if (size == 0 || !stride || *stride < size || *stride > 4096) {
      return fail("an accessor is malformed");
    }
    const std::uint64_t whole = buffers_[*buffer].size();
    if (*begin > whole || *length > whole - *begin || *offset > *length ||
        *count > (*length - *offset) / size + 1 ||
        (*count > 0 && *offset + (*count - 1) * *stride + size > *length)) {
      return fail("an accessor reaches beyond its buffer");
    }
    out.count = *count;
    out.stride = *stride;
    out.data = buffers_[*buffer].data() + *begin + *offset;
    return spend(out.count);
  }

  /// Nodes may use one mesh, and meshes one stretch of bytes, again and again; what comes of it all
  /// must stay in proportion to the file.
  bool spend(std::uint64_t amount) {
    if (amount > budget_) {
      limit_ = true;
      return fail("the meshes repeat far more data than the file has");
    }
    budget_ -= amount;
    return true;
  }

  // ---- The scene ----

  bool walk_scene() {
    const Json& nodes = member(json_, "nodes");
    const Json& scene = element(member(json_, "scenes"), integer(member(json_, "scene"), 0));
    std::vector<bool> seen(nodes.is_array() ? nodes.size() : 0, false);
    std::vector<std::pair<std::uint64_t, Affine>> open;
    const auto push = [&](const Json& list, const Affine& map) {
      if (!list.is_array()) return true;
      // Backwards onto the stack, so that parts come in the order of the file.
      for (std::size_t i = list.size(); i-- > 0;) {
        const auto node = integer(list[i]);
        if (!node || *node >= seen.size() || seen[*node]) return false;
        seen[*node] = true;
        open.emplace_back(*node, map);
      }
      return true;
    };
    const char* kNoTree = "the nodes are no tree";
    if (!push(member(scene, "nodes"), Affine{})) return fail(kNoTree);
    while (!open.empty()) {
      const auto [index, parent] = open.back();
      open.pop_back();
      const Json& node = nodes[index];
      Affine own;
      if (!transform_of(node, own)) return fail("a node has a malformed transform");
      const Affine map = parent * own;
      if (!member(node, "mesh").is_null() && !add_mesh(node, map)) return false;
      if (!push(member(node, "children"), map)) return fail(kNoTree);
    }
    return true;
  }

  static bool transform_of(const Json& node, Affine& out) {
    std::array<double, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};  // by columns
    if (!member(node, "matrix").is_null()) {
      if (!read_numbers(member(node, "matrix"), m)) return false;
      for (std::size_t i = 0; i < 3; ++i) out.linear.row[i] = {m[i], m[4 + i], m[8 + i]};
      out.translation = {m[12], m[13], m[14]};
      return true;
    }
    std::array<double, 3> t{0, 0, 0}, s{1, 1, 1};
    std::array<double, 4> q{0, 0, 0, 1};
    if (!read_numbers(member(node, "translation"), t) ||
        !read_numbers(member(node, "rotation"), q) || !read_numbers(member(node, "scale"), s)) {
      return false;
    }
    const auto [x, y, z, w] = q;
    out.linear.row = {Vec3d{(1 - 2 * (y * y + z * z)) * s[0], 2 * (x * y - z * w) * s[1],
                            2 * (x * z + y * w) * s[2]},
                      Vec3d{2 * (x * y + z * w) * s[0], (1 - 2 * (x * x + z * z)) * s[1],
                            2 * (y * z - x * w) * s[2]},
                      Vec3d{2 * (x * z - y * w) * s[0], 2 * (y * z + x * w) * s[1],
                            (1 - 2 * (x * x + y * y)) * s[2]}};
    out.translation = {t[0], t[1], t[2]};
    return true;
  }

  bool add_mesh(const Json& node, const Affine& map) {
    const Json& source = element(member(json_, "meshes"), integer(member(node, "mesh")));
    const Json& primitives = member(source, "primitives");
    if (!primitives.is_array()) return fail("there is no such mesh");
    MeshPart part;
    for (const Json* named : {&node, &source}) {
      const Json& name = member(*named, "name");
      if (part.name.empty() && name.is_string()) part.name = name.get<std::string>();
    }
    if (part.name.empty()) part.name = stem_of(file_);
    // A primitive takes over fifty bytes of JSON where it is not repeated, and time to look up.
    if (!spend(part.name.size() + 100 * primitives.size())) return false;
    if (ours_ && primitives.size() > 1) return add_united(primitives, map, std::move(part.name));
    for (const Json& primitive : primitives) {
      if (!add_primitive(primitive, map, part.mesh)) return false;
    }
    if (part.mesh.normals.size() != part.mesh.positions.size()) part.mesh.normals.clear();
    if (part.mesh.colors.size() != part.mesh.positions.size()) part.mesh.colors.clear();
    if (!ours_) merge_equal_vertices(part.mesh);
    if (!part.mesh.empty()) model_.parts.push_back(std::move(part));
    return true;
  }

  /// A united part, as our writer makes it: a primitive for each of its sources.
  bool add_united(const Json& primitives, const Affine& map, std::string name) {
    std::vector<std::string> sources;
    std::vector<SourcePatch> patches;
    std::size_t vertices = 0;
    for (const Json& primitive : primitives) {
      SourcePatch& patch = patches.emplace_back();
      patch.source = sources.size();
      if (!add_primitive(primitive, map, patch.mesh)) return false;
      vertices += patch.mesh.positions.size();
      if (vertices > kMostVertices) return fail("too many vertices");
      const Json& material =
          element(member(json_, "materials"), integer(member(primitive, "material")));
      const Json& source = member(material, "name");
      sources.push_back(source.is_string() ? source.get<std::string>() : std::string());
    }
    MeshPart part = join_patches(std::move(sources), std::move(patches));
    part.name = std::move(name);
    if (!part.mesh.empty()) model_.parts.push_back(std::move(part));
    return true;
  }

  bool add_primitive(const Json& primitive, const Affine& map, TriangleMesh& mesh) {
    const auto mode = integer(member(primitive, "mode"), 4);
    if (!mode || *mode > 6) return fail("a primitive has an unknown mode");
    if (*mode < 4) return true;  // points and lines
    const Json& attributes = member(primitive, "attributes");
    AccessorView positions;
    if (!accessor(member(attributes, "POSITION"), positions)) return false;
    if (positions.components != 3 || positions.type != 5126) {
      return fail("POSITION is not three floats");
    }
    const std::size_t base = mesh.positions.size();
    if (positions.count > kMostVertices - base) return fail("too many vertices");
    for (std::size_t i = 0; i < positions.count; ++i) {
      const Vec3d p = turn_back_ * map(positions.vector(i));
      if (!is_finite(p)) return fail("a coordinate is not finite");
      mesh.positions.push_back(p);
    }
    return add_vertex_attributes(attributes, map.linear, positions.count, base, mesh) &&
           add_triangles(primitive, *mode, determinant(map.linear) < 0, positions.count, base,
                         mesh);
  }

  bool add_vertex_attributes(const Json& attributes, const Mat3& linear, std::size_t count,
                             std::size_t base, TriangleMesh& mesh) {
    if (!member(attributes, "NORMAL").is_null() && mesh.normals.size() == base) {
      AccessorView normals;
      if (!accessor(member(attributes, "NORMAL"), normals)) return false;
      if (normals.components != 3 || normals.count != count) return fail("NORMAL is malformed");
      // Normals turn with the matrix of cofactors, det(A) A^-T; its rows are cross products.
      const auto& [a, b, c] = linear.row;
      const Mat3 cofactor{{cross(b, c), cross(c, a), cross(a, b)}};
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3d n = turn_back_ * (cofactor * normals.vector(i));
        const double sign = determinant(linear) < 0 ? -1 : 1;
        const double length = norm(n);
        const bool usable = length > 0 && std::isfinite(length);
        mesh.normals.push_back(usable ? Vec3<float>(n * (sign / length)) : Vec3<float>());
      }
    }
    if (!member(attributes, "COLOR_0").is_null() && mesh.colors.size() == base) {
      AccessorView colors;
      if (!accessor(member(attributes, "COLOR_0"), colors)) return false;
      if (colors.components < 3 || colors.count != count) return fail("COLOR_0 is malformed");
      for (std::size_t i = 0; i < count; ++i) {
        mesh.colors.push_back(Vec3<float>(colors.vector(i)));
      }
    }
    return true;
  }

  bool add_triangles(const Json& primitive, std::uint64_t mode, bool mirrored, std::size_t count,
                     std::size_t base, TriangleMesh& mesh) {
    AccessorView indices;
    const bool indexed = !member(primitive, "indices").is_null();
    if (indexed) {
      if (!accessor(member(primitive, "indices"), indices)) return false;
      const bool integral = indices.type == 5121 || indices.type == 5123 || indices.type == 5125;
      if (indices.components != 1 || !integral) return fail("indices are no unsigned integers");
      indices.normalized = false;
      for (std::size_t i = 0; i < indices.count; ++i) {
        if (!(indices.number(i, 0) < static_cast<double>(count))) {
          return fail("an index is no vertex");
        }
      }
    }
    const std::size_t corners = indexed ? indices.count : count;
    const auto vertex = [&](std::size_t i) {
      return static_cast<Index>(base +
                                (indexed ? static_cast<std::size_t>(indices.number(i, 0)) : i));
    };
    const std::size_t step = mode == 4 ? 3 : 1;
    for (std::size_t i = 0; i + 3 <= corners; i += step) {
      const bool odd = mode == 5 && i % 2 == 1;
      std::array<Index, 3> triangle = {vertex(mode == 6 ? 0 : i), vertex(i + 1), vertex(i + 2)};
      if (odd != mirrored) std::swap(triangle[1], triangle[2]);
      mesh.triangles.push_back(triangle);
    }
    return true;
  }

  const std::string& file_;
  std::string error_;
  bool good_ = false;
  bool limit_ = false;
  bool ours_ = false;
  std::uint64_t budget_;  ///< what may still be read: rows of accessors, primitives, letters
  Json json_;
  std::string_view binary_;
  bool has_binary_ = false;
  std::vector<std::string> decoded_;
  std::vector<std::string_view> buffers_;
  Mat3 turn_back_;
  Model model_;
};

}  // namespace

Result<Model> read_glb(std::string_view bytes, const std::string& file) {
  return GltfReader(bytes, file).read();
}

}  // namespace cs2mesh
