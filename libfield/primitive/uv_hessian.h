// The second derivatives of the UV coordinates of a primitive, beside uv() of each.
#pragma once

#include "libfield/base/jet2.h"
#include "libfield/primitive/primitive.h"

namespace cs2mesh {

/// 0 where uv() gives a gradient of 0: where a coordinate is clamped, and on the axis of an angle.
struct UvHessian {
  Symmetric3 u, v;
};

UvHessian uv_hessian(const Point& point, const Vec3d& p);
UvHessian uv_hessian(const Segment& segment, const Vec3d& p);
inline UvHessian uv_hessian(const TaperedSegment& segment, const Vec3d& p) {
  return uv_hessian(segment.axis, p);
}
UvHessian uv_hessian(const Arc& arc, const Vec3d& p);
UvHessian uv_hessian(const Triangle& triangle, const Vec3d& p);
UvHessian uv_hessian(const Plane& plane, const Vec3d& p);

}  // namespace cs2mesh
