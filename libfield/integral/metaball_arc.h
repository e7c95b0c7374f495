// Metaballs over a circular arc, whose cones 1 - r / R make the integral elliptic:
//     f = c int h dphi,   grad f as in arc_place.h.
//
// Legend: see arc_place.h; R the support, x = 1 - m / R^2, gap = 4 c rho / R^2, so that
// v = 1 - u / R^2 = x - gap sin^2(phi / 2); y = r / R.
//
// Within R / 3, h = 1 - 3 y^2 is a trigonometric polynomial of degree 1: fourteen nodes leave an
// error of (e pi / 56)^28 = 2e-23 over as much as a turn. Between R / 3 and R, on either side of
// p's azimuth, h = (3/2) (v / (1 + y))^2 is singular at y = 0 alone, phi = +- i chi with
// sinh^2(chi / 2) = (1 - x) / gap. A side [a, b] is cut at a third. For m >= R^2 / 9, where it
// begins at p's azimuth, u <= R^2 <= 9 m at b leaves sinh(chi / 2) >= sin(b / 2) / sqrt(8), so that
// chi is 0.66 of the first part or more (b = pi), and the rule of poles (see gauss_legendre.h)
// gives rho >= 3.4; for smaller m it begins farther off. Sixteen nodes on either part then have an
// error of 3.4^-32 = 1e-17. A side short against its distance takes fourteen at once.
// All terms of a value are positive: the value is within a few ulp of the exact result for inputs
// moved by a few ulp, the gradient within some dozens (its slope jumps at R / 3). 0 outside the
// support; finite for every finite p.
#pragma once

#include <cmath>
#include <numbers>

#include "libfield/base/jet.h"
#include "libfield/integral/arc_window.h"
#include "libfield/kernel/metaball.h"

namespace cs2mesh {
namespace detail {

/// Within R / 3: h and 2K R^2.
template <class T>
struct MetaballCoreLaw {
  T top, gap;  ///< top = 1 - 3 m / R^2

  ArcFall<T> at(const T& s2) const { return {top - T(3) * gap * s2, T(-6)}; }
};

/// Between R / 3 and R.
template <class T>
struct MetaballRingLaw {
  T x, gap;

  ArcFall<T> at(const T& s2) const {
    using std::max;
    using std::sqrt;
    const T v = max(T(0), T(x - gap * s2));
    const T y = sqrt(T(1) - v);
    const T rest = v / (y * (T(1) + y));  // (1 - y) / y
    const T m = rest * y;
    return {T(1.5) * (m * m), T(-3) * rest};
  }
};

/// |phi| within which the support, or its core, is reached: sin^2(phi / 2) = x / gap.
template <class T>
T metaball_reach(const T& x, const T& gap) {
  using std::max;
  using std::sqrt;
  const T some = max(x, T(0));
  const T reach = T(2) * vmath::atan2(T(sqrt(some)), T(sqrt(max(T(0), T(gap - some)))));
  return select(x > T(0), select(gap <= x, T(std::numbers::pi), reach), T(0));
}

/// The sums over [a, a + span], 0 <= a, all of it between R / 3 and R.
template <class T>
ArcSums<T> metaball_ring(const MetaballRingLaw<T>& law, const T& a, const T& span) {
  using std::max;
  using std::sqrt;
  const auto there = span > T(0);
  if (!any(there)) return {};
  const auto distance = [&](const T& phi) {
    const T s = vmath::sin_cos_pi(T(phi * T(0.5 * std::numbers::inv_pi))).sine;
    return sqrt(max(T(0), T((T(1) - law.x) + law.gap * (s * s))));
  };
  // The chord form of the rule of poles, with a margin of 2.5 : 2.2 for its distortion.
  const T reach = distance(a) + distance(T(a + span));
  const auto far = (span < T(1.6)) & (reach * reach > T(1.5625) * law.gap * (span * span));
  FirstOf<T, ArcSums<T>> sums(there);
  sums.take(far, [&] { return arc_stretch<14>(law, a, span); });
  return sums.otherwise([&] {
    const T third = span * T(1.0 / 3.0);
    ArcSums<T> sum = arc_stretch<16>(law, a, third);
    sum += arc_stretch<16>(law, T(a + third), T(span - third));
    return sum;
  });
}

/// The sums, with K R^2, of the mirror image where alpha < 0; x of the core is over R^2 as well.
template <class T>
ArcSums<T> metaball_arc_sums(const ArcFrame<T>& arc, const ArcPoint<T>& at, const T& x,
                             const T& core_x, const T& gap) {
  using std::abs;
  using std::max;
  using std::min;
  const T pi(std::numbers::pi);
  const T outer = metaball_reach(x, gap), core = min(metaball_reach(core_x, gap), outer);
  const T alpha = vmath::atan2(T(abs(at.sin_alpha)), at.cos_alpha);
  const T half = T(0.5) * arc.sweep;
  // From the antipode -pi on; what an arc of more than half a turn has beyond it is a turn on.
  const T first = max(T(-half - alpha), T(-pi)), last = half - alpha;
  const T behind = last + (T(2) * pi - arc.sweep);
  const auto extent = [](const T& from, const T& to) { return max(T(0), T(to - from)); };
  const T middle_from = max(first, T(-core)), right_from = max(first, core),
          left_from = max(T(-last), core), behind_from = max(behind, core);
  T middle = extent(middle_from, min(last, core)), right = extent(right_from, min(last, outer)),
    left = extent(left_from, min(T(-first), outer)), middle_behind = extent(behind, core),
    right_behind = extent(behind_from, outer);
  // Where the support cuts nothing off the parts add up to the sweep itself.
  const auto whole = (outer >= pi) | both(-half - alpha >= -outer, last <= outer);
  const T total = ((middle + right) + (left + middle_behind)) + right_behind;
  const T scale = select(whole, arc.sweep / max(total, T(1e-300)), T(1));
  middle *= scale, right *= scale, left *= scale, middle_behind *= scale, right_behind *= scale;

  const MetaballCoreLaw<T> core_law{T(1) - T(3) * (T(1) - x), gap};
  const MetaballRingLaw<T> law{x, gap};
  ArcSums<T> sum;
  if (any(middle > T(0))) sum += arc_stretch<14>(core_law, middle_from, middle);
  if (any(middle_behind > T(0))) sum += arc_stretch<14>(core_law, behind, middle_behind);
  sum += metaball_ring(law, right_from, right);
  sum += metaball_ring(law, behind_from, right_behind);
  ArcSums<T> other = metaball_ring(law, left_from, left);
  other.ns = -other.ns;
  return sum += other;
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class T>
requires(kIsDouble<T>) JetOf<T> integral(const Metaball& kernel, const ArcFrame<T>& arc,
                                         const Vec3<T>& point) {
  using std::sqrt;
  const detail::ArcPoint<T> at = detail::arc_point(arc, Vec3<T>(point - arc.center));
  const T radius(kernel.radius), c = arc.radius, core = radius * T(1.0 / 3.0);
  const T apart = at.rho - c;
  const T least = sqrt(apart * apart + at.z * at.z);
  const auto reached = least < radius;
  if (!any(reached)) return {};
  const T per_square = T(1) / (radius * radius);
  const T x = (radius - least) * (radius + least) * per_square;
  const T core_x = (core - least) * (core + least) * per_square;
  const T gap = T(4) * c * at.rho * per_square;
  const detail::ArcSums<T> sum = detail::metaball_arc_sums(arc, at, x, core_x, gap);
  const JetOf<T> jet =
      T(kernel.amplitude) * detail::unmirrored_arc_jet(arc, at, apart, sum, per_square);
  return select(reached, jet, JetOf<T>{});
}
inline Jet integral(const Metaball& kernel, const Arc& arc, const Vec3d& point) {
  return integral(kernel, ArcFrame<double>(arc), point);
}

}  // namespace cs2mesh
