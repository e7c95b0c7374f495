// The kernels of finite support over a segment: soft objects and quartic exactly by Gauss-Legendre
// of their polynomials (thesis appendix B), metaballs by polynomials, logarithms and nodes.
//     f = int h dt,   grad f = M perp - S axis,   M = int 2K dt,  S = int 2K t dt,  K = dh/du.
//
// Legend: t the abscissa along the segment counted from the foot of p on its line, c the distance
// from p to the line, perp the vector from the line to p; r^2 = u = c^2 + t^2; R the support,
// tau = sqrt(R^2 - c^2) half the chord that the ball about p cuts out of the line; v = 1 - u / R^2
// computed as (tau - t) (tau + t) / R^2, which keeps its digits at the edge of the support.
//
// Metaballs: 1 - 3u / R^2 within R / 3. Between R / 3 and R, on either side of the foot,
// (3/2) (1 - r / R)^2 has the antiderivative of r and 1 / r; where the piece is short against its
// distance (near the edge) that cancels, and 14 nodes of m^2, m = (tau - t) (tau + t) / (R (R +
// r)), serve. Value and gradient are within a few ulp of the exact result for inputs moved by a few
// ulp (a metaball's gradient within some dozens). 0 outside the support; finite for every finite p.
#pragma once

#include <cmath>
#include <type_traits>

#include "libfield/base/jet.h"
#include "libfield/integral/segment_place.h"
#include "libfield/kernel/metaball.h"
#include "libfield/kernel/quartic.h"
#include "libfield/kernel/soft.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh {
namespace detail {

/// int h dt, int 2K dt, int 2K t dt.
template <class T>
struct SupportLine {
  T value{}, m{}, s{};

  SupportLine& operator+=(const SupportLine& b) {
    value += b.value;
    m += b.m;
    s += b.s;
    return *this;
  }
  friend SupportLine select(const MaskOf<T>& mask, const SupportLine& yes, const SupportLine& no) {
    return {select(mask, yes.value, no.value), select(mask, yes.m, no.m),
            select(mask, yes.s, no.s)};
  }
};

/// Half the chord of a ball; 0 where it misses the line.
template <class T>
T half_chord_of(const T& radius, const T& c) {
  using std::max;
  using std::sqrt;
  return sqrt(max(T(0), T((radius - c) * (radius + c))));
}

/// h and 2K as functions of v, for amplitude 1 and support 1.
template <class T>
struct SupportLaw {
  T h, slope;
};
template <class T>
SupportLaw<T> law(const Soft&, const T& v) {
  return {v * v * (T(5) + T(4) * v) * T(1.0 / 9.0), v * (T(10) + T(12) * v) * T(-2.0 / 9.0)};
}
template <class T>
SupportLaw<T> law(const Quartic&, const T& v) {
  return {v * v, T(-4) * v};
}

/// Four nodes are exact: h has degree 6 in t, 2K t degree 5.
template <class K, class T>
SupportLine<T> support_line(const K& kernel, const SegmentPlace<T>& at, const T& length) {
  using std::max;
  using std::min;
  using std::sqrt;
  const T radius(kernel.radius);
  const T tau = half_chord_of(radius, T(sqrt(at.c2)));
  const T from = max(at.t1, T(-tau)), to = min(at.t2, tau);
  // The length itself where nothing is cut off: t1 and t2 carry the rounding of the distance.
  const auto whole = both(at.t1 >= -tau, at.t2 <= tau);
  const T span = max(T(0), select(whole, length, T(to - from)));
  const T scale = T(1) / (radius * radius);
  constexpr const UnitRule<4>& rule = kUnitRule<4>;
  SupportLine<T> sum;
  for (std::size_t i = 0; i < 4; ++i) {
    const T t = from + span * T(rule.node[i]);
    const T v = max(T(0), T((tau - t) * (tau + t) * scale));
    const SupportLaw<T> here = law(kernel, v);
    const T weight(rule.weight[i]);
    sum.value += weight * here.h;
    sum.m += weight * here.slope;
    sum.s += weight * here.slope * t;
  }
  const T m = scale * span;
  return {span * sum.value, m * sum.m, m * sum.s};
}

/// 1 - 3u / R^2 over `span` from `from` on.
template <class T>
SupportLine<T> metaball_inner(const T& radius, const T& c2, const T& from, const T& span) {
  const T scale = T(3) / (radius * radius);
  const T middle = from + T(0.5) * span;
  const T mean = c2 + middle * middle + span * span * T(1.0 / 12.0);
  const T m = T(-2) * scale * span;
  return {span * (T(1) - scale * mean), m, m * middle};
}

/// (3/2) (1 - r / R)^2 over a <= t <= a + span, 0 <= a, all of it within the support; by the chord.
template <class T>
SupportLine<T> metaball_outer_nodes(const T& radius, const T& c2, const T& tau, const T& a,
                                    const T& span) {
  using std::sqrt;
  constexpr const UnitRule<14>& rule = kUnitRule<14>;
  const T inverse = T(1) / radius;
  SupportLine<T> sum;
  for (std::size_t i = 0; i < 14; ++i) {
    const T t = a + span * T(rule.node[i]);
    const T r = sqrt(c2 + t * t);
    const T both = T(1) / (r * (radius + r));
    const T rest = (tau - t) * (tau + t) * both * inverse;  // m / r
    const T m = rest * r;
    const T weight(rule.weight[i]);
    sum.value += weight * (m * m);
    sum.m += weight * rest;
    sum.s += weight * rest * t;
  }
  const T slope = T(-3) * inverse * span;
  return {T(1.5) * span * sum.value, slope * sum.m, slope * sum.s};
}

/// The same by antiderivatives; b = a + span.
template <class T>
SupportLine<T> metaball_outer_closed(const T& radius, const T& c2, const T& a, const T& span) {
  using std::sqrt;
  const T b = a + span;
  const T ra = sqrt(c2 + a * a), rb = sqrt(c2 + b * b);
  // asinh(b / c) - asinh(a / c).
  const T lambda = vmath::log(T((b + rb) / (a + ra)));
  const T inverse = T(1) / radius;
  const T int_r = T(0.5) * (b * rb - a * ra + c2 * lambda);
  const T int_u = c2 * span + (b * b * b - a * a * a) * T(1.0 / 3.0);
  const T slope = T(-3) * inverse;
  return {T(1.5) * (span - T(2) * int_r * inverse + int_u * (inverse * inverse)),
          slope * (lambda - span * inverse),
          slope * ((rb - ra) - T(0.5) * span * (a + b) * inverse)};
}

/// The part between R / 3 and R on the side of positive t: a <= t <= a + span.
template <class T>
SupportLine<T> metaball_side(const T& radius, const T& c2, const T& tau, const T& a,
                             const T& span) {
  using std::sqrt;
  const auto there = span > T(0);
  if (!any(there)) return {};
  const T b = a + span;
  const T reach = sqrt(c2 + a * a) + sqrt(c2 + b * b);
  FirstOf<T, SupportLine<T>> lines(there);
  lines.take(reach > T(2.2) * span, [&] { return metaball_outer_nodes(radius, c2, tau, a, span); });
  return lines.otherwise([&] { return metaball_outer_closed(radius, c2, a, span); });
}

template <class T>
SupportLine<T> support_line(const Metaball& kernel, const SegmentPlace<T>& at, const T& length) {
  using std::max;
  using std::min;
  using std::sqrt;
  const T radius(kernel.radius);
  const T c = sqrt(at.c2);
  const T tau = half_chord_of(radius, c), core = half_chord_of(T(radius * T(1.0 / 3.0)), c);
  const auto extent = [](const T& from, const T& to) { return max(T(0), T(to - from)); };
  const T inner = max(at.t1, T(-core)), right = max(at.t1, core), left = max(T(-at.t2), core);
  T inner_span = extent(inner, min(at.t2, core)), right_span = extent(right, min(at.t2, tau)),
    left_span = extent(left, min(T(-at.t1), tau));
  // Where the support cuts nothing off, the parts add up to the length itself: t1 and t2 carry the
  // rounding of the distance, which may be far more than a short segment's.
  const auto whole = both(at.t1 >= -tau, at.t2 <= tau, length > T(0));
  const T scale = select(whole, length / max(inner_span + right_span + left_span, T(1e-300)), T(1));
  inner_span *= scale, right_span *= scale, left_span *= scale;
  SupportLine<T> sum = metaball_inner(radius, at.c2, inner, inner_span);
  sum += metaball_side(radius, at.c2, tau, right, right_span);
  const SupportLine<T> other = metaball_side(radius, at.c2, tau, left, left_span);
  sum += {other.value, other.m, -other.s};
  return sum;
}

template <class K, class T>
JetOf<T> support_segment(const K& kernel, const SegmentFrame<T>& segment, const Vec3<T>& point) {
  const SegmentPlace<T> at(segment, point);
  const T radius(kernel.radius);
  const auto reached = both(radius * radius > at.c2, radius > at.t1, at.t2 > -radius);
  if (!any(reached)) return {};
  const SupportLine<T> line = support_line(kernel, at, segment.length);
  const T amplitude(kernel.amplitude);
  const JetOf<T> jet{amplitude * line.value,
                     (amplitude * line.m) * at.perp - (amplitude * line.s) * segment.axis};
  return select(reached, jet, JetOf<T>{});
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class K, class T>
requires(std::is_same_v<K, Soft> || std::is_same_v<K, Quartic> ||
         std::is_same_v<K, Metaball>) JetOf<T> integral(const K& kernel,
                                                        const SegmentFrame<T>& segment,
                                                        const Vec3<T>& point) {
  return detail::support_segment(kernel, segment, point);
}
template <class K, class T>
requires(std::is_same_v<K, Soft> || std::is_same_v<K, Quartic> ||
         std::is_same_v<K, Metaball>) JetOf<T> integral(const K& kernel, const Segment& segment,
                                                        const Vec3<T>& point) {
  return integral(kernel, SegmentFrame<T>(segment), point);
}

}  // namespace cs2mesh
