// --verify: how far the meshes, as they will be written, are from the surfaces.
#pragma once

#include <string>
#include <vector>

#include "cli/mesh_parts.h"
#include "polygonize/mesh_file.h"

namespace cs2mesh {

/// The first of the paths for each way in which their formats store coordinates.
std::vector<std::string> paths_by_rounding(const std::vector<std::string>& paths);

/// What becomes of coordinates when they are written.
struct OutputRounding {
  std::vector<std::string> outputs;  ///< by their formats
  MeshFileOptions file;
};

/// The largest error of all parts and outputs.
struct Measured {
  MeasuredError error;
  std::string what;  ///< the part, for people
  SourceLocation where;
};

/// Measures both ways, with rays that miss no sheet that they cross: part by part, or with `united`
/// the union, where what of a surface is inside of another does not count. `exact` are the surfaces
/// without a counter. Throws Exit where that is interrupted.
Measured measure_outputs(const MeshedScene& meshed, const CompiledScene& exact,
                         const OutputRounding& rounding, bool united, Console& console);

}  // namespace cs2mesh
