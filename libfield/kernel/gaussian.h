// The Gaussian kernel h(r) = exp(log A - a^2 r^2) (Blinn 1982). The amplitude lives in the
// exponent, because the A of a stiff material overflows (A = e^1000 for B = -1000) where A times
// the exponential does not. Legend: u = r^2, x = a^2 u, K = dh/du = -a^2 h.
//
// Exponents are cut off at kGreatestExponent so that values, gradients and sums of millions of
// them stay finite; a surface F = T lies far below.
#pragma once

#include <algorithm>
#include <limits>

#include "libfield/kernel/envelope.h"
#include "libfield/kernel/kind.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh {

struct Gaussian {
  static constexpr KernelKind kKind = KernelKind::gaussian;
  static constexpr double kGreatestExponent = 600.0;
  double a;  ///< 1 / length; the a of a^2
  double log_amplitude = 0.0;

  /// h as a function of the squared distance.
  template <class T>
  T profile(const T& u) const {
    const T exponent = T(log_amplitude) - T(a) * T(a) * u;
    return vmath::exp(select(exponent < T(kGreatestExponent), exponent, T(kGreatestExponent)));
  }
  /// dh/du.
  template <class T>
  T slope(const T& u) const {
    return -T(a) * T(a) * profile(u);
  }
  /// d^2h/du^2 = a^4 h.
  template <class T>
  T curvature(const T& u) const {
    return -T(a) * T(a) * slope(u);
  }
  /// Least upper bound, widened for rounding, of the operator norm of the derivative of that order
  /// (0 to 4) of h over all distances >= r; non-increasing in r. Infinite for
  /// orders 3 and 4 where the exponent is cut off somewhere from r on: curvature jumps there.
  double derivative_envelope(int order, double r) const {
    const double x = std::min(a * r * (a * r), 1e15);  // exp(-x) is 0 long before
    if (order == 0) return bounded_exp(x);
    // Where the exponent is cut off, |grad| and the curvature along the ray still grow with x.
    const double cut = log_amplitude - kGreatestExponent;
    // |h'| = 2 a sqrt(x) h peaks at x = 1/2.
    if (order == 1) {
      const double peaked = std::max({x, 0.5, cut});
      return 2.0 * a * std::sqrt(peaked) * bounded_exp(peaked);
    }
    if (order > 2) return higher_envelope(order, x);
    // Hessian: -2 a^2 h across the ray, (4x - 2) a^2 h along it, greatest at x = 3/2.
    const double peaked = std::max({x, 1.5, cut});
    return a * a * std::max(2.0 * bounded_exp(x), (4.0 * peaked - 2.0) * bounded_exp(peaked));
  }
  /// Radius beyond which h is 0.
  double support() const { return std::numeric_limits<double>::infinity(); }
  /// Distance over which h changes by its own size near its top.
  double length_scale() const { return 1.0 / a; }

 private:
  // In units of 1 / a the derivatives of g are h, -h, h. The fourth derivative along a ray is
  // h (16 x^2 - 48 x + 12), the fifth vanishes at 0 and at the roots of 4 x^2 - 20 x + 15.
  double higher_envelope(int order, double x_) const {
    static constexpr double kThirdPeaks[] = {0.275255128608, 2.724744871392};
    static constexpr double kFourthPeaks[] = {0.918861169916, 4.081138830084};
    if (x_ <= log_amplitude - kGreatestExponent) return std::numeric_limits<double>::infinity();
    if (order == 3) {
      return a * a * a * greatest_from(x_, kThirdPeaks, [&](double x) {
               return third_derivative_norm(std::sqrt(x), 1.0, -1.0) * bounded_exp(x);
             });
    }
    return a * a * (a * a) * greatest_from(x_, kFourthPeaks, [&](double x) {
             return fourth_derivative_norm(std::sqrt(x), 1.0, -1.0, 1.0) * bounded_exp(x);
           });
  }
  // exp(log A - x) rounded up: the exponent carries an absolute error of a few ulp of its terms.
  double bounded_exp(double x) const {
    const double slack = 1e-15 * (std::abs(log_amplitude) + x);
    return rounded_up(std::exp(std::min(log_amplitude - x + slack, kGreatestExponent)));
  }
};

}  // namespace cs2mesh
