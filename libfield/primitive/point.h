// The point primitive; its measure is 1.
#pragma once

#include "libfield/base/aabb.h"
#include "libfield/base/affine.h"
#include "libfield/base/vec.h"
#include "libfield/primitive/frame.h"

namespace cs2mesh {

struct Point {
  static constexpr int kDimension = 0;
  Vec3d position;
};

/// 1.
double measure(const Point& point);
/// Distance from `p` to the primitive; absolute error of a few ulp of the distance and of the
/// primitive's size.
double distance(const Point& point, const Vec3d& p);
/// The point alone.
Aabb bounds(const Point& point);
/// The point.
Vec3d middle(const Point& point);
/// 0.
double size(const Point& point);
/// u: azimuth from x towards y in turns, [0, 1); v: angle from +z in half turns, [0, 1].
Uv uv(const Point& point, const Vec3d& p);
/// Contains (u, v) for all points of the box; a whole range where the box meets a seam or an axis.
UvIntervals enclose_uv(const Point& point, const Aabb& box);
/// The image under the map. Any map.
Point transformed(const Point& point, const Affine& map);

}  // namespace cs2mesh
