// --verify: how far the meshes, as they will be written, are from the surfaces.
#pragma once

#include <string>
#include <vector>

#include "cli/mesh_parts.h"
#include "polygonize/mesh_file.h"

namespace cs2mesh {

/// The first of the paths for each way in which their formats store coordinates.
std::vector<std::string> paths_by_rounding(const std::vector<std::string>& paths);

struct VerifyOptions {
  double tolerance = 0.0;  ///< scene units
  /// Whether the parts are to be measured as their union: what of a surface is inside of another
  /// does not count then.
  bool united = false;
  std::vector<std::string> outputs;  ///< whose formats the coordinates are rounded to
  MeshFileOptions file;
};

/// Measures both ways, with rays that miss no sheet that they cross; the largest error of all parts
/// and outputs. `exact` are the surfaces without a counter. Throws Exit{kToleranceMissed} if one is
/// off.
MeasuredError verify(const MeshedScene& meshed, const CompiledScene& exact,
                     const VerifyOptions& options, Console& console);

}  // namespace cs2mesh
