// How far a triangle with its corners on a smooth surface is from it, by the normals there.
#pragma once

#include <algorithm>
#include <cmath>

#include "libfield/base/vec.h"

namespace cs2mesh {

/// How far the surface rises above the middle of a chord with these ends and unit normals there, to
/// second order: positive where it is convex. Of a circle, it is the sagitta.
inline double sagitta(const Vec3d& a, const Vec3d& na, const Vec3d& b, const Vec3d& nb) {
  return 0.125 * dot(b - a, nb - na);
}

/// The greatest distance between a triangle and a surface through its corners that rises by these
/// sagittas over its edges, to second order: of 4 (s01 l0 l1 + s12 l1 l2 + s20 l2 l0) over the
/// barycentric coordinates l. For an equilateral triangle on a sphere that is 4/3 of the sagitta.
inline double deviation(double s01, double s12, double s20) {
  double most = std::max({std::abs(s01), std::abs(s12), std::abs(s20)});
  // Where the gradient of the form is the same in all three coordinates.
  const double l0 = s12 * (s01 + s20 - s12);
  const double l1 = s20 * (s01 + s12 - s20);
  const double l2 = s01 * (s12 + s20 - s01);
  const double sum = l0 + l1 + l2;
  if ((l0 > 0 && l1 > 0 && l2 > 0) || (l0 < 0 && l1 < 0 && l2 < 0)) {
    most = std::max(most, std::abs(4 * s01 * s12 * s20 / sum));
  }
  return most;
}

}  // namespace cs2mesh
