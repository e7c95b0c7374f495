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

/// How far a surface is above a triangle, at least and at most; 0 is between, as at the corners.
struct DeviationRange {
  double low = 0.0, high = 0.0;
};

/// Of a surface through the corners of a triangle that rises by these sagittas over its edges, to
/// second order: of 4 (s01 l0 l1 + s12 l1 l2 + s20 l2 l0) over the barycentric coordinates l.
inline DeviationRange deviation_range(double s01, double s12, double s20) {
  DeviationRange range{std::min({0.0, s01, s12, s20}), std::max({0.0, s01, s12, s20})};
  // Where the gradient of the form is the same in all three coordinates.
  const double l0 = s12 * (s01 + s20 - s12);
  const double l1 = s20 * (s01 + s12 - s20);
  const double l2 = s01 * (s12 + s20 - s01);
  if ((l0 > 0 && l1 > 0 && l2 > 0) || (l0 < 0 && l1 < 0 && l2 < 0)) {
    const double inside = 4 * s01 * s12 * s20 / (l0 + l1 + l2);
    range.low = std::min(range.low, inside);
    range.high = std::max(range.high, inside);
  }
  return range;
}

/// The greatest distance between a triangle and a surface that is so far above it, if the triangle
/// is lifted by that part, in [0, 1], of what has it as far below as above.
inline double distance_from(const DeviationRange& range, double lift) {
  const double height = 0.5 * lift * (range.low + range.high);
  return std::max(range.high - height, height - range.low);
}

/// The same of a triangle with these sagittas that is not lifted. For an equilateral one on a
/// sphere that is 4/3 of the sagitta.
inline double deviation(double s01, double s12, double s20) {
  return distance_from(deviation_range(s01, s12, s20), 0.0);
}

}  // namespace cs2mesh
