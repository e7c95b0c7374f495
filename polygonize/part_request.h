// What a mesher is asked for where it meshes a part of a scene.
#pragma once

#include "libfield/field/compile.h"
#include "libfield/field/counted_surface.h"
#include "polygonize/mesher.h"

namespace cs2mesh {

/// The length scale of a part; one without radii (widths alone) has that of its box. > 0.
double length_scale(const Part& part);

/// The part to within `tolerance`, in scene units, with the limits that MesherRequest has by
/// itself.
MesherRequest request_for(const Part& part, double tolerance, Progress* progress);

/// From now on the surfaces of all parts count what they are asked in `counter`, which outlives
/// them.
void count_evaluations(CompiledScene& scene, EvaluationCounter& counter);

}  // namespace cs2mesh
