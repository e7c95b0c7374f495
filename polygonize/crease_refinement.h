// Finer triangles where parts meet, so that the crease of their union is where it should be.
#pragma once

#include <span>

#include "libfield/base/progress.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Where two surfaces meet at an angle a, outside of both, meshes that are off by d have their
/// crease off by d / sin(a / 2). So, before they are united, the triangles of each part that
/// intersect those of another, and those around them, are refined to sin(a / 2) of the tolerance,
/// but to no less than an eighth; a is the smallest angle between such triangles of the part.
///
/// Where the finer mesh of a part would fail check(), the part stays as it is.
///
/// `surfaces` are those of the model's parts; the parts are as refine() wants them, and have no
/// attributes. Nothing else changes. The same result for any number of threads.
void refine_at_creases(std::span<const ImplicitSurface* const> surfaces, Model& model,
                       double tolerance, Progress* progress = nullptr);

}  // namespace cs2mesh
