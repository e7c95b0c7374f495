// What the values and slopes at both ends of an interval of length h prove about a function u
// between them, given |u''| <= M or slopes within an interval.
//
// The extreme functions are "bang-bang": their second derivative is -M or +M throughout. Let u have
// a stationary point at distance x from the end with value u0 and slope s. Its slope v obeys
// v(tau) >= max(s - M tau, -M (x - tau)), so that
//   u(x) >= u0 + s x / 2 - M x^2 / 4 + s^2 / (4 M),   and x >= |s| / M.
// The same holds seen from the other end. No search or closed-form root is needed.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/base/interval.h"

namespace cs2mesh {

/// Value and slope at one end of an interval.
struct EndJet {
  double value = 0.0;
  double slope = 0.0;
};

/// True only if u' vanishes nowhere on the interval: to come from slope a to 0 and on to slope b
/// takes a length of (|a| + |b|) / M.
inline bool is_monotone(double slope_a, double slope_b, double h, double M) {
  return std::abs(slope_a) + std::abs(slope_b) > M * h * (1.0 + 1e-12);
}

/// A lower bound of |u'| on the interval; 0 where there is none.
inline double least_slope(double slope_a, double slope_b, double h, double M) {
  return std::max(0.0, 0.5 * (std::abs(slope_a) + std::abs(slope_b) - M * h));
}

/// The greatest lower bound that the data allow for u on the interval, |u''| <= M < infinity, up to
/// rounding.
inline double least_value(const EndJet& a, const EndJet& b, double h, double M) {
  const double ends = std::min(a.value, b.value);
  const double slope_b = -b.slope;  // seen from b, looking back
  if (is_monotone(a.slope, slope_b, h, M)) return ends;
  if (!(M > 0.0)) return ends;

  // Lowest value of a stationary point at x, as each end allows it.
  const double constant_a = a.value + a.slope * a.slope / (4.0 * M);
  const double constant_b = b.value + slope_b * slope_b / (4.0 * M);
  const auto from_a = [&](double x) { return constant_a + 0.5 * a.slope * x - 0.25 * M * x * x; };
  const auto from_b = [&](double x) {
    const double y = h - x;
    return constant_b + 0.5 * slope_b * y - 0.25 * M * y * y;
  };
  const auto both = [&](double x) { return std::max(from_a(x), from_b(x)); };

  // The stationary point lies between these; both bounds are concave in x and their difference is
  // linear, so the least of their maximum is at an end or where they meet.
  const double first = std::min(h, std::abs(a.slope) / M);
  const double last = std::max(0.0, h - std::abs(slope_b) / M);
  double least = std::min({ends, both(first), both(last)});
  const double rise = 0.5 * (a.slope + slope_b - M * h);  // d/dx (from_a - from_b)
  if (rise != 0.0) {
    const double meet = -(from_a(0.0) - from_b(0.0)) / rise;
    if (meet > first && meet < last) least = std::min(least, from_a(meet));
  }
  return least;
}

/// The greatest lower bound of u on the interval when its slopes lie in `slope`.
inline double least_value(const EndJet& a, const EndJet& b, double h, const Interval& slope) {
  const double ends = std::min(a.value, b.value);
  if (slope.lo >= 0.0 || slope.hi <= 0.0) return ends;
  if (!std::isfinite(slope.lo) || !std::isfinite(slope.hi)) {
    return -std::numeric_limits<double>::infinity();
  }
  // Down from a as steeply as allowed, then up to b likewise.
  const double x = std::clamp((b.value - a.value - slope.hi * h) / (slope.lo - slope.hi), 0.0, h);
  return std::min(ends, a.value + slope.lo * x);
}

/// How far from an end, seen from there, u - `floor` stays positive for certain; 0 if not at all.
inline double certain_reach(const EndJet& end, double floor, double M) {
  const double margin = end.value - floor;
  if (!(margin > 0.0) || !(M > 0.0)) return 0.0;
  const double root = std::sqrt(end.slope * end.slope + 2.0 * M * margin);
  // Two forms of the same root, each without cancellation.
  return end.slope >= 0.0 ? (end.slope + root) / M : 2.0 * margin / (root - end.slope);
}

}  // namespace cs2mesh
