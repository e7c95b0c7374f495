// The inverse kernel h(r) = A / r (Wyvill and van Overveld 1996; thesis equations 2.9 and 2.10).
// Legend: u = r^2, K = dh/du. It is unbounded at r = 0: closer than `clamp` the value at that
// distance is used and the gradient is 0. With clamp = 0 it is infinite at r = 0.
#pragma once

#include <algorithm>
#include <limits>

#include "libfield/kernel/envelope.h"
#include "libfield/kernel/kind.h"

namespace cs2mesh {

struct Inverse {
  static constexpr KernelKind kKind = KernelKind::inverse;
  double amplitude = 1.0;
  double clamp = 0.0;  ///< length

  /// h as a function of the squared distance.
  template <class T>
  T profile(const T& u) const {
    using std::sqrt;
    const T least = T(clamp) * T(clamp);
    const T v = u < least ? least : u;
    return T(amplitude) / sqrt(v);
  }
  /// dh/du.
  template <class T>
  T slope(const T& u) const {
    using std::sqrt;
    if (u < T(clamp) * T(clamp)) return T(0);
    return -T(amplitude) / (T(2) * u * sqrt(u));
  }
  /// d^2h/du^2.
  template <class T>
  T curvature(const T& u) const {
    using std::sqrt;
    if (u < T(clamp) * T(clamp)) return T(0);
    return T(3) * T(amplitude) / (T(4) * u * u * sqrt(u));
  }
  /// Least upper bound, widened for rounding, of the operator norm of the derivative of that order
  /// (0 to 4) of h over all distances >= r; non-increasing in r. Infinite from
  /// order 2 on for r < clamp, where the gradient jumps; at 0 if clamp is 0.
  double derivative_envelope(int order, double r) const {
    const double d = std::max(r, clamp);
    if (order == 0) return rounded_up(amplitude / d);
    if (order == 1) return rounded_up(amplitude / (d * d));
    if (r < clamp) return std::numeric_limits<double>::infinity();
    // D^k h[e, ..., e] = (-1)^k k! A r^-(k + 1) P_k(c), and the Legendre polynomial is at most 1.
    if (order == 2) return rounded_up(2.0 * amplitude / (d * d * d));
    if (order == 3) return rounded_up(6.0 * amplitude / (d * d * (d * d)));
    return rounded_up(24.0 * amplitude / (d * d * (d * d) * d));
  }
  /// Radius beyond which h is 0.
  double support() const { return std::numeric_limits<double>::infinity(); }
  /// The kernel has no length of its own.
  double length_scale() const { return 0.0; }
};

}  // namespace cs2mesh
