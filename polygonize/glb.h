// glTF 2.0, binary (GLB) and with embedded buffers.
#pragma once

#include <string>
#include <string_view>

#include "libfield/base/affine.h"
#include "libfield/base/result.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct GlbOptions {
  Vec3d up{0, 0, 1};    ///< direction in the scene that becomes +Y in the file; not zero
  bool normals = true;  ///< NORMAL, where a part has normals
  bool colors = true;   ///< linear COLOR_0, where a part has colours
};

/// Writes GLB: a node and a mesh for each part that is not empty, with a primitive and a material
/// for each patch of a united part, so that normals and colours end sharply at creases; coordinates
/// rounded to float32 after the turn that takes `up` to +Y (see round_to_format). The original up
/// direction is kept in asset.extras.cs2mesh_up, from which read_glb undoes the turn.
/// Deterministic. Errors: as AtomicFile::commit; a coordinate beyond the range of float32, a file
/// beyond 4 GiB.
Result<Done> write_glb(const Model& model, const std::string& path, const GlbOptions& options = {});

/// Reads GLB, and glTF whose buffers are data URIs: the triangles (lists, strips, fans) of the
/// default scene, one part a node with a mesh, node transforms applied, +Y up turned to +Z up or to
/// what our writer recorded. In files of other programs vertices at equal positions, which the
/// format has at every seam, are made one; in ours those of different patches of a united part.
/// Skins, morph targets and textures are ignored. Errors: malformed files, required extensions that
/// change the geometry, sparse accessors, files outside. Never fails but by a Result, whatever the
/// bytes; memory O(bytes).
Result<Model> read_glb(std::string_view bytes, const std::string& file);

/// The rotation with the smallest angle that takes `up` (not zero) to +Y; exact for the axes.
Mat3 rotation_to_y_up(const Vec3d& up);

}  // namespace cs2mesh
