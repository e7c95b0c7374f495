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
#include "libfield/integral/frames.h"
#include "libfield/integral/special.h"
#include "libfield/kernel/cauchy.h"

namespace cs2mesh {
namespace detail {

/// J1, J2, J3 over a stretch of a line and the drop w1^2 - w2^2 of the profile along it.
template <class T>
struct CauchyLine {
  T j1{}, j2{}, j3{}, drop{};
};

inline constexpr double kTailReach = 0.49;  ///< greatest P / (s t)^2 of chi's polynomial
inline constexpr std::array<double, 18> kTailPowers = {
#include "libfield/integral/cauchy_tail_table.inc"
};

/// chi(y) = int_0^1 u^4 / (1 + y u^2)^3 du for 0 <= y <= kTailReach.
inline double cauchy_tail(double y) {
  return polynomial(kTailPowers, y * (2.0 / kTailReach) - 1.0);
}

template <int N>
void add_cauchy_nodes(double s2, double t1, double length, double p, CauchyLine<double>& sums) {
  constexpr const UnitRule<N>& rule = kUnitRule<N>;
  // Separate loops: the divisions are independent and run two or more at a time.
  std::array<double, N> w;
  for (std::size_t i = 0; i < N; ++i) {
    const double t = t1 + length * rule.node[i];
    w[i] = 1.0 / (p + s2 * (t * t));
  }
  std::array<double, 2> j1{}, j2{}, j3{};
  for (std::size_t i = 0; i < N; i += 2) {
    for (std::size_t lane = 0; lane < 2; ++lane) {
      const double first = rule.weight[i + lane] * w[i + lane];
      const double second = first * w[i + lane];
      j1[lane] += first;
      j2[lane] += second;
      j3[lane] += second * w[i + lane];
    }
  }
  sums.j1 = length * (j1[0] + j1[1]);
  sums.j2 = length * (j2[0] + j2[1]);
  sums.j3 = length * (j3[0] + j3[1]);
}

/// The closed form: positive terms as long as the foot is on the stretch.
template <class T>
void cauchy_line_closed(const T& s, const T& t1, const T& t2, const T& length, const T& p,
                        const T& w1, const T& w2, CauchyLine<T>& out) {
  using std::atan2;
  using std::sqrt;
  const T product = s * t1 * (s * t2);
  const T root = s * sqrt(p);
  const T half = T(0.5) / p;
  out.j1 = atan2(T(root * length), T(p + product)) / root;
  out.j2 = (out.j1 + length * (p - product) * (w1 * w2)) * half;
  out.j3 = (T(3) * out.j2 + (t2 * (w2 * w2) - t1 * (w1 * w1))) * (T(0.5) * half);
}

/// The foot lies outside, `near` and `far` away from the ends, (s near)^2 >= P / kTailReach.
inline void cauchy_line_tail(double s, double near, double far, double p, double w_near,
                             double w_far, CauchyLine<double>& out) {
  const double in = 1.0 / (s * near);
  const double in2 = in * in;
  const double jn = cauchy_tail(p * in2) * (in2 * in2 * in);
  const double jf_arg = 1.0 / (s * far);
  const double if2 = jf_arg * jf_arg;
  const double jf = cauchy_tail(p * if2) * (if2 * if2 * jf_arg);
  const double an = near * w_near;
  const double af = far * w_far;
  out.j3 = (jn - jf) / s;
  out.j2 = ((an * w_near - af * w_far) + 4.0 * p * out.j3) * (1.0 / 3.0);
  out.j1 = (an - af) + 2.0 * p * out.j2;
}

/// Integrals over t1 <= t <= t2 = t1 + length at squared distance c2 from the line.
template <class T>
CauchyLine<T> cauchy_line(const T& s, const T& t1, const T& t2, const T& length, const T& c2) {
  const T s2 = s * s;
  const T p = T(1) + s2 * c2;
  const T v1 = p + s2 * (t1 * t1);
  const T v2 = p + s2 * (t2 * t2);
  const T w1 = T(1) / v1;
  const T w2 = T(1) / v2;
  CauchyLine<T> out;
  out.drop = s2 * (length * (t1 + t2)) * (w1 * w2) * (w1 + w2);
  if constexpr (kIsDouble<T>) {
    const double reach = v1 + v2 + 2.0 * std::sqrt(v1 * v2);
    const double scale = s2 * (length * length);
    if (reach > kReach14 * kReach14 * scale) {
      if (reach > kReach4 * kReach4 * scale) {
        add_cauchy_nodes<4>(s2, t1, length, p, out);
      } else if (reach > kReach8 * kReach8 * scale) {
        add_cauchy_nodes<8>(s2, t1, length, p, out);
      } else {
        add_cauchy_nodes<14>(s2, t1, length, p, out);
      }
      return out;
    }
    const double near = std::min(std::abs(t1), std::abs(t2));
    if ((t1 > 0.0) == (t2 > 0.0) && kTailReach * s2 * (near * near) >= p) {
      const bool first = t1 > 0.0;
      cauchy_line_tail(s, near, std::max(std::abs(t1), std::abs(t2)), p, first ? w1 : w2,
                       first ? w2 : w1, out);
      return out;
    }
  }
  cauchy_line_closed(s, t1, t2, length, p, w1, w2, out);
  return out;
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class T>
JetOf<T> integral(const Cauchy& kernel, const SegmentFrame<T>& segment, const Vec3<T>& point) {
  using std::abs;
  const Vec3<T> da = point - segment.a;
  const Vec3<T> db = point - segment.b;
  if (!(squared_norm(da) < T(kFarSquared))) return {};
  const T t1 = -dot(da, segment.axis);
  const T t2 = -dot(db, segment.axis);
  // From the nearer end: its difference carries the smaller rounding error.
  const Vec3<T> perp = abs(t1) < abs(t2) ? da + t1 * segment.axis : db + t2 * segment.axis;
  const T s(kernel.s);
  const T amplitude(kernel.amplitude);
  const detail::CauchyLine<T> line =
      detail::cauchy_line(s, t1, t2, segment.length, squared_norm(perp));
  return {amplitude * line.j2,
          (T(-4) * amplitude * (s * s) * line.j3) * perp + (amplitude * line.drop) * segment.axis};
}

template <class T>
JetOf<T> integral(const Cauchy& kernel, const Segment& segment, const Vec3<T>& point) {
  return integral(kernel, SegmentFrame<T>(segment), point);
}

}  // namespace cs2mesh
