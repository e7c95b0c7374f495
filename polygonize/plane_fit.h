// The point that lies nearest to a handful of planes at once, in the sense of least squares: where
// the faces of a surface meet that is known by its tangent planes (the quadratic error function of
// Garland and Heckbert 1997, and of the dual contouring of Ju, Losasso, Schaefer and Warren 2002).
#pragma once

#include <span>

#include "libfield/base/vec.h"

namespace cs2mesh {

/// {x : dot(normal, x) == offset}, the normal of length one.
struct Plane {
  Vec3d normal;
  double offset = 0.0;
};

/// The point that minimises the sum of squared distances to the planes, as near to `start` as that
/// leaves it: along principal directions in which the planes' normals hold less than `cutoff` of
/// what they hold in the strongest, it stays at `start`. In scene units; `cutoff` in (0, 1). With
/// no planes, `start`. O(planes).
Vec3d point_near_planes(std::span<const Plane> planes, const Vec3d& start, double cutoff);

}  // namespace cs2mesh
