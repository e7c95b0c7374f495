// Wavefront OBJ, with its material library (MTL) beside it.
#pragma once

#include <string>
#include <string_view>

#include "libfield/base/result.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct ObjOptions {
  bool normals = true;  ///< write `vn` lines, where the mesh has normals
  /// Write colours, where the mesh has them: sRGB behind the coordinates of each vertex (`v x y z r
  /// g b`, which MeshLab, Blender and others read), and in the material library beside the file a
  /// material for each part with the mean of its colours.
  bool colors = true;
};

/// Writes `o NAME`, vertices and faces for each part. Coordinates have as many digits as it takes
/// to read back the same doubles. The material library gets the extension .mtl in place of the
/// file's. Deterministic. Errors: as AtomicFile::commit.
Result<Done> write_obj(const Model& model, const std::string& path, const ObjOptions& options = {});

/// Reads `v` (with sRGB colours, if three numbers follow), `vn`, `f`, `o` and `g`, and skips all
/// else. Polygons become fans of triangles; indices may be negative. `o` and `g` begin parts, as
/// split_into_parts describes. Normals and colours are kept where every vertex has exactly one.
/// Errors are located at the line in `file`. Never fails but by a Result, whatever the bytes; time
/// O(n log n) and memory O(n) in their number.
Result<Model> read_obj(std::string_view text, const std::string& file);

}  // namespace cs2mesh
