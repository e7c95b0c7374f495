// The Cauchy kernel over a circular arc:
//     f(p) = A c int v^-2 dphi,
//     grad f = 2 A c [((rho - c) N0 + c N1) e_rho - c Ns e_phi + z N0 n],
// with v = m cos^2 psi + q sin^2 psi, psi = phi / 2. (Thesis equation 2.22 integrates the angle,
// not the length, and holds below half a turn only; the forms here hold for every sweep.)
//
// Legend: see arc_place.h and arc_powers.h, here with
// m = 1 + s^2 ((rho - c)^2 + z^2), q = 1 + s^2 ((rho + c)^2 + z^2); w = 1 / v. Then
//     int v^-2 dphi = (2 / q) [J1 + (q - m) J2],
//     int v^-3 dphi = (2 / q^2) [J1 + 2 (q - m) J2 + (q - m)^2 J3],
//     N1 = -8 s^2 (K1 + K2),  Ns = 2 s^2 sin(theta / 2) sin(alpha) w1 w2 (w1 + w2).
// Where the arc is small or far Gauss-Legendre with nodes fixed on the arc takes over.
// Value and gradient are within a few ulp of the exact result for inputs moved by a few ulp. Finite
// for every finite p.
#pragma once

#include <array>
#include <cmath>

#include "libfield/base/jet.h"
#include "libfield/integral/arc_powers.h"
#include "libfield/kernel/cauchy.h"

namespace cs2mesh {
namespace detail {

/// w = 1 / v, h = w^2 and K = slope w^3.
template <class T>
struct CauchyArcLaw {
  T s2, slope;

  ArcPair<T> pair(const T& a, const T& b) const {
    const Reciprocals<T> w(T(1) + s2 * a, T(1) + s2 * b);
    return {w.of_a, w.of_b};
  }
  T h(const T& w) const { return w * w; }
  T k(const T& w) const { return w * w * w; }
};

template <class T>
ArcSums<T> cauchy_arc_sums(const ArcPowers<T>& power, const T& s2, const T& gap, const T& turned,
                           const T& w1, const T& w2) {
  const T two_over_q = T(2) * power.iq;
  const T third =
      T(0.5) * two_over_q * two_over_q * (power.j1 + gap * (T(2) * power.j2 + gap * power.j3));
  return {two_over_q * (power.j1 + gap * power.j2), T(-2) * s2 * third,
          T(-8) * s2 * (power.k1 + power.k2), T(2) * s2 * turned * (w1 * w2) * (w1 + w2)};
}

template <class T>
JetOf<T> unit_cauchy_arc(const T& s, const ArcFrame<T>& arc, const Vec3<T>& d) {
  const T s2 = s * s, c = arc.radius;
  const ArcPoint<T> at = arc_point(arc, d);
  const T apart = at.rho - c;
  const T m = T(1) + s2 * (apart * apart + at.z * at.z);
  const T gap = T(4) * s2 * (c * at.rho);  // q - m
  FirstOf<T, JetOf<T>> jets;
  const CauchyArcLaw<T> law{s2, T(-2) * s2};
  if constexpr (kIsDouble<T>) {
    if (take_far_arc(jets, arc, c, at, m, gap, law)) return jets.result();
  }
  std::array<ArcEnd<T>, 2> end = arc_ends(arc, at);
  const T v1 = m + gap * (end[0].sine * end[0].sine);
  const T v2 = m + gap * (end[1].sine * end[1].sine);
  const Reciprocals<T> w(v1, v2);
  end[0].w = w.of_a;
  end[1].w = w.of_b;
  if constexpr (kIsDouble<T>) {
    const auto nodes = [&] { return arc_nodes(arc, c, arc.node14_x, arc.node14_y, at, law); };
    if (jets.take(arc_beside(arc, gap, v1, v2), nodes)) return jets.result();
  }
  return jets.otherwise([&] {
    const ArcPowers<T> power = arc_powers(arc, m, T(m + gap), end, jets.left());
    const T turned = arc.sin_half * at.sin_alpha;
    return arc_jet(arc, c, at, apart, cauchy_arc_sums(power, s2, gap, turned, w.of_a, w.of_b));
  });
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class T>
JetOf<T> integral(const Cauchy& kernel, const ArcFrame<T>& arc, const Vec3<T>& point) {
  const Vec3<T> d = point - arc.center;
  const auto near = squared_norm(d) < T(kFarSquared);
  if (!any(near)) return {};
  const JetOf<T> unit = detail::unit_cauchy_arc(T(kernel.s), arc, d);
  return select(near, T(kernel.amplitude) * unit, JetOf<T>{});
}

template <class T>
JetOf<T> integral(const Cauchy& kernel, const Arc& arc, const Vec3<T>& point) {
  return integral(kernel, ArcFrame<T>(arc), point);
}

}  // namespace cs2mesh
