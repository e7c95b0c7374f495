// Rays and what is found along them.
#pragma once

#include "libfield/base/aabb.h"
#include "libfield/base/vec.h"

namespace cs2mesh {

/// The half-line origin + t direction; `direction` has unit length, so t is a length.
struct Ray {
  Vec3d origin;
  Vec3d direction{0, 0, 1};

  Vec3d at(double t) const { return origin + t * direction; }
};

/// The part [t0, t1] of a ray; empty when t0 > t1.
struct RayRange {
  double t0 = 0.0;
  double t1 = 0.0;

  bool empty() const { return !(t0 <= t1); }
};

/// The part of `range` that lies in `box`. Contains every t for which ray.at(t), as rounded, is in
/// the box; may be longer by a few ulps.
RayRange clip(const Ray& ray, const Aabb& box, RayRange range);

}  // namespace cs2mesh
