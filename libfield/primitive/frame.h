// The frame that the scene language attaches to a direction, and coordinates on a primitive.
#pragma once

#include <utility>

#include "libfield/base/aabb.h"
#include "libfield/base/interval.h"

namespace cs2mesh {

/// The unit vector perpendicular to `w` (not zero) from which angles about w are counted: world x
/// made perpendicular to w, or world y where |w.x| > 0.999 |w|.
Vec3d reference_axis(const Vec3d& w);

/// Surface coordinates of a point over a primitive and their gradients (1 / length). Where a
/// coordinate is clamped its gradient is 0; on the axis of an angle it is 0 too.
struct Uv {
  double u = 0.0, v = 0.0;
  Vec3d grad_u, grad_v;
};
using UvIntervals = std::pair<Interval, Interval>;

/// Contains g . (p - origin) for all p in the box.
Interval enclose_linear(const Vec3d& g, const Vec3d& origin, const Aabb& box);
/// Contains the distance of (x, y) from (0, 0).
Interval enclose_hypot(const Interval& x, const Interval& y);
/// Contains atan2(y, x) in [-pi, pi]; that whole range if the pair may be (0, 0) or the rectangle
/// meets the negative x-axis.
Interval enclose_angle(const Interval& y, const Interval& x);
/// The angle of (x, y) in turns, in [0, 1), and an enclosure of it ([0, 1] across its seam).
double turn(double y, double x);
Interval enclose_turn(const Interval& y, const Interval& x);
/// The part of `x` in [0, 1], moved there if there is none.
Interval clamped_to_unit(const Interval& x);

}  // namespace cs2mesh
