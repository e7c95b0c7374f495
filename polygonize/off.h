// OFF, the Object File Format of Geomview.
#pragma once

#include <string>
#include <string_view>

#include "libfield/base/result.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Reads ASCII OFF and its variants with colours, normals or texture coordinates behind the
/// coordinates of a vertex (COFF, NOFF, STOFF), of which only the coordinates are kept. Polygons
/// become fans. Errors are located at the line in `file`. Never fails but by a Result, whatever the
/// bytes; memory O(bytes).
Result<Model> read_off(std::string_view text, const std::string& file);

}  // namespace cs2mesh
