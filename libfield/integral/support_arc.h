// Soft objects and quartic kernels over a circular arc:
//     f = c int h dphi,   grad f = 2c [((rho - c) N0 + c N1) e_rho - c Ns e_phi + z N0 n],
//     N0 = int K dphi,  N1 = int K (1 - cos phi) dphi,  Ns = int K sin phi dphi,  K = dh/du.
//
// Legend: c radius, theta sweep; rho, alpha, z cylindrical coordinates of p about the arc's axis,
// alpha counted from the middle of the arc; phi the azimuth of the arc's points less alpha; R the
// support, v = 1 - u / R^2 = (x - 4 c rho sin^2(phi / 2)) / R^2 with x = R^2 - (rho - c)^2 - z^2.
//
// Within the support, |phi| <= phi_c with 4 c rho sin^2(phi_c / 2) = x (all around if x is
// greater), h and K are trigonometric polynomials of degree 3: twenty Gauss-Legendre nodes a piece
// leave an error of 1e-20, over as much as a turn. There are two pieces at most, the second where
// an arc of more than half a turn comes near to p with both ends. All terms of a value are
// positive. Value and gradient are within a few ulp of the exact result for inputs moved by a few
// ulp. 0 outside the support; finite for every finite p.
#pragma once

#include <cmath>
#include <numbers>
#include <type_traits>

#include "libfield/base/jet.h"
#include "libfield/integral/cauchy_arc.h"
#include "libfield/integral/support_segment.h"

namespace cs2mesh {
namespace detail {

/// int h, N0 to Ns; K for support 1.
template <class T>
struct SupportArc {
  T value{}, n0{}, n1{}, ns{};
};

/// Adds the integrals over |span| from `from` on; x and gap = 4 c rho in units of R^2.
template <class K, class T>
void add_arc_piece(const K& kernel, const T& x, const T& gap, const T& from, const T& span,
                   SupportArc<T>& sum) {
  constexpr const GaussLegendreRule<20>& rule = kGaussLegendre<20>;
  constexpr double kPerPi = std::numbers::inv_pi;
  const T quarter = T(0.25) * span;  // half the span, and half the angle
  const auto middle = vmath::sin_cos_pi(T((T(0.5) * from + quarter) * T(kPerPi)));
  SupportArc<T> part;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const auto turn = vmath::sin_cos_pi(T(quarter * T(rule.node[i] * kPerPi)));
    const T weight(0.5 * rule.weight[i]);
    for (const double side : {-1.0, 1.0}) {
      const T s = middle.sine * turn.cosine + T(side) * (middle.cosine * turn.sine);
      const T c = middle.cosine * turn.cosine - T(side) * (middle.sine * turn.sine);
      using std::max;
      const SupportLaw<T> at = law(kernel, T(max(T(0), T(x - gap * (s * s)))));
      const T k2 = weight * at.slope;
      part.value += weight * at.h;
      part.n0 += T(0.5) * k2;
      part.n1 += k2 * (s * s);
      part.ns += k2 * (s * c);
    }
  }
  sum.value += span * part.value;
  sum.n0 += span * part.n0;
  sum.n1 += span * part.n1;
  sum.ns += span * part.ns;
}

template <class K, class T>
JetOf<T> support_arc(const K& kernel, const ArcFrame<T>& arc, const Vec3<T>& point) {
  using std::abs;
  using std::max;
  using std::min;
  using std::sqrt;
  const ArcPoint<T> at = arc_point(arc, Vec3<T>(point - arc.center));
  const T radius(kernel.radius), c = arc.radius;
  const T apart = at.rho - c;
  const T least = sqrt(apart * apart + at.z * at.z);
  const auto reached = least < radius;
  if (!any(reached)) return {};
  const T per_square = T(1) / (radius * radius);
  const T x = max(T(0), T((radius - least) * (radius + least) * per_square));
  const T gap = T(4) * c * at.rho * per_square;

  // The pieces, of the mirror image where alpha < 0.
  const auto whole = gap <= x;
  const T reach = T(2) * vmath::atan2(T(sqrt(x)), T(sqrt(max(T(0), T(gap - x)))));
  const T alpha = vmath::atan2(T(abs(at.sin_alpha)), at.cos_alpha);
  const T first = T(-0.5) * arc.sweep - alpha, last = T(0.5) * arc.sweep - alpha;
  const T from = select(whole, first, T(max(first, T(-reach))));
  const auto uncut = whole | both(first >= -reach, last <= reach);
  const T span = select(uncut, arc.sweep, T(max(T(0), T(min(last, reach) - from))));
  // A turn on, counted so that the two pieces of a full circle meet to the last bit.
  const T turn(2.0 * std::numbers::pi);
  const T first_behind = last + (turn - arc.sweep);
  const auto uncut_behind = last <= reach - turn;
  const T rest = max(T(0), T(min(T(last + turn), reach) - first_behind));
  const T behind = select(whole, T(0), select(uncut_behind, arc.sweep, rest));

  SupportArc<T> sum;
  add_arc_piece(kernel, x, gap, from, span, sum);
  if (any(behind > T(0))) add_arc_piece(kernel, x, gap, first_behind, behind, sum);

  const T scale = T(2) * T(kernel.amplitude) * c * per_square;
  const T radial = apart * sum.n0 + c * sum.n1;
  const T around = select(at.sin_alpha < T(0), T(c * sum.ns), T(-(c * sum.ns)));
  const JetOf<T> jet{T(kernel.amplitude) * c * sum.value,
                     (scale * (radial * at.cos_alpha - around * at.sin_alpha)) * arc.ex +
                         (scale * (radial * at.sin_alpha + around * at.cos_alpha)) * arc.ey +
                         (scale * (at.z * sum.n0)) * arc.normal};
  return select(reached, jet, JetOf<T>{});
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class K, class T>
requires(std::is_same_v<K, Soft> ||
         std::is_same_v<K, Quartic>) JetOf<T> integral(const K& kernel, const ArcFrame<T>& arc,
                                                       const Vec3<T>& point) {
  return detail::support_arc(kernel, arc, point);
}
template <class K>
requires(std::is_same_v<K, Soft> || std::is_same_v<K, Quartic>) Jet
    integral(const K& kernel, const Arc& arc, const Vec3d& point) {
  return integral(kernel, ArcFrame<double>(arc), point);
}

}  // namespace cs2mesh
