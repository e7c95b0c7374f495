#include "libfield/ray/ray.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cs2mesh {

RayRange clip(const Ray& ray, const Aabb& box, RayRange range) {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis];
    const double d = ray.direction[axis];
    // The rounding of o + t d, and of the quotients below, as a width of the slab.
    const auto slack = [&](double side) { return 4.0 * kEpsilon * (std::abs(o) + std::abs(side)); };
    const double lo = box.min[axis] - slack(box.min[axis]);
    const double hi = box.max[axis] + slack(box.max[axis]);
    if (d == 0.0) {
      if (o < lo || o > hi) return {1.0, 0.0};
      continue;
    }
    double enter = (lo - o) / d;
    double leave = (hi - o) / d;
    if (enter > leave) std::swap(enter, leave);
    // A side at infinity makes its slack infinite too, and then the difference may be NaN.
    if (std::isfinite(enter)) range.t0 = std::max(range.t0, enter);
    if (std::isfinite(leave)) range.t1 = std::min(range.t1, leave);
  }
  return range;
}

}  // namespace cs2mesh
