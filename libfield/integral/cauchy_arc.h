// The Cauchy kernel over a circular arc:
//     f(p) = A c int v^-2 dphi,
//     grad f = 2 A c [((rho - c) N0 + c N1) e_rho - c Ns e_phi + z N0 n],
//     N0 = int K dphi, N1 = int K (1 - cos phi) dphi, Ns = int K sin phi dphi, K = -2 s^2 v^-3,
// with v = m cos^2 psi + q sin^2 psi, psi = phi / 2. (Thesis equation 2.22 integrates the angle,
// not the length, and holds below half a turn only; the forms here hold for every sweep.)
//
// Legend: c radius, theta sweep; rho, alpha, z cylindrical coordinates of p about the arc's axis,
// alpha counted from the middle of the arc; e_rho, e_phi, n their unit vectors; phi the azimuth of
// the arc's points less alpha, psi1 and psi2 half of its ends; S, C sine and cosine of psi;
// m = 1 + s^2 ((rho - c)^2 + z^2), q = 1 + s^2 ((rho + c)^2 + z^2); w = 1 / v.
//
// With tau = tan psi and V = m + q tau^2 everything follows from Jk = int V^-k dtau:
//     int v^-2 dphi = (2 / q) [J1 + (q - m) J2],
//     int v^-3 dphi = (2 / q^2) [J1 + 2 (q - m) J2 + (q - m)^2 J3],
//     N1 = -8 s^2 (K1 + K2), K1 = int tau^2 V^-3 dtau, K2 = int tau^4 V^-3 dtau,
//     Ns = 2 s^2 sin(theta / 2) sin(alpha) w1 w2 (w1 + w2),
// where no denominator vanishes for any p: neither on the axis (rho = 0), nor for full circles, nor
// at the antipode (tau/V = S C w and tau/V^2 = S C^3 w^2 are smooth). Three ways to the Jk:
//  - p's nearest point of the circle is on the arc: J1 by one atan2, upward recurrences;
//  - it is off the arc and the kernel is stiff: tail integrals as over a segment (tau is the
//    abscissa), because atan and its companion cancel;
//  - the arc is small or far (the sum of the distances to the complex poles, see
//    gauss_legendre.h, against the sweep): Gauss-Legendre with nodes fixed on the arc.
// Value and gradient are within a few ulp of the exact result for inputs moved by a few ulp. Finite
// for every finite p.
#pragma once

#include <array>
#include <cmath>

#include "libfield/base/jet.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/frames.h"
#include "libfield/kernel/cauchy.h"

namespace cs2mesh {
namespace detail {

/// p in the cylindrical coordinates of an arc.
template <class T>
struct ArcPoint {
  T x, y, z, rho;
  T cos_alpha, sin_alpha;
};

/// Sine, cosine of half the angle to an end of the arc, and 1 / v there.
template <class T>
struct ArcEnd {
  T sine, cosine, w;
};

template <class T>
struct ArcPowers {
  T j1{}, j2{}, j3{};  ///< the Jk
  T k1{}, k2{};        ///< K1, K2
  T iq{};              ///< 1 / q

  friend ArcPowers select(const MaskOf<T>& mask, const ArcPowers& yes, const ArcPowers& no) {
    return {select(mask, yes.j1, no.j1), select(mask, yes.j2, no.j2), select(mask, yes.j3, no.j3),
            select(mask, yes.k1, no.k1), select(mask, yes.k2, no.k2), select(mask, yes.iq, no.iq)};
  }
};

template <class T>
ArcPoint<T> arc_point(const ArcFrame<T>& arc, const Vec3<T>& d) {
  using std::sqrt;
  ArcPoint<T> at{dot(d, arc.ex), dot(d, arc.ey), dot(d, arc.normal), {}, {}, {}};
  at.rho = sqrt(at.x * at.x + at.y * at.y);
  // On the axis any azimuth will do.
  const auto off_axis = at.rho > T(0);
  const T inverse = T(1) / select(off_axis, at.rho, T(1));
  at.cos_alpha = select(off_axis, T(at.x * inverse), T(1));
  at.sin_alpha = select(off_axis, T(at.y * inverse), T(0));
  return at;
}

/// The ends phi = -theta/2 - |alpha| and theta/2 - |alpha|: the mirror image of p about e_x if
/// alpha < 0.
template <class T>
std::array<ArcEnd<T>, 2> arc_ends(const ArcFrame<T>& arc, const ArcPoint<T>& at) {
  using std::abs;
  using std::sqrt;
  const T half_sine = T(0.5) * abs(at.sin_alpha);
  const T greater = sqrt(T(0.5) + T(0.5) * abs(at.cos_alpha));
  const T lesser = half_sine / greater;
  const auto front = at.cos_alpha >= T(0);
  const T ca = select(front, greater, lesser), sa = select(front, lesser, greater);
  const T ss = arc.sin_quarter * sa, sc = arc.sin_quarter * ca;
  const T cs = arc.cos_quarter * sa, cc = arc.cos_quarter * ca;
  return {ArcEnd<T>{-(sc + cs), cc - ss, {}}, ArcEnd<T>{sc - cs, cc + ss, {}}};
}

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
  out.k2 = (fall1 + m * m * out.j3) * (iq * iq);
  return out;
}

/// Gauss-Legendre over the whole arc; `x`, `y` as in ArcFrame, N nodes and their mirror images.
template <std::size_t N, class T>
JetOf<T> arc_nodes(const ArcFrame<T>& arc, const std::array<double, N>& x,
                   const std::array<double, N>& y, const ArcPoint<T>& at, const T& s2) {
  constexpr const GaussLegendreRule<2 * N>& rule = kGaussLegendre<2 * N>;
  const T across = T(1) + s2 * (at.z * at.z);
  std::array<T, N> lower, upper;
  for (std::size_t i = 0; i < N; ++i) {
    const T dx = at.x - arc.radius * T(x[i]);
    const T up = at.y - arc.radius * T(y[i]);
    const T down = at.y + arc.radius * T(y[i]);
    const Reciprocals<T> w(across + s2 * (dx * dx + up * up),
                           across + s2 * (dx * dx + down * down));
    upper[i] = w.of_a;
    lower[i] = w.of_b;
  }
  T second(0), third(0), third_x(0), third_y(0);
  for (std::size_t i = 0; i < N; ++i) {
    const T weight(rule.weight[i]);
    const T u2 = upper[i] * upper[i], l2 = lower[i] * lower[i];
    const T u3 = u2 * upper[i], l3 = l2 * lower[i];
    second += weight * (u2 + l2);
    third += weight * (u3 + l3);
    third_x += weight * ((u3 + l3) * (at.x - arc.radius * T(x[i])));
    third_y += weight * ((u3 + l3) * at.y - (u3 - l3) * (arc.radius * T(y[i])));
  }
  const T half_length = T(0.5) * arc.radius * arc.sweep;
  const T slope = T(-4) * s2 * half_length;
  return {half_length * second,
          slope * (third_x * arc.ex + third_y * arc.ey + (third * at.z) * arc.normal)};
}

/// Value and gradient of the unit kernel from the Jk.
template <class T>
JetOf<T> arc_jet(const ArcFrame<T>& arc, const ArcPoint<T>& at, const ArcPowers<T>& power,
                 const T& s2, const T& gap, const T& w1, const T& w2) {
  const T c = arc.radius;
  const T two_over_q = T(2) * power.iq;
  const T second = two_over_q * (power.j1 + gap * power.j2);
  const T third =
      T(0.5) * two_over_q * two_over_q * (power.j1 + gap * (T(2) * power.j2 + gap * power.j3));
  const T n0 = T(-2) * s2 * third;
  const T n1 = T(-8) * s2 * (power.k1 + power.k2);
  const T ns = T(2) * s2 * (arc.sin_half * at.sin_alpha) * (w1 * w2) * (w1 + w2);
  const T radial = (at.rho - c) * n0 + c * n1;
  const T around = -c * ns;
  const T gx = radial * at.cos_alpha - around * at.sin_alpha;
  const T gy = radial * at.sin_alpha + around * at.cos_alpha;
  const T twice = T(2) * c;
  return {c * second,
          (twice * gx) * arc.ex + (twice * gy) * arc.ey + (twice * (at.z * n0)) * arc.normal};
}

/// The greatest sweep over which 8 nodes integrate the sine and cosine of the azimuth, which the
/// gradient brings, to 3e-18; 14 nodes do so over a turn.
inline constexpr double kSweep8 = 2.0;

template <class T>
JetOf<T> unit_cauchy_arc(const T& s, const ArcFrame<T>& arc, const Vec3<T>& d) {
  using std::sqrt;
  const T s2 = s * s;
  const ArcPoint<T> at = arc_point(arc, d);
  const T apart = at.rho - arc.radius;
  const T m = T(1) + s2 * (apart * apart + at.z * at.z);
  const T gap = T(4) * s2 * (arc.radius * at.rho);  // q - m
  const T q = m + gap;
  FirstOf<T, JetOf<T>> jets;
  if constexpr (kIsDouble<T>) {
    const bool done = jets.take((arc.sweep < T(kSweep8)) & (m > arc.far8 * gap),
                                [&] { return arc_nodes(arc, arc.node8_x, arc.node8_y, at, s2); }) ||
                      jets.take(m > arc.far14 * gap,
                                [&] { return arc_nodes(arc, arc.node14_x, arc.node14_y, at, s2); });
    if (done) return jets.result();
  }
  std::array<ArcEnd<T>, 2> end = arc_ends(arc, at);
  const T v1 = m + gap * (end[0].sine * end[0].sine);
  const T v2 = m + gap * (end[1].sine * end[1].sine);
  const Reciprocals<T> w(v1, v2);
  end[0].w = w.of_a;
  end[1].w = w.of_b;
  MaskOf<T> behind(false);
  if constexpr (kIsDouble<T>) {
    // The chord form of the pole rule, with a margin of 2.5 : 2.2 for its distortion.
    const T rest = T(1.5625) * arc.sweep * arc.sweep * gap - (v1 + v2);
    const auto far = (rest < T(0)) | (rest * rest < T(4) * (v1 * v2));
    const bool done = jets.take((arc.sweep < T(1.6)) & far,
                                [&] { return arc_nodes(arc, arc.node14_x, arc.node14_y, at, s2); });
    if (done) return jets.result();
    const T sine = end[1].sine, cosine = end[1].cosine;
    behind = (sine < T(0)) & (m * (cosine * cosine) <= T(kTailReach) * (q * (sine * sine)));
  }
  return jets.otherwise([&] {
    FirstOf<T, ArcPowers<T>> powers(jets.left());
    if constexpr (kIsDouble<T>) {
      powers.take(behind, [&] {
        const ArcEnd<T> near{-end[1].sine, end[1].cosine, end[1].w};
        const ArcEnd<T> far{-end[0].sine, end[0].cosine, end[0].w};
        return arc_tail(m, q, near, far);
      });
    }
    const ArcPowers<T> all =
        powers.otherwise([&] { return arc_closed(arc, m, q, end[0], end[1]); });
    return arc_jet(arc, at, all, s2, gap, end[0].w, end[1].w);
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
