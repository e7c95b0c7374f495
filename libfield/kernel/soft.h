// The "soft objects" kernel (Wyvill, McPheeters and Wyvill 1986; thesis equation 2.11) of support
// R:
//   h = A (5 v^2 + 4 v^3) / 9 = A (1 - 22 y^2 / 9 + 17 y^4 / 9 - 4 y^6 / 9), y = r / R.
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

struct Soft {
  static constexpr KernelKind kKind = KernelKind::soft;
  double radius;  ///< R: h is 0 from there on
  double amplitude = 1.0;

  /// h as a function of the squared distance.
  template <class T>
  T profile(const T& u) const {
    const T v = height(u);
    return T(amplitude) * v * v * (T(5) + T(4) * v) / T(9);
  }
  /// dh/du.
  template <class T>
  T slope(const T& u) const {
    const T v = height(u);
    return -T(amplitude) * v * (T(10) + T(12) * v) / (T(9) * T(radius) * T(radius));
  }
  /// d^2h/du^2, which jumps at R.
  template <class T>
  T curvature(const T& u) const {
    const T v = height(u);
    const T per_square = T(1) / (T(radius) * T(radius));
    const T inside = T(amplitude) * (T(10) + T(24) * v) * (per_square * per_square) / T(9);
    return select(v > T(0), inside, T(0));
  }
  /// Least upper bound, widened for rounding, of the operator norm of the derivative of that order
  /// (0 to 4) of h over all distances >= r; non-increasing in r. Infinite for
  /// orders 3 and 4 up to the support's edge, where the curvature jumps.
  double derivative_envelope(int order, double r) const {
    if (r > radius) return 0.0;
    if (order > 2) return std::numeric_limits<double>::infinity();
    const double y = r / radius;
    const double v = std::max(0.0, (1.0 - y) * (1.0 + y)) + 8e-16;  // rounding near the edge
    if (order == 0) return rounded_up(amplitude * v * v * (5.0 + 4.0 * v) / 9.0);
    // |h'| = 2 A y v (10 + 12 v) / (9 R) peaks where 120 v^2 - 36 v - 40 = 0.
    if (order == 1) {
      static const double v_peak = (36.0 + std::sqrt(20496.0)) / 240.0;
      const double w = std::min(v, v_peak);
      const double y_peaked = std::max(y, std::sqrt(1.0 - v_peak));
      return rounded_up(2.0 * amplitude * y_peaked * w * (10.0 + 12.0 * w) / (9.0 * radius));
    }
    // Hessian, times 9 R^2 / A: -(20 v + 24 v^2) across the ray, 40 + 36 v - 120 v^2 along it,
    // which is greatest at v = 0.15 and never below -(20 v + 24 v^2).
    const double w = std::min(v, 0.15);
    const double along = 40.0 + 36.0 * w - 120.0 * w * w;
    return rounded_up(amplitude * std::max(v * (20.0 + 24.0 * v), along) / (9.0 * radius * radius));
  }
  /// Where the second derivative jumps.
  std::array<Kink, 1> kinks() const {
    const double unit = amplitude / (radius * radius);
    return {Kink{radius, 40.0 / 9.0 * unit}};
  }
  /// An upper bound of |D^3 h| over all distances >= r but for the kink. With z = y c it is
  /// A / (9 R^3) times 12 z (34 - 24 y^2) - 192 z^3: at most 408 z - 480 z^3 (y = z), whose top is
  /// at z^2 = 17 / 60, and at least 120 z - 192 z^3 >= -72 (y = 1).
  double piece_envelope(double r) const {
    const double top = 272.0 * std::sqrt(17.0 / 60.0);
    return r > radius ? 0.0 : rounded_up(top / 9.0 * amplitude / (radius * radius * radius));
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
