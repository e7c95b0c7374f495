#include "polygonize/mesh_file.h"

#include <array>
#include <cctype>
#include <utility>

#include "polygonize/glb.h"
#include "polygonize/mesh_input.h"
#include "polygonize/obj.h"
#include "polygonize/off.h"
#include "polygonize/ply.h"
#include "polygonize/stl.h"

namespace cs2mesh {

std::optional<MeshFormat> mesh_format_of(const std::string& path) {
  constexpr std::array<std::pair<std::string_view, MeshFormat>, 6> kExtensions = {{
      {"obj", MeshFormat::obj},
      {"ply", MeshFormat::ply},
      {"stl", MeshFormat::stl},
      {"glb", MeshFormat::glb},
      {"gltf", MeshFormat::gltf},
      {"off", MeshFormat::off},
  }};
  const std::size_t dot = path.find_last_of("./");
  if (dot == std::string::npos || path[dot] != '.') return std::nullopt;
  std::string extension = path.substr(dot + 1);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const auto& [name, format] : kExtensions) {
    if (name == extension) return format;
  }
  return std::nullopt;
}

std::string_view writable_mesh_extensions() {
  return ".obj .ply .stl .glb";
}

Result<Done> write_mesh(const Model& model, const std::string& path,
                        const MeshFileOptions& options) {
  const std::optional<MeshFormat> format = mesh_format_of(path);
  if (format == MeshFormat::obj) return write_obj(model, path, {options.normals, options.colors});
  if (format == MeshFormat::ply) return write_ply(model, path, {options.normals, options.colors});
  if (format == MeshFormat::stl) return write_stl(model, path);
  if (format == MeshFormat::glb) {
    return write_glb(model, path, {options.up, options.normals, options.colors});
  }
  return error_at({path}, "cannot write a mesh with this extension; there are " +
                              std::string(writable_mesh_extensions()));
}

Result<Model> read_mesh(const std::string& path) {
  const std::optional<MeshFormat> format = mesh_format_of(path);
  if (!format) {
    return error_at({path},
                    "cannot read a mesh with this extension; there are .obj .ply .stl .off .glb "
                    ".gltf");
  }
  Result<std::string> bytes = read_file_bytes(path);
  if (!bytes) return Result<Model>::failure(bytes.diagnostics());
  return read_mesh(*bytes, *format, path);
}

Result<Model> read_mesh(std::string_view bytes, MeshFormat format, const std::string& file) {
  switch (format) {
    case MeshFormat::obj:
      return read_obj(bytes, file);
    case MeshFormat::ply:
      return read_ply(bytes, file);
    case MeshFormat::stl:
      return read_stl(bytes, file);
    case MeshFormat::off:
      return read_off(bytes, file);
    case MeshFormat::glb:
    case MeshFormat::gltf:
      break;
  }
  return read_glb(bytes, file);
}

void round_to_format(Model& model, MeshFormat format, const MeshFileOptions& options) {
  const bool turned = format == MeshFormat::glb || format == MeshFormat::gltf;
  if (format != MeshFormat::stl && !turned) return;
  const Mat3 turn = turned ? rotation_to_y_up(options.up) : Mat3{};
  const Mat3 back = transpose(turn);
  for (MeshPart& part : model.parts) {
    for (Vec3d& p : part.mesh.positions) p = back * Vec3d(Vec3<float>(turn * p));
  }
}

}  // namespace cs2mesh
