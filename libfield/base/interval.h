// Intervals of reals with outward rounding: every operation returns an interval that contains the
// exact result for all arguments in its operands. One ulp is added on either side rather than
// changing the rounding mode, so the code is correct under any mode and optimisation level.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace cs2mesh {

struct Interval {
  double lo = 0.0;
  double hi = 0.0;

  constexpr Interval() = default;
  constexpr Interval(double point) : lo(point), hi(point) {}  // NOLINT(google-explicit-constructor)
  constexpr Interval(double lo_, double hi_) : lo(lo_), hi(hi_) {}

  static Interval everything() {
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  bool contains(double x) const { return lo <= x && x <= hi; }
  bool contains(const Interval& x) const { return lo <= x.lo && x.hi <= hi; }
  double width() const { return hi - lo; }
  double magnitude() const { return std::max(std::abs(lo), std::abs(hi)); }
  friend bool operator==(const Interval&, const Interval&) = default;
};

/// The next larger double; an infinity or NaN stays. As std::nextafter, but inline.
inline double next_up(double x) {
  if (!(x < std::numeric_limits<double>::infinity())) return x;
  if (x == 0) return std::numeric_limits<double>::denorm_min();
  if (x == -std::numeric_limits<double>::infinity()) return x;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  return std::bit_cast<double>(x > 0 ? bits + 1 : bits - 1);
}
inline double next_down(double x) {
  return -next_up(-x);
}
inline Interval outward(double lo, double hi) {
  return {next_down(lo), next_up(hi)};
}

inline Interval operator+(const Interval& a, const Interval& b) {
  return outward(a.lo + b.lo, a.hi + b.hi);
}
inline Interval operator-(const Interval& a, const Interval& b) {
  return outward(a.lo - b.hi, a.hi - b.lo);
}
inline Interval operator-(const Interval& a) {
  return {-a.hi, -a.lo};
}
inline Interval operator*(const Interval& a, const Interval& b) {
  const double p[4] = {a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi};
  // 0 * inf is 0 here: the bounds are limits of finite products.
  double lo = std::numeric_limits<double>::infinity();
  double hi = -lo;
  for (const double q : p) {
    const double value = std::isnan(q) ? 0.0 : q;
    lo = std::min(lo, value);
    hi = std::max(hi, value);
  }
  return outward(lo, hi);
}

/// The smallest interval that contains both.
inline Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}
/// The common part of two enclosures of the same value; they are known to overlap.
inline Interval intersection(const Interval& a, const Interval& b) {
  return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
}
/// `a` grown by `margin` >= 0 on both sides.
inline Interval widened(const Interval& a, double margin) {
  return outward(a.lo - margin, a.hi + margin);
}

}  // namespace cs2mesh
