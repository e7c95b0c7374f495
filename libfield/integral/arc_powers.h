// The integrals of powers of 1 / v over a circular arc, v = m cos^2 psi + q sin^2 psi, for the
// kernels that are rational functions of the squared distance.
//
// Legend: psi half the azimuth counted from p, psi1 and psi2 its values at the ends; S, C sine and
// cosine of psi; w = 1 / v; tau = tan psi, V = m + q tau^2, so that v = C^2 V;
//     Jk = int V^-k dtau,  K1 = int tau^2 V^-3 dtau,  K2 = int tau^4 V^-3 dtau,
//     L1 = int tau^2 V^-2 dtau.
// No denominator vanishes for any p with m > 0: neither on the axis (q = m), nor for full circles,
// nor at the antipode (tau/V = S C w and tau/V^2 = S C^3 w^2 are smooth). Two ways to them:
//  - p's nearest point of the circle is on the arc: J1 by one atan2, upward recurrences;
//  - it is off the arc and m is small: tail integrals as over a segment (tau is the abscissa),
//    because atan and its companion cancel; here m may be 0.
// Where p is far from the arc both cancel; see take_far_arc() and arc_beside().
#pragma once

#include <array>

#include "libfield/integral/arc_place.h"
#include "libfield/integral/cauchy_segment.h"

namespace cs2mesh {
namespace detail {

template <class T>
struct ArcPowers {
  T j1{}, j2{}, j3{};  ///< the Jk
  T k1{}, k2{}, l1{};  ///< K1, K2, L1
  T iq{};              ///< 1 / q

  friend ArcPowers select(const MaskOf<T>& mask, const ArcPowers& yes, const ArcPowers& no) {
    return {select(mask, yes.j1, no.j1), select(mask, yes.j2, no.j2), select(mask, yes.j3, no.j3),
            select(mask, yes.k1, no.k1), select(mask, yes.k2, no.k2), select(mask, yes.l1, no.l1),
            select(mask, yes.iq, no.iq)};
  }
};

template <class T>
ArcPowers<T> arc_closed(const ArcFrame<T>& arc, const T& m, const T& q, const ArcEnd<T>& e1,
                        const ArcEnd<T>& e2) {
  using std::sqrt;
  ArcPowers<T> out;
  const T root = sqrt(m * q);
  const auto [im, iq] = Reciprocals<T>(m, q);
  out.iq = iq;
  const T a1 = e1.sine * e1.cosine * e1.w, a2 = e2.sine * e2.cosine * e2.w;
  const T rise1 = a2 - a1;  // of tau / V
  const T rise2 = a2 * (e2.cosine * e2.cosine) * e2.w - a1 * (e1.cosine * e1.cosine) * e1.w;
  out.j1 = vmath::atan2(T(root * arc.sin_half),
                        T(m * (e1.cosine * e2.cosine) + q * (e1.sine * e2.sine))) *
           (root * (im * iq));
  out.j2 = (out.j1 + rise1) * (T(0.5) * im);
  out.j3 = (T(3) * out.j2 + rise2) * (T(0.25) * im);
  out.k1 = (out.j2 - rise2) * (T(0.25) * iq);
  out.l1 = (out.j1 - rise1) * (T(0.5) * iq);
  out.k2 = (T(0.375) * out.j1 - T(0.625) * rise1 + T(0.25) * m * rise2) * (iq * iq);
  return out;
}

/// The foot is off the arc; m C^2 <= kTailReach q S^2 at both ends, the first being the nearer.
template <class T>
ArcPowers<T> arc_tail(const T& m, const T& q, const ArcEnd<T>& near, const ArcEnd<T>& far) {
  ArcPowers<T> out;
  const T iq = T(1) / q;
  out.iq = iq;
  const T cot1 = near.cosine / near.sine, cot2 = far.cosine / far.sine;
  const T y1 = cot1 * cot1, y2 = cot2 * cot2;
  const T ratio = m * iq;
  const T a1 = near.sine * near.cosine * near.w, a2 = far.sine * far.cosine * far.w;
  const T fall1 = a1 - a2;  // of tau / V
  const T fall2 =
      a1 * (near.cosine * near.cosine) * near.w - a2 * (far.cosine * far.cosine) * far.w;
  out.j3 =
      (cauchy_tail(ratio * y1) * (y1 * y1 * cot1) - cauchy_tail(ratio * y2) * (y2 * y2 * cot2)) *
      (iq * iq * iq);
  out.j2 = (fall2 + T(4) * m * out.j3) * T(1.0 / 3.0);
  out.j1 = fall1 + T(2) * m * out.j2;
  out.k1 = (out.j2 - m * out.j3) * iq;
  out.l1 = (fall1 + m * out.j2) * iq;
  out.k2 = (fall1 + m * m * out.j3) * (iq * iq);
  return out;
}

/// Whether p is so far beside a short arc that the powers cancel: the chord form of the rule of
/// poles (see gauss_legendre.h), sqrt(v1) + sqrt(v2) against the sweep, with a margin of 2.5 : 2.2
/// for its distortion.
template <class T>
MaskOf<T> arc_beside(const ArcFrame<T>& arc, const T& gap, const T& v1, const T& v2) {
  const T rest = T(1.5625) * arc.sweep * arc.sweep * gap - (v1 + v2);
  return (arc.sweep < T(1.6)) & ((rest < T(0)) | (rest * rest < T(4) * (v1 * v2)));
}

/// The powers in the lanes given, whose ends hold their w.
template <class T>
ArcPowers<T> arc_powers(const ArcFrame<T>& arc, const T& m, const T& q,
                        const std::array<ArcEnd<T>, 2>& end, const MaskOf<T>& lanes) {
  FirstOf<T, ArcPowers<T>> powers(lanes);
  if constexpr (kIsDouble<T>) {
    const T sine = end[1].sine, cosine = end[1].cosine;
    powers.take((sine < T(0)) & (m * (cosine * cosine) <= T(kTailReach) * (q * (sine * sine))),
                [&] {
                  const ArcEnd<T> near{-end[1].sine, end[1].cosine, end[1].w};
                  const ArcEnd<T> far{-end[0].sine, end[0].cosine, end[0].w};
                  return arc_tail(m, q, near, far);
                });
  }
  return powers.otherwise([&] { return arc_closed(arc, m, q, end[0], end[1]); });
}

}  // namespace detail
}  // namespace cs2mesh
