// The quartic kernel (Murakami and Ichihara 1987; thesis section 2.2) of support R: h = A v^2.
// Legend: u = r^2, v = (1 - u / R^2)_+, K = dh/du.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libfield/kernel/envelope.h"
#include "libfield/kernel/kind.h"
#include "libfield/kernel/kink.h"
#include "libfield/simd/lanes.h"

namespace cs2mesh {

struct Quartic {
  static constexpr KernelKind kKind = KernelKind::quartic;
  double radius;  ///< R: h is 0 from there on
  double amplitude = 1.0;

  /// h as a function of the squared distance.
  template <class T>
  T profile(const T& u) const {
    const T v = height(u);
    return T(amplitude) * v * v;
  }
  /// dh/du.
  template <class T>
  T slope(const T& u) const {
    const T v = height(u);
    return T(-2) * T(amplitude) * v / (T(radius) * T(radius));
  }
  /// d^2h/du^2, which jumps at R.
  template <class T>
  T curvature(const T& u) const {
    const T per_square = T(1) / (T(radius) * T(radius));
    const T inside = T(2) * T(amplitude) * (per_square * per_square);
    return select(height(u) > T(0), inside, T(0));
  }
  /// Least upper bound, widened for rounding, of the operator norm of the derivative of that order
  /// (0 to 4) of h over all distances >= r; non-increasing in r. Infinite for
  /// orders 3 and 4 up to the support's edge, where the curvature jumps.
  double derivative_envelope(int order, double r) const {
    if (r > radius) return 0.0;
    if (order > 2) return std::numeric_limits<double>::infinity();
    const double y = r / radius;
    const double v = std::max(0.0, (1.0 - y) * (1.0 + y)) + 8e-16;  // rounding near the edge
    if (order == 0) return rounded_up(amplitude * v * v);
    // |h'| = 4 A y v / R peaks at y = 1 / sqrt(3), where v = 2/3.
    if (order == 1) {
      const double peak = 2.0 / (3.0 * std::sqrt(3.0));
      return rounded_up(4.0 * amplitude / radius * (3.0 * y * y < 1.0 ? peak : y * v));
    }
    // Hessian: -4 A v / R^2 across the ray, A (8 - 12 v) / R^2 along it, greatest at the edge.
    return rounded_up(8.0 * amplitude / (radius * radius));
  }
  /// Where the second derivative jumps.
  std::array<Kink, 1> kinks() const {
    const double unit = amplitude / (radius * radius);
    return {Kink{radius, 8.0 * unit}};
  }
  /// An upper bound of |D^3 h| over all distances >= r but for the kink: 24 A r c / R^4.
  double piece_envelope(double r) const {
    return r > radius ? 0.0 : rounded_up(24.0 * amplitude / (radius * radius * radius));
  }
  /// Radius beyond which h is 0.
  double support() const { return radius; }
  /// Distance over which h changes by its own size near its top.
  double length_scale() const { return radius; }

 private:
  // v as a product: 1 - u / R^2 would keep fewer digits near the edge.
  template <class T>
  T height(const T& u) const {
    using std::sqrt;
    const T r = sqrt(u);
    const T v = (T(radius) - r) * (T(radius) + r) / (T(radius) * T(radius));
    return select(r < T(radius), v, T(0));
  }
};

}  // namespace cs2mesh
