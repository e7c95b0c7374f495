// Where a gradient can be, from its value in the middle and a bound of the second derivative.
#pragma once

#include <array>

#include "libfield/base/interval.h"
#include "libfield/base/vec.h"

namespace cs2mesh {

/// Contains each component of a gradient within `reach` of a point where it is `middle`;
/// `curvature` bounds the second derivative (infinity: not known), `most` the gradient itself.
inline std::array<Interval, 3> turning_gradient(const Vec3d& middle, double curvature, double reach,
                                                double most) {
  const double turn = curvature * reach * (1 + 1e-15) + 1e-14 * most;
  const double bound = most * (1 + 1e-14);
  const Interval all(-bound, bound);
  if (!(turn < 2 * bound)) return {all, all, all};
  return {intersection(all, widened(middle.x, turn)), intersection(all, widened(middle.y, turn)),
          intersection(all, widened(middle.z, turn))};
}

}  // namespace cs2mesh
