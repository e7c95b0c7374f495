// How much the logarithm of a kernel bends: bounds of the second derivative of psi(p) = log h(|p -
// q|^2) over a range of distances r from the element q.
//
// With k = h' / h (by u = r^2), D^2 psi has the eigenvalues 2 k across the ray and 2 k + 4 u k'
// along it, k' = h'' / h - k^2, and |grad psi| = 2 r |k|. By kernel, in between the places that are
// named:
//  - Cauchy, x = s^2 u: -4 s^2 / (1 + x) across, which grows, and -4 s^2 (1 - x) / (1 + x)^2 along,
//    which has its top s^2 / 2 at x = 3; the slope 4 s sqrt(x) / (1 + x) has its top 2 s at x = 1.
//  - Gaussian: -2 a^2 both; slope 2 a^2 r.
//  - A / r^n: -n / r^2 across, n / r^2 along, slope n / r: beyond the clamp.
//  - Soft, quartic: log of a product of concave functions of r: both fall, and the slope grows.
//  - Metaball: as they do up to R / 3, where the eigenvalue along the ray jumps up; beyond, it
//  falls
//    again, the slope grows, and that across has its top at R / 2.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "libfield/kernel/kernel.h"

namespace cs2mesh {

/// Whether log h is concave.
template <class K>
inline constexpr bool kLogConcave =
    !std::is_same_v<K, Cauchy> && !std::is_same_v<K, Inverse> && !std::is_same_v<K, Squared>;

/// D^2 psi lies between minus `most` and minus `least`; |grad psi| <= steepest.
struct LogBends {
  double most = 0.0, least = 0.0, steepest = 0.0;

  /// At squared distance u, with k and k' there.
  void include(double u, double k, double turn) {
    const double across = -2 * k, along = across - 4 * u * turn;
    most = std::max({most, across, along});
    least = std::min({least, across, along});
    steepest = std::max(steepest, 2 * std::sqrt(u) * std::abs(k));
  }
};

/// For near <= r <= far, 0 <= near, far < support(), and near > clamp for inverse kernels; widened
/// for rounding. Some 5 to 20 ns.
template <class K>
LogBends log_bends(const K& kernel, double near, double far) {
  LogBends bends{0.0, std::numeric_limits<double>::infinity(), 0.0};
  constexpr double kSlack = 1e-9;
  if constexpr (std::is_same_v<K, Cauchy>) {
    const double s2 = kernel.s * kernel.s, low = s2 * near * near, high = s2 * far * far;
    const double top = std::clamp(3.0, low, high), steepest = std::clamp(1.0, low, high);
    bends.most = 4 * s2 / (1 + low);
    bends.least = 4 * s2 * (1 - top) / ((1 + top) * (1 + top));
    bends.steepest = 4 * kernel.s * std::sqrt(steepest) / (1 + steepest) * (1 + kSlack);
    bends.most *= 1 + kSlack;
    bends.least -= kSlack * bends.most;
    return bends;
  }
  const auto at = [&](double r) {
    if constexpr (std::is_same_v<K, Gaussian>) {
      bends.include(r * r, -kernel.a * kernel.a, 0.0);
    } else if constexpr (std::is_same_v<K, Inverse> || std::is_same_v<K, Squared>) {
      const double half = std::is_same_v<K, Inverse> ? 0.5 : 1.0;
      bends.include(r * r, -half / (r * r), half / (r * r * (r * r)));
    } else {
      const double h = kernel.profile(r * r);
      const double k = kernel.slope(r * r) / h;
      bends.include(r * r, k, kernel.curvature(r * r) / h - k * k);
    }
  };
  const auto at_if_within = [&](double r) {
    if (near < r && r < far) at(r);
  };
  at(near);
  at(far);
  if constexpr (std::is_same_v<K, Metaball>) {
    // Both sides of the jump.
    at_if_within(kernel.radius / 3 * (1 - 1e-12));
    at_if_within(kernel.radius / 3 * (1 + 1e-12));
    at_if_within(kernel.radius / 2);
  }
  const double slack = kSlack * std::max(bends.most, std::abs(bends.least));
  return {bends.most + slack, bends.least - slack, bends.steepest * (1 + kSlack)};
}

}  // namespace cs2mesh
