// Which way the elements of a primitive pull: of the integral, d . grad I(p) = int k(|p - s|^2) a
// ds, with k = -2 dh/du and a = d . (s - p), how far along d the element s lies. Over a range of
// distances k / h has bounds, so over a box d . grad I >= (least a) (least or greatest k / h) I: a
// rate times the value.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "libfield/field/box_view.h"
#include "libfield/field/part_in_sight.h"

namespace cs2mesh {

/// k / h = -2 h' / h at a squared distance, where h > 0.
template <class K>
double steepness(const K& kernel, double u) {
  const double h = kernel.profile(u);
  return h > 0 ? -2 * kernel.slope(u) / h : std::numeric_limits<double>::infinity();
}

/// Contains k / h over a range of squared distances. The ratio is monotone for all kernels but the
/// metaball, which is least steep in its outer part at R / 2.
template <class K>
Interval steepness(const K& kernel, double near, double far) {
  const double at_near = steepness(kernel, near), at_far = steepness(kernel, far);
  Interval range(std::min(at_near, at_far), std::max(at_near, at_far));
  if constexpr (std::is_same_v<K, Metaball>) {
    const double turn = 0.25 * kernel.radius * kernel.radius;
    if (near < turn && turn < far) range.lo = std::min(range.lo, steepness(kernel, turn));
  }
  return range;
}

/// What can be said of d . grad I by the places of the elements: at least `rate` I - lost, and
/// `slope`.
struct Pull {
  double rate = -std::numeric_limits<double>::infinity();
  double lost = 0.0;
  double slope = -std::numeric_limits<double>::infinity();
};

/// A distance from which on all elements of that mass together are 0 or, of the Gaussian, no more
/// than a little.
template <class K>
double sight(const K& kernel, double /*mass*/) {
  return kernel.support();
}
inline double sight(const Gaussian& kernel, double mass) {
  constexpr double kLittle = 1e-4;  // T
  const double exponent = kernel.log_amplitude + std::log(mass / kLittle);
  return std::sqrt(std::max(0.0, exponent)) / kernel.a;
}

/// By the elements in sight of the box alone, which lie ahead; nothing if they do not.
template <class K, class P>
std::optional<Pull> pull_in_sight(const K& kernel, const P& primitive, const LocalBox& local,
                                  const Vec3d& direction, double slack, double steepest) {
  const double mass = mass_bound(primitive), far = sight(kernel, mass);
  if (!std::isfinite(far)) return std::nullopt;
  const double ahead =
      least_ahead(primitive, local.center, direction, (far + local.radius) * (1 + 1e-12)) - slack;
  if (!(ahead > 0)) return std::nullopt;
  Pull own{ahead * steepest * (1 - 1e-12), 0.0, 0.0};
  if (std::isfinite(kernel.support())) return own;
  const double beyond = norm(direction) * mass * kernel.derivative_envelope(1, far);
  own.lost = (own.rate * mass * kernel.derivative_envelope(0, far) + beyond) * (1 + 1e-12);
  own.slope = -beyond * (1 + 1e-12);
  return own;
}

/// `direction` in local coordinates.
template <class K, class P>
Pull pull(const Term& term, const K& kernel, const P& primitive, const LocalBox& local,
          const Vec3d& direction, const Reach& reach) {
  if constexpr (std::is_same_v<P, Plane> || std::is_same_v<P, TaperedSegment>) {
    return {};
  } else {
    if constexpr (std::is_same_v<K, Inverse> || std::is_same_v<K, Squared>) {
      if (!(reach.near > kernel.clamp)) return {};
    }
    const double slack =
        extent_along(term, direction, local.half) + 1e-12 * norm(direction) * reach.scale;
    // How far ahead all elements are at least: min over s of d . (s - p).
    const double ahead = separation(primitive, local.center, -1.0 * direction) - slack;
    const double near = reach.near * reach.near, far = reach.far * reach.far;
    const Interval ratio = steepness(kernel, near, far);
    if (ahead > 0) return {ahead * ratio.lo * (1 - 1e-12), 0.0, 0.0};
    if (const auto own = pull_in_sight(kernel, primitive, local, direction, slack, ratio.lo)) {
      return *own;
    }
    return {ahead * ratio.hi * (1 + 1e-12), 0.0,
            2 * ahead * mass_bound(primitive) * -kernel.slope(near) * (1 + 1e-12)};
  }
}

}  // namespace cs2mesh
