// The Cauchy kernel over a segment:
//     f(p) = A int_t1^t2 v^-2 dt,   grad f = -4 A s^2 (int v^-3 dt) perp + (h(r1) - h(r2)) axis,
// with v = P + s^2 t^2. (McCormack and Sherstyuk 1998; thesis equation 2.21 is the value.)
//
// Legend: t the abscissa along the segment counted from the foot of p on its line, t1 and t2 its
// ends, L its length; c the distance from p to the line, perp the vector from the line to p;
// P = 1 + s^2 c^2; r1, r2 the distances to the ends; w = 1 / v;
// Jk = int v^-k dt.
//
// Where digits would be lost the form changes:
//  - far from a short or wide one the antiderivative cancels: Gauss-Legendre, whose terms are
//    positive, by the rule sqrt(v1) + sqrt(v2) against s L (the sum of the distances to the complex
//    poles, see gauss_legendre.h);
//  - behind an end of a stiff kernel atan and its algebraic companion cancel: tail integrals
//    int_t^inf v^-3 dt = chi(P / (s t)^2) / (s (s t)^5) and upward recurrences of positive terms;
//  - else the closed form with one atan2.
// Value and gradient are within a few ulp of the exact result for inputs moved by a few ulp. Finite
// for every finite p, coordinates of the primitive and widths as frames.h says.
#pragma once

#include <array>
#include <cmath>

#include "libfield/base/jet.h"
#include "libfield/integral/segment_place.h"
#include "libfield/integral/special.h"
#include "libfield/kernel/cauchy.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh {
namespace detail {

/// J1, J2, J3 over a stretch of a line and the drop w1^2 - w2^2 of the profile along it.
template <class T>
struct CauchyLine {
  T j1{}, j2{}, j3{}, drop{};

  /// The Jk alone.
  friend CauchyLine select(const MaskOf<T>& mask, const CauchyLine& yes, const CauchyLine& no) {
    return {
        select(mask, yes.j1, no.j1), select(mask, yes.j2, no.j2), select(mask, yes.j3, no.j3), {}};
  }
};

inline constexpr double kTailReach = 0.49;  ///< greatest P / (s t)^2 of chi's polynomial
inline constexpr std::array<double, 18> kTailPowers = {
#include "libfield/integral/cauchy_tail_table.inc"
};

/// chi(y) = int_0^1 u^4 / (1 + y u^2)^3 du for 0 <= y <= kTailReach.
template <class T>
T cauchy_tail(const T& y) {
  return polynomial(kTailPowers, T(y * T(2.0 / kTailReach) - T(1)));
}

/// 1 / v at the nodes i and i + 1 of Gauss-Legendre over the whole stretch.
template <std::size_t N, class T>
Reciprocals<T> cauchy_line_pair(std::size_t i, const T& s2, const T& t1, const T& length,
                                const T& p) {
  const auto v = [&](std::size_t at) {
    const T t = t1 + length * T(kUnitRule<N>.node[at]);
    return T(p + s2 * (t * t));
  };
  return Reciprocals<T>(v(i), v(i + 1));
}

/// 1 / v at all of them.
template <std::size_t N, class T>
std::array<T, N> cauchy_line_profile(const T& s2, const T& t1, const T& length, const T& p) {
  // A loop of its own: the divisions are independent and overlap.
  std::array<T, N> w;
  for (std::size_t i = 0; i < N; i += 2) {
    const Reciprocals<T> two = cauchy_line_pair<N>(i, s2, t1, length, p);
    w[i] = two.of_a;
    w[i + 1] = two.of_b;
  }
  return w;
}

/// Gauss-Legendre over the whole stretch.
template <std::size_t N, class T>
CauchyLine<T> cauchy_line_nodes(const T& s2, const T& t1, const T& length, const T& p) {
  constexpr const UnitRule<N>& rule = kUnitRule<N>;
  std::array<T, 2> j1{}, j2{}, j3{};
  for (std::size_t i = 0; i < N; i += 2) {
    const Reciprocals<T> two = cauchy_line_pair<N>(i, s2, t1, length, p);
    const std::array<T, 2> w = {two.of_a, two.of_b};
    for (std::size_t chain = 0; chain < 2; ++chain) {
      const T first = T(rule.weight[i + chain]) * w[chain];
      const T second = first * w[chain];
      j1[chain] += first;
      j2[chain] += second;
      j3[chain] += second * w[chain];
    }
  }
  return {length * (j1[0] + j1[1]), length * (j2[0] + j2[1]), length * (j3[0] + j3[1]), {}};
}

/// The closed form: positive terms as long as the foot is on the stretch.
template <class T>
CauchyLine<T> cauchy_line_closed(const T& s, const T& t1, const T& t2, const T& length, const T& p,
                                 const T& w1, const T& w2) {
  using std::sqrt;
  CauchyLine<T> out;
  const T product = s * t1 * (s * t2);
  const T root = s * sqrt(p);
  const auto [inverse_root, inverse_p] = Reciprocals<T>(root, p);
  const T half = T(0.5) * inverse_p;
  out.j1 = vmath::atan2(T(root * length), T(p + product)) * inverse_root;
  out.j2 = (out.j1 + length * (p - product) * (w1 * w2)) * half;
  out.j3 = (T(3) * out.j2 + (t2 * (w2 * w2) - t1 * (w1 * w1))) * (T(0.5) * half);
  return out;
}

/// The foot lies outside, `near` and `far` away from the ends, (s near)^2 >= P / kTailReach.
template <class T>
CauchyLine<T> cauchy_line_tail(const T& s, const T& near, const T& far, const T& p, const T& w_near,
                               const T& w_far) {
  CauchyLine<T> out;
  const T in = T(1) / (s * near);
  const T in2 = in * in;
  const T jn = cauchy_tail(p * in2) * (in2 * in2 * in);
  const T jf_arg = T(1) / (s * far);
  const T if2 = jf_arg * jf_arg;
  const T jf = cauchy_tail(p * if2) * (if2 * if2 * jf_arg);
  const T an = near * w_near;
  const T af = far * w_far;
  out.j3 = (jn - jf) / s;
  out.j2 = ((an * w_near - af * w_far) + T(4) * p * out.j3) * T(1.0 / 3.0);
  out.j1 = (an - af) + T(2) * p * out.j2;
  return out;
}

/// Either of the two, for a stretch long against its distance: in the lanes that are set.
template <class T>
CauchyLine<T> cauchy_line_long(const T& s, const T& t1, const T& t2, const T& length, const T& p,
                               const Reciprocals<T>& w, const MaskOf<T>& lanes) {
  using std::abs;
  using std::max;
  using std::min;
  const auto closed = [&] { return cauchy_line_closed(s, t1, t2, length, p, w.of_a, w.of_b); };
  if constexpr (kIsDouble<T>) {
    const T near = min(abs(t1), abs(t2)), far = max(abs(t1), abs(t2));
    const auto first = t1 > T(0);
    const auto outside = !(first ^ (t2 > T(0)));
    FirstOf<T, CauchyLine<T>> lines(lanes);
    lines.take(outside & (T(kTailReach) * (s * s) * (near * near) >= p), [&] {
      return cauchy_line_tail(s, near, far, p, select(first, w.of_a, w.of_b),
                              select(first, w.of_b, w.of_a));
    });
    return lines.otherwise(closed);
  } else {
    return closed();
  }
}

/// Integrals over t1 <= t <= t2 = t1 + length at squared distance c2 from the line.
template <class T>
CauchyLine<T> cauchy_line(const T& s, const T& t1, const T& t2, const T& length, const T& c2) {
  using std::sqrt;
  const T s2 = s * s;
  const T p = T(1) + s2 * c2;
  const T v1 = p + s2 * (t1 * t1);
  const T v2 = p + s2 * (t2 * t2);
  const Reciprocals<T> w(v1, v2);
  CauchyLine<T> out;
  if constexpr (kIsDouble<T>) {
    // The squared sum of the distances of the ends to the poles.
    const T reach = v1 + v2 + T(2) * sqrt(v1 * v2);
    const T scale = s2 * (length * length);
    FirstOf<T, CauchyLine<T>> lines;
    const bool done = lines.take(reach > T(kReach4 * kReach4) * scale, [&] {
      return cauchy_line_nodes<4>(s2, t1, length, p);
    }) || lines.take(reach > T(kReach8 * kReach8) * scale, [&] {
      return cauchy_line_nodes<8>(s2, t1, length, p);
    }) || lines.take(reach > T(kReach14 * kReach14) * scale, [&] {
      return cauchy_line_nodes<14>(s2, t1, length, p);
    });
    out = done ? lines.result() : lines.otherwise([&] {
      return cauchy_line_long(s, t1, t2, length, p, w, lines.left());
    });
  } else {
    out = cauchy_line_long(s, t1, t2, length, p, w, true);
  }
  out.drop = s2 * (length * (t1 + t2)) * (w.of_a * w.of_b) * (w.of_a + w.of_b);
  return out;
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class T>
JetOf<T> integral(const Cauchy& kernel, const SegmentFrame<T>& segment, const Vec3<T>& point) {
  const SegmentPlace<T> at(segment, point);
  if (!any(at.near)) return {};
  const T s(kernel.s);
  const T amplitude(kernel.amplitude);
  const detail::CauchyLine<T> line = detail::cauchy_line(s, at.t1, at.t2, segment.length, at.c2);
  const JetOf<T> jet{amplitude * line.j2, (T(-4) * amplitude * (s * s) * line.j3) * at.perp +
                                              (amplitude * line.drop) * segment.axis};
  return select(at.near, jet, JetOf<T>{});
}

template <class T>
JetOf<T> integral(const Cauchy& kernel, const Segment& segment, const Vec3<T>& point) {
  return integral(kernel, SegmentFrame<T>(segment), point);
}

}  // namespace cs2mesh
