// The unbounded plane; its measure is infinite.
#pragma once

#include "libfield/base/aabb.h"
#include "libfield/base/affine.h"
#include "libfield/base/vec.h"
#include "libfield/primitive/frame.h"

namespace cs2mesh {

struct Plane {
  static constexpr int kDimension = 2;
  Vec3d point;
  Vec3d normal{0, 0, 1};  ///< unit
};

/// Infinite.
double measure(const Plane& plane);
/// Distance from `p` to the primitive; absolute error of a few ulp of the distance and of the
/// primitive's size.
double distance(const Plane& plane, const Vec3d& p);
/// All of space, but flat across a normal along an axis.
Aabb bounds(const Plane& plane);
/// Its `point`.
Vec3d middle(const Plane& plane);
/// Infinite.
double size(const Plane& plane);
/// u along reference_axis(normal), v along normal x that, from `point`; scene units.
Uv uv(const Plane& plane, const Vec3d& p);
/// Contains (u, v) for all points of the box; a whole range where the box meets a seam or an axis.
UvIntervals enclose_uv(const Plane& plane, const Aabb& box);
/// The image under the map. It must be invertible.
Plane transformed(const Plane& plane, const Affine& map);

}  // namespace cs2mesh
