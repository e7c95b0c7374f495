// STL, the stereolithography format: triangles without connectivity.
#pragma once

#include <string>
#include <string_view>

#include "libfield/base/result.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Writes binary STL: float32 corners and face normals, all parts in one list. Coordinates are
/// rounded to float32 (see round_to_format). Deterministic. Errors: as AtomicFile::commit; a
/// coordinate beyond the range of float32, more than 2^32 - 1 triangles.
Result<Done> write_stl(const Model& model, const std::string& path);

/// Reads binary and ASCII STL and makes corners at equal positions one vertex. Each `solid` of an
/// ASCII file is a part. Errors are located at the line in `file` for ASCII. Never fails but by a
/// Result, whatever the bytes; time O(n log n), memory O(n).
Result<Model> read_stl(std::string_view bytes, const std::string& file);

}  // namespace cs2mesh
