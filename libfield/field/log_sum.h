// Bounds of sums of Gaussian terms, in the exponent.
//
// A Gaussian over a convex skeleton is f = exp(phi), and phi is concave with a second derivative
// between -2 a^2 and 0 (convolutions of log-concave functions are log-concave, Prekopa 1973). With
// d = p - p0, g = grad phi(p0) and the weights w = f / F at p0, the logarithm L of the sum F obeys
//   L(p0) + sum w (g . d - a^2 |d|^2) <= L(p) <= L(p0) + G . d + log sum w exp((g - G) . d),
// G = sum w g being the gradient of L: on the left as L is convex in the phi, on the right as each
// phi stays below its tangent; over a point, phi is -a^2 r^2 itself, which is better. Since sum w
// (g - G) = 0 and e^y <= 1 + y + y^2 psi(s) for |y| <= s, psi(s) = (e^s - 1 - s) / s^2, the last
// logarithm is at most log(1 + sum w s^2 psi(s)): of second order. However steep the terms, nothing
// here is as steep as they are.
//
// Likewise grad L = sum w(p) grad phi, and the ratio of two terms is exp of something of small
// curvature: where all terms that matter pull the same way, L grows that way.
#pragma once

#include <boost/container/small_vector.hpp>
#include <cstdint>
#include <span>
#include <vector>

#include "libfield/base/interval.h"
#include "libfield/field/exponents.h"
#include "libfield/field/term_bounds.h"

namespace cs2mesh {

/// Whether bounds of sums with this term can be had in the exponent: a Gaussian over a point, a
/// segment or a triangle, added, not transformed and not weighted, and not too stiff.
bool has_log_bounds(const Term& term);

/// The terms that matter in a box, ready to be bounded in smaller ones.
class LogTerms {
 public:
  /// Of the terms of `list`, all with has_log_bounds(), leaves out what together stays below
  /// `share` over the box. `terms` must outlive this.
  LogTerms(std::span<const Term> terms, std::span<const std::uint32_t> list, const Aabb& box,
           double share);

  /// Upper bounds over the box of the sum of what was left out and of the norm of its gradient.
  double left_out() const { return left_out_; }
  double left_out_slope() const { return left_out_slope_; }

 private:
  friend class LogSum;
  void leave_out(double value, double steepness);

  enum PointRow { x, y, z, curvature, log_amplitude, kPointRows };
  std::span<const Term> terms_;
  std::vector<double> points_;         ///< row by row
  std::vector<std::uint32_t> others_;  ///< segments and triangles
  double left_out_ = 0.0, left_out_slope_ = 0.0;
};

/// The sum of such terms near the centre of a box.
class LogSum {
 public:
  /// `box` lies in that of the terms. Costs about a nanosecond a point, an evaluation a term of the
  /// others.
  LogSum(const LogTerms& terms, const BatchBox& box);

  /// Contains log F over the box, rounding included, of the sum whose exponents are not cut off.
  /// Some 3 ns a term.
  Interval range();
  /// A lower bound, over the box, of the derivative of log F along a direction. Some 2 ns a term.
  double least_slope(const Vec3d& direction) const;
  /// A direction in which all terms that matter in the box grow, if there is one; of length 1
  /// where anything matters.
  Vec3d common_direction() const;

 private:
  void add_points(const LogTerms& terms, const Vec3d& center);
  void add_others(const LogTerms& terms, const BatchBox& box);
  void find_first_and_fill_up(std::size_t used);

  static constexpr std::size_t kFewTerms = 64;
  boost::container::small_vector<double, ExponentRows::kRows * kFewTerms> numbers_;
  ExponentRows rows_;
  ExponentBox box_;
  double negligible_ = 0.0;  ///< an upper bound of the sum of terms that have no row
};

}  // namespace cs2mesh
