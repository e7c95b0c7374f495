// The metaballs kernel (Nishimura et al. 1985; thesis equation 2.8) of support R, y = r / R:
//   h = A [(3/2) (1 - y)_+^2 - (1/2) (1 - 3y)_+^2] = A (1 - 3 y^2) for y <= 1/3.
// Legend: u = r^2, K = dh/du = -3 A / R^2 for y <= 1/3, else -(3/2) A (1/y - 1) / R^2.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "libfield/kernel/envelope.h"
#include "libfield/kernel/kind.h"
#include "libfield/kernel/kink.h"
#include "libfield/simd/lanes.h"

namespace cs2mesh {

struct Metaball {
  static constexpr KernelKind kKind = KernelKind::metaball;
  double radius;  ///< R: h is 0 from there on
  double amplitude = 1.0;

  /// h as a function of the squared distance.
  template <class T>
  T profile(const T& u) const {
    using std::sqrt;
    const T y = sqrt(u) / T(radius);
    const T inner = T(amplitude) * (T(1) - T(3) * y * y);
    const T outer = T(amplitude) * T(1.5) * (T(1) - y) * (T(1) - y);
    return select(T(3) * y <= T(1), inner, select(y < T(1), outer, T(0)));
  }
  /// dh/du.
  template <class T>
  T slope(const T& u) const {
    using std::sqrt;
    const T y = sqrt(u) / T(radius);
    const T scale = T(amplitude) / (T(radius) * T(radius));
    const auto inner = T(3) * y <= T(1);  // where y may be 0
    const T outer = T(-1.5) * scale * (T(1) - y) / select(inner, T(1), y);
    return select(inner, T(T(-3) * scale), select(y < T(1), outer, T(0)));
  }
  /// d^2h/du^2 = (3/4) A / (R^4 y^3) for 1/3 < y < 1, else 0: it jumps at both radii.
  template <class T>
  T curvature(const T& u) const {
    using std::sqrt;
    const T y = sqrt(u) / T(radius);
    const T per_square = T(1) / (T(radius) * T(radius));
    const auto inner = T(3) * y <= T(1);  // where y may be 0
    const T away = select(inner, T(1), y);
    const T outer = T(0.75) * T(amplitude) * per_square * per_square / (away * away * away);
    return select(inner, T(0), select(y < T(1), outer, T(0)));
  }
  /// Least upper bound, widened for rounding, of the operator norm of the derivative of that order
  /// (0 to 4) of h over all distances >= r; non-increasing in r. Infinite for
  /// orders 3 and 4 up to the support's edge, where the curvature jumps.
  double derivative_envelope(int order, double r) const {
    if (r > radius) return 0.0;
    if (order > 2) return std::numeric_limits<double>::infinity();
    const double y = std::max(r / radius, 1.0 / 3.0);
    const double rest = std::max(0.0, 1.0 - y) + 4e-16;  // rounding near the edge, where h is tiny
    if (order == 0 && 3.0 * r < radius) return rounded_up(profile(r * r));
    if (order == 0) return rounded_up(1.5 * amplitude * rest * rest);
    if (order == 1) return rounded_up(3.0 * amplitude * rest / radius);
    // Hessian: 3 A (1/y - 1) / R^2 across the ray, 3 A / R^2 along it, -6 A / R^2 within R / 3.
    return rounded_up(3.0 * amplitude * std::max(1.0, rest / y) / (radius * radius));
  }
  /// Where the second derivative jumps.
  std::array<Kink, 2> kinks() const {
    const double unit = amplitude / (radius * radius);
    return {Kink{radius / 3.0, 9.0 * unit}, Kink{radius, 3.0 * unit}};
  }
  /// An upper bound of |D^3 h| over all distances >= r but for the kinks: 9 A c (1 - c^2) / (R r^2)
  /// beyond R / 3, where h is a quadratic but for 3 A r / R; greatest at c^2 = 1 / 3.
  double piece_envelope(double r) const {
    const double d = std::max(r, radius / 3.0);
    return r > radius ? 0.0 : rounded_up(2.0 * std::sqrt(3.0) * amplitude / (radius * d * d));
  }
  /// Radius beyond which h is 0.
  double support() const { return radius; }
  /// Distance over which h changes by its own size near its top.
  double length_scale() const { return radius; }
};

}  // namespace cs2mesh
