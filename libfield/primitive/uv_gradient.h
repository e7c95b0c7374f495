// Bounds of the gradients of the UV coordinates of a primitive over a box.
#pragma once

#include <array>

#include "libfield/base/aabb.h"
#include "libfield/base/interval.h"
#include "libfield/primitive/primitive.h"

namespace cs2mesh {

/// Each component of grad u and grad v lies in its interval, at every point of the box where the
/// coordinate does not jump; `seam` tells that u jumps between 0 and 1 (or v does) in the box.
struct UvGradientBound {
  std::array<Interval, 3> u, v;
  bool seam_u = false, seam_v = false;
};

/// Of the ball around a box, rounded up.
double ball_radius(const Aabb& box);

UvGradientBound enclose_uv_gradient(const Point& point, const Aabb& box);
UvGradientBound enclose_uv_gradient(const Segment& segment, const Aabb& box);
UvGradientBound enclose_uv_gradient(const Arc& arc, const Aabb& box);
UvGradientBound enclose_uv_gradient(const Triangle& triangle, const Aabb& box);
UvGradientBound enclose_uv_gradient(const Plane& plane, const Aabb& box);
inline UvGradientBound enclose_uv_gradient(const TaperedSegment& segment, const Aabb& box) {
  return enclose_uv_gradient(segment.axis, box);
}

}  // namespace cs2mesh
