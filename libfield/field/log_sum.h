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

#include <span>
#include <vector>

#include "libfield/base/interval.h"
#include "libfield/field/term_bounds.h"

namespace cs2mesh {

/// Whether bounds of sums with this term can be had in the exponent: a Gaussian over a point, a
/// segment or a triangle, added, not transformed and not weighted, and not too stiff.
bool has_log_bounds(const Term& term);

/// A sum of such terms near the centre of a box.
class LogSum {
 public:
  /// The terms at the centres of some boxes, box by box; all have has_log_bounds(). Costs an
  /// evaluation a term and box, for points some 3 ns.
  static std::vector<LogSum> at_centers(std::span<const Term> terms,
                                        std::span<const std::uint32_t> list,
                                        std::span<const BatchBox> boxes);

  /// Contains log F over the box, rounding included, of the sum whose exponents are not cut off.
  /// Some 10 ns a term.
  Interval range(const BatchBox& box) const;
  /// A lower bound, over the box, of the derivative of log F along a direction.
  double least_slope(const BatchBox& box, const Vec3d& direction) const;

 private:
  struct Exponent {
    double phi = 0.0;  ///< at the centre
    Vec3d gradient;
    /// D^2 phi is between minus the one and minus the other, everywhere.
    double most_bend = 0.0, least_bend = 0.0;
  };
  std::vector<Exponent> terms_;
  double negligible_ = 0.0;  ///< an upper bound of the sum of the other terms over the box
};

}  // namespace cs2mesh
