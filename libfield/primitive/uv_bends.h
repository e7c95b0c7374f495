// Bounds of the second derivatives of the UV coordinates of a primitive over a box.
#pragma once

#include "libfield/base/aabb.h"
#include "libfield/primitive/primitive.h"

namespace cs2mesh {

/// Upper bounds of the operator norms of D^2 u and D^2 v (see uv_hessian.h) at every point of the
/// box; infinite where the coordinate may have a corner, as where it begins to be clamped, or jump
/// there, and where the box reaches an axis of its angle.
struct UvBends {
  double u = 0.0, v = 0.0;
};

UvBends bound_uv_bends(const Point& point, const Aabb& box);
UvBends bound_uv_bends(const Segment& segment, const Aabb& box);
UvBends bound_uv_bends(const Arc& arc, const Aabb& box);
UvBends bound_uv_bends(const Triangle& triangle, const Aabb& box);
UvBends bound_uv_bends(const Plane& plane, const Aabb& box);
inline UvBends bound_uv_bends(const TaperedSegment& segment, const Aabb& box) {
  return bound_uv_bends(segment.axis, box);
}

}  // namespace cs2mesh
