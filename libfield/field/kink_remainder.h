// What kinks of a kernel add to Taylor's remainder of second order. Along p0 + t d the second
// derivative of an element's field jumps where t |d| = delta or beyond, delta = ||p0 - q| - rho|
// for an element q and a kink at distance rho. So f differs from the quadratic by at most
//     1/2 int jump (r - delta)_+^2 dq
// more, r = |d|; bounded by the mass of the elements in nested shells about the kink's sphere.
#pragma once

#include <algorithm>
#include <cmath>

#include "libfield/kernel/kink.h"
#include "libfield/primitive/primitive.h"

namespace cs2mesh {

/// An upper bound of the measure of the elements whose distance from p is in [lo, hi].
inline double shell_mass(const Point& point, const Vec3d& p, double lo, double hi) {
  const double d = norm(p - point.position);
  return lo <= d && d <= hi ? 1.0 : 0.0;
}

inline double shell_mass(const Segment& segment, const Vec3d& p, double lo, double hi) {
  const Vec3d ab = segment.b - segment.a;
  const double length = norm(ab);
  const Vec3d axis = ab / length;
  const Vec3d d = p - segment.a;
  const double foot = dot(d, axis);
  const double c2 = squared_norm(d - foot * axis);
  if (!(hi > 0) || hi * hi < c2) return 0.0;
  // Elements at |t| from the foot of p, on either side of it, where inner <= |t| <= outer.
  const double outer = std::sqrt(hi * hi - c2);
  const double inner = lo > 0 ? std::sqrt(std::max(0.0, lo * lo - c2)) : 0.0;
  const auto within = [&](double from, double to) {
    return std::max(0.0, std::min(to, length - foot) - std::max(from, -foot));
  };
  return within(-outer, -inner) + within(inner, outer);
}

/// All of it or none.
template <class P>
double shell_mass(const P& primitive, const Vec3d& p, double lo, double hi) {
  const double d = distance(primitive, p);
  return d <= hi && lo <= d + size(primitive) ? measure(primitive) : 0.0;
}

/// The bound above for a kernel with kinks: r up to `radius`, the second derivative at p0 taken as
/// a difference quotient of that step, which a kink within it puts off by sqrt(3) jump.
template <class K, class P>
double kink_remainder(const K& kernel, const P& primitive, const Vec3d& p0, double radius,
                      double step) {
  constexpr int kShells = 4;
  double sum = 0.0;
  for (const Kink& kink : kernel.kinks()) {
    const double slack = 1e-14 * (kink.radius + norm(p0));
    const auto mass_within = [&](double delta) {
      return shell_mass(primitive, p0, kink.radius - delta - slack, kink.radius + delta + slack);
    };
    // From the widest shell inwards; each adds what (1 - delta / r)^2 may be there.
    double weighted = 0.0;
    double mass = mass_within(radius);
    for (int k = kShells - 1; k >= 0 && mass > 0.0; --k) {
      const double fraction = static_cast<double>(k) / kShells;
      const double inner = k > 0 ? mass_within(fraction * radius) : 0.0;
      weighted += std::max(0.0, mass - inner) * (1.0 - fraction) * (1.0 - fraction);
      mass = inner;
    }
    if (weighted > 0.0) weighted += 1.7320508075688774 * mass_within(step);
    sum += 0.5 * kink.jump * radius * radius * weighted;
  }
  return sum * (1.0 + 1e-12);
}

}  // namespace cs2mesh
