// The Cauchy kernel h(r) = A (1 + s^2 r^2)^-2 (McCormack and Sherstyuk 1998; thesis equation 2.7).
// Legend: u = r^2, x = s^2 u, q = 1 + x, K = dh/du = -2 A s^2 q^-3. Finite for every finite u >= 0.
#pragma once

#include <algorithm>
#include <limits>

#include "libfield/kernel/envelope.h"
#include "libfield/kernel/kind.h"

namespace cs2mesh {

struct Cauchy {
  static constexpr KernelKind kKind = KernelKind::cauchy;
  double s;  ///< 1 / length
  double amplitude = 1.0;

  /// h as a function of the squared distance.
  template <class T>
  T profile(const T& u) const {
    const T w = T(1) / (T(1) + T(s) * T(s) * u);
    return T(amplitude) * w * w;
  }
  /// dh/du.
  template <class T>
  T slope(const T& u) const {
    const T w = T(1) / (T(1) + T(s) * T(s) * u);
    return T(-2) * T(amplitude) * T(s) * T(s) * w * w * w;
  }
  /// d^2h/du^2 = 6 A s^4 q^-4.
  template <class T>
  T curvature(const T& u) const {
    const T w = T(1) / (T(1) + T(s) * T(s) * u);
    const T w2 = T(s) * T(s) * w * w;
    return T(6) * T(amplitude) * w2 * w2;
  }
  /// Least upper bound, widened for rounding, of the operator norm of the derivative of that order
  /// (0 to 4) of h over all distances >= r; non-increasing in r.
  double derivative_envelope(int order, double r) const {
    const double x = std::min(s * r * (s * r), 1e60);  // powers of it stay finite
    if (order == 0) return rounded_up(amplitude / ((1.0 + x) * (1.0 + x)));
    // |h'| = 4 A s sqrt(x) q^-3 peaks at x = 1/5.
    if (order == 1) {
      const double peaked = std::max(x, 0.2);
      const double q = 1.0 + peaked;
      return rounded_up(4.0 * amplitude * s * std::sqrt(peaked) / (q * q * q));
    }
    if (order > 2) return amplitude * higher_envelope(order, x);
    // Hessian: -4 A s^2 q^-3 across the ray, 4 A s^2 (5x - 1) q^-4 along it, greatest at x = 3/5.
    const double q = 1.0 + x;
    const double peaked = std::max(x, 0.6);
    const double qp = 1.0 + peaked;
    const double along = (5.0 * peaked - 1.0) / (qp * qp * (qp * qp));
    return rounded_up(4.0 * amplitude * s * s * std::max(1.0 / (q * q * q), along));
  }
  /// Radius beyond which h is 0.
  double support() const { return std::numeric_limits<double>::infinity(); }
  /// Distance over which h changes by its own size near its top.
  double length_scale() const { return 1.0 / s; }

 private:
  // For A = 1. In units of 1 / s the derivatives of g are 6 q^-4, -24 q^-5, 120 q^-6. The fourth
  // derivative along a ray vanishes at the roots of 35 x^2 - 42 x + 3, the fifth at 0 and at those
  // of 7 x^2 - 14 x + 3.
  double higher_envelope(int order, double x_) const {
    static constexpr double kThirdPeaks[] = {0.076277021654, 1.123722978346};
    static constexpr double kFourthPeaks[] = {0.244071053982, 1.755928946018};
    const auto square = [](double v) { return v * v; };
    if (order == 3) {
      return rounded_up(s * s * s * greatest_from(x_, kThirdPeaks, [&](double x) {
                          const double w = 1.0 / (1.0 + x);
                          const double g2 = 6.0 * square(w * w);
                          return third_derivative_norm(std::sqrt(x), g2, -4.0 * w * g2);
                        }));
    }
    return rounded_up(s * s * (s * s) * greatest_from(x_, kFourthPeaks, [&](double x) {
                        const double w = 1.0 / (1.0 + x);
                        const double g2 = 6.0 * square(w * w);
                        return fourth_derivative_norm(std::sqrt(x), g2, -4.0 * w * g2,
                                                      20.0 * w * w * g2);
                      }));
  }
};

}  // namespace cs2mesh
