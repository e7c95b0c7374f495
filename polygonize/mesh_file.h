// Mesh files of every format: which one is chosen by the extension.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "libfield/base/result.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

enum class MeshFormat { obj, ply, stl, glb, gltf, off };

/// By the extension, whatever its case; nothing if it is none of ours.
std::optional<MeshFormat> mesh_format_of(const std::string& path);
/// Extensions that write_mesh knows, for messages: ".obj .ply .stl .glb".
std::string_view writable_mesh_extensions();

struct MeshFileOptions {
  Vec3d up{0, 0, 1};    ///< the scene's up; formats with a fixed up axis (glTF: +Y) turn it there
  bool normals = true;  ///< write normals, if the mesh has them and the format can
  bool colors = true;   ///< write colours, if the mesh has them and the format can
};

/// Writes the format of the extension. The same model gives the same bytes. The file appears whole
/// or not at all. Errors: unknown extension (bad_input); those of the format's writer (output).
Result<Done> write_mesh(const Model& model, const std::string& path,
                        const MeshFileOptions& options = {});

/// Reads the format of the extension. Errors: unknown extension, unreadable or malformed file.
Result<Model> read_mesh(const std::string& path);
/// The same from bytes; `file` names them in messages.
Result<Model> read_mesh(std::string_view bytes, MeshFormat format, const std::string& file);

/// Moves vertices to where read_mesh will find them after write_mesh: unchanged for OBJ and PLY, to
/// float32 coordinates (in the turned frame) for STL and GLB. What is promised of a file is to be
/// checked on this.
void round_to_format(Model& model, MeshFormat format, const MeshFileOptions& options = {});

}  // namespace cs2mesh
