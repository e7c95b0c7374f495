// What a mesher is asked for where it meshes a part of a scene.
#pragma once

#include "libfield/field/compile.h"
#include "polygonize/mesher.h"

namespace cs2mesh {

/// The length scale of a part; one without radii (widths alone) has that of its box. > 0.
double length_scale(const Part& part);

/// The part to within `tolerance`, in scene units, with the limits that MesherRequest has by
/// itself.
MesherRequest request_for(const Part& part, double tolerance, Progress* progress);

}  // namespace cs2mesh
