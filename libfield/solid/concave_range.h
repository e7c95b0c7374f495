// The range of a concave function over a box.
#pragma once

#include <algorithm>
#include <limits>

#include "libfield/base/aabb.h"
#include "libfield/base/interval.h"
#include "libfield/base/jet.h"
#include "libfield/field/quadratic_range.h"

namespace cs2mesh {

/// Contains a concave function over the box, but for rounding, of which `jet_at` gives value and
/// supergradient: it is smallest at a corner, and nowhere above its tangent at the middle.
template <class JetAt>
Interval concave_range(const JetAt& jet_at, const Aabb& box) {
  double least = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    least = std::min(least, jet_at(box.corner(corner)).value);
  }
  const Jet middle = jet_at(box.center());
  const double rise = extent_along(middle.gradient, 0.5 * box.extent());
  return {least, std::max(least, middle.value + rise)};
}

}  // namespace cs2mesh
