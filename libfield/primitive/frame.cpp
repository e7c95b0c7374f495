#include "libfield/primitive/frame.h"

#include <cmath>
#include <numbers>

namespace cs2mesh {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// Rounding of an angle and of what it was computed from.
constexpr double kAngleSlack = 1e-14;

}  // namespace

Vec3d reference_axis(const Vec3d& w) {
  const Vec3d n = normalized(w);
  const Vec3d world = std::abs(n.x) > 0.999 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
  return normalized(world - dot(world, n) * n);
}

Interval enclose_linear(const Vec3d& g, const Vec3d& origin, const Aabb& box) {
  Interval sum;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sum = sum + Interval(g[axis]) * (Interval(box.min[axis], box.max[axis]) - origin[axis]);
  }
  return sum;
}

Interval enclose_hypot(const Interval& x, const Interval& y) {
  const auto least = [](const Interval& a) {
    return std::max(0.0, std::max(a.lo, -a.hi));  // distance from 0 to the interval
  };
  const double lo = std::hypot(least(x), least(y));
  const double hi = std::hypot(x.magnitude(), y.magnitude());
  return {std::max(0.0, next_down(next_down(lo))), next_up(next_up(hi))};
}

Interval enclose_angle(const Interval& y, const Interval& x) {
  if (x.lo <= 0.0 && y.lo <= 0.0 && 0.0 <= y.hi) return {-std::numbers::pi, std::numbers::pi};
  // The rectangle is convex and misses the origin: its extreme directions are at its corners.
  Interval angle{INFINITY, -INFINITY};
  for (const double yy : {y.lo, y.hi}) {
    for (const double xx : {x.lo, x.hi}) {
      const double a = std::atan2(yy, xx);
      angle = hull(angle, a);
    }
  }
  return widened(angle, kAngleSlack);
}

double turn(double y, double x) {
  const double fraction = std::atan2(y, x) / kTurn;
  const double positive = fraction < 0.0 ? fraction + 1.0 : fraction;
  return positive < 1.0 ? positive : 0.0;
}

Interval enclose_turn(const Interval& y, const Interval& x) {
  // Half a turn on, the seam of [0, 1) is that of enclose_angle.
  const bool meets_seam = x.hi >= 0.0 && y.lo <= kAngleSlack && -kAngleSlack <= y.hi;
  if (meets_seam) return {0.0, 1.0};
  const Interval half_turn_on = enclose_angle(-y, -x);
  return clamped_to_unit(
      widened({half_turn_on.lo / kTurn + 0.5, half_turn_on.hi / kTurn + 0.5}, kAngleSlack));
}

Interval clamped_to_unit(const Interval& x) {
  return {std::clamp(x.lo, 0.0, 1.0), std::clamp(x.hi, 0.0, 1.0)};
}

}  // namespace cs2mesh
