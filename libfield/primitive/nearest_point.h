// The point of a primitive that is nearest to a given one.
#pragma once

#include "libfield/primitive/primitive.h"

namespace cs2mesh {

/// Absolute error of a few ulp of the distance and of the primitive's size. Where several points
/// are nearest, one of them.
Vec3d nearest_point(const Point& point, const Vec3d& p);
Vec3d nearest_point(const Segment& segment, const Vec3d& p);
Vec3d nearest_point(const TaperedSegment& segment, const Vec3d& p);
Vec3d nearest_point(const Arc& arc, const Vec3d& p);
Vec3d nearest_point(const Triangle& triangle, const Vec3d& p);
Vec3d nearest_point(const Plane& plane, const Vec3d& p);

/// Whether the point lies in the prism over the triangle, where the nearest point is the
/// projection; elsewhere it is on the nearest edge.
bool is_above(const Triangle& triangle, const Vec3d& p);
Segment nearest_edge(const Triangle& triangle, const Vec3d& p);

}  // namespace cs2mesh
