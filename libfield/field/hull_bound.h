// How far a function may bend down, and how fast it grows, all over the convex hull of a few
// points: what bounds over shapes that are no boxes are made of (see polygonize/bent_triangle.h).
#pragma once

#include <cmath>
#include <limits>

#include "libfield/base/jet.h"

namespace cs2mesh {

/// Of G = log(1 + F) or G = F, which have the sign of F. What it says holds of a function that
/// differs from F by at most `error`.
struct HullBound {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  bool in_exponent = false;   ///< G = log(1 + F)
  double bend = kInfinity;    ///< d^T D^2 G d >= -bend |d|^2, per squared length; may be infinite
  double slope = -kInfinity;  ///< <= the derivative of G along each of the directions asked for
  double error = 0.0;         ///< in units of F

  /// A lower and an upper bound of G where F has that value.
  double low(double value) const { return level(value - slack(value)); }
  double high(double value) const { return level(value + slack(value)); }
  /// The gradient of G, but for the error.
  Vec3d gradient(const Jet& jet) const {
    return in_exponent ? jet.gradient / (1.0 + jet.value) : jet.gradient;
  }

 private:
  double level(double value) const {
    if (!in_exponent) return value;
    return value > -1.0 ? std::log1p(value) : -kInfinity;
  }
  /// The error, and what rounding of thousands of terms leaves open.
  double slack(double value) const { return error + 1e-13 * (2.0 + std::abs(value)); }
};

}  // namespace cs2mesh
