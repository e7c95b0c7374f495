// Sums of functions that are known in the exponent: F = sum exp(phi_i), each phi_i with a second
// derivative between -most_i and -least_i over a box, of either sign.
//
// With d = p - p0, g_i = grad phi_i(p0), the weights w_i = f_i / F at p0, G = sum w_i g_i and L =
// log F:
//   L(p) >= L(p0) + G . d - 1/2 sum w_i most_i |d|^2                           (Jensen)
//   L(p) <= L(p0) + G . d - 1/2 c |d|^2 + log sum w_i exp(x_i + y_i),
//           x_i = (g_i - G) . d, |x_i| <= s_i, 0 <= y_i = 1/2 max(0, -least_i) |d|^2, c the least
//           of max(0, least_i);  since sum w_i x_i = 0 and e^(x+y) - 1 - x grows with |x| and y,
//           the last is at most log(1 + sum w_i (exp(s_i + y_i) - 1 - s_i)): of second order;
//   grad L = sum w_i(p) grad phi_i(p), where the ratio of two terms is exp of a function that bends
//           little; and d . grad phi_i turns by d . H d', H between -most and -least: at least by
//           -(most + least) / 2 (d . d') - (most - least) / 2 |d| |d'|.
#pragma once

#include <span>
#include <vector>

#include "libfield/base/interval.h"
#include "libfield/field/term_bounds.h"

namespace cs2mesh {

/// phi near the centre of a box.
struct Exponent {
  double phi = 0.0;  ///< at the centre
  Vec3d gradient;
  double most = 0.0, least = 0.0;  ///< D^2 phi is between minus the one and minus the other
  double rounding = 0.0;           ///< of phi there

  /// Contains phi over the box.
  Interval range(const BatchBox& box) const;
  /// A lower bound of the derivative of phi along a direction over the box.
  double least_slope(const BatchBox& box, const Vec3d& direction) const;
};

/// Contains log sum exp(phi_i) over the box; of no terms, minus infinity. Some 20 ns a term.
Interval log_range(std::span<const Exponent> terms, const BatchBox& box);

/// A lower bound over the box of the mean of what the slopes are at least, weighted by the terms,
/// which is that of the derivative of log F; infinite for no terms. One slope a term.
double least_mean_slope(std::span<const Exponent> terms, std::span<const double> slopes,
                        const BatchBox& box);

}  // namespace cs2mesh
