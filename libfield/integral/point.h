// Any kernel at a point: f(p) = h(r^2), grad f = 2 K(r^2) (p - q), r = |p - q| (thesis
// section 2.2). Accurate to a few ulp. Finite for every finite p, but for an inverse kernel without
// clamp on the point itself.
#pragma once

#include "libfield/base/jet.h"
#include "libfield/kernel/kernel.h"
#include "libfield/primitive/point.h"

namespace cs2mesh {

/// Value and gradient of the field of a point.
template <class K, class T>
JetOf<T> integral(const K& kernel, const Point& point, const Vec3<T>& p) {
  const Vec3<T> d = p - Vec3<T>(point.position);
  const T u = squared_norm(d);
  return {kernel.profile(u), T(2) * kernel.slope(u) * d};
}

}  // namespace cs2mesh
