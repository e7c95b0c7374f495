// The metaball kernel over a flat triangle: cones squared (1 - r / rho)^2, 3/2 of the one of
// support R less 1/2 of that of support R / 3, each by Green's theorem (support_triangle.h, whose
// legend and changes of form hold). In units of a cone's support, m = 1 - r, mz = 1 - |z|, N = 2 -
// m - mz = r + |z|:
//     G(m) = m^3 (4 - 3m) / 6,
//     D_G = (2/3 (mz^2 + mz m + m^2) - 1/2 (mz + m) (mz^2 + m^2)) / N,   D_h = (mz + m) / N.
//
// Legend: of an edge's part l1 <= t <= l2 within the support, c its distance from p, c^2 = e^2 +
// z^2, s1 and s2 the distances of its ends, l = l2 - l1.
//
//  - Along an edge seen from afar, s1 + s2 > 2.2 l, 14 nodes of D_G, D_h and m^2 (singular at t =
//    +-ic, where r = 0), m computed as (tau - t) (tau + t) / (1 + r);
//  - else antiderivatives, with Lambda = asinh(l2 / c) - asinh(l1 / c):
//        J = e int dt / (r + |z|) = e Lambda - |z| [atan2(e t, c^2 + |z| r)],
//        e int D_G = e l - (4/3) (e I_r + z^2 J) + (1/2) e (I_u + z^2 l),   e int D_h = 2J - e l,
//        int m^2 = l - 2 I_r + I_u,
//        I_r = int r = (l2 s2 - l1 s1 + c^2 Lambda) / 2,   I_u = int r^2 = c^2 l + (l2^3 - l1^3)
//        / 3.
//    Their terms exceed the result by (s1 + s2)^2 / l^2 and some at most.
//  - Within R / 3 the kernel is 1 - 3 r^2 / R^2: the triangle's vertices there, 2 x 2 nodes are
//    exact (as both cones are singular at r = 0, their difference would cancel).
//  - A triangle within R, not within R / 3, its longest edge L short against its distance: the
//    distance is at least that of the farthest vertex less L, reach twice that over L (see
//    inverse_triangle.h), and 6 x 6 nodes of the great cone err by (2 reach)^-12, 6e-17 from reach
//    11.3 on, 8 x 8 by 2e-18 from 6.5 on. Longer ones have L > 0.078 R, and the edges' terms, which
//    are of the order of L, exceed the field little.
//
// Value and gradient are within a few ulp of the exact result for inputs moved by a few ulp (the
// gradient within some dozens, where the cones' parts of it cancel). 0 outside the support; finite
// for every finite p.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "libfield/base/jet.h"
#include "libfield/integral/support_triangle.h"
#include "libfield/kernel/metaball.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh {
namespace detail {

/// h = m^2, m = 1 - r.
struct Cone {};

template <class T>
T height_of(const Cone&, const T& v) {
  using std::sqrt;
  return v / (T(1) + sqrt(T(1) - v));
}
template <class T>
SupportLaw<T> law(const Cone&, const T& m) {
  return {m * m, T(-2) * m / (T(1) - m)};
}
template <class T>
T sum_of(const Cone&, const T& m) {
  return m * m * m * (T(4) - T(3) * m) * T(1.0 / 6.0);
}

/// int D_G, int D_h and int h over an edge's part.
template <class T>
EdgeTerms<T> cone_nodes(const EdgePart<T>& part, const T& z) {
  using std::abs;
  using std::max;
  using std::sqrt;
  constexpr const UnitRule<14>& rule = kUnitRule<14>;
  const T up = abs(z), mz = max(T(0), T(T(1) - up));
  EdgeTerms<T> sum;
  for (std::size_t i = 0; i < 14; ++i) {
    const T t = part.from + part.span * T(rule.node[i]);
    const T r = sqrt(part.c2 + t * t);
    // 1 / (1 + r) and 1 / (r + |z|).
    const Reciprocals<T> one(T(1) + r, max(T(r + up), T(1e-150)));
    const T m = max(T(0), T((part.tau - t) * (part.tau + t) * one.of_a));
    const T squares = mz * mz + m * m, total = mz + m;
    const T weight(rule.weight[i]);
    sum.value +=
        weight * one.of_b * (T(2.0 / 3.0) * (squares + mz * m) - T(0.5) * (total * squares));
    sum.normal += weight * one.of_b * total;
    sum.line += weight * (m * m);
  }
  const T lever = part.e * part.span;
  return {lever * sum.value, lever * sum.normal, part.span * sum.line};
}

/// The same by antiderivatives.
template <class T>
EdgeTerms<T> cone_closed(const EdgePart<T>& part, const T& z) {
  using std::abs;
  using std::max;
  using std::sqrt;
  const T up = abs(z), z2 = z * z;
  const T &e = part.e, &l1 = part.from, &l2 = part.to, &span = part.span;
  const T c2 = max(part.c2, T(1e-280));
  const T s1 = sqrt(c2 + l1 * l1), s2 = sqrt(c2 + l2 * l2);
  // r + t without a difference.
  const auto sum_at = [&](const T& t, const T& s) {
    return select(t < T(0), T(c2 / (s + abs(t))), T(s + t));
  };
  const T lambda = vmath::log(T(sum_at(l2, s2) / sum_at(l1, s1)));
  // The angle of (c^2 + |z| s2, e l2) over (c^2 + |z| s1, e l1).
  const T x1 = c2 + up * s1, x2 = c2 + up * s2, y1 = e * l1, y2 = e * l2;
  // (On a vertex both parts may be 0, and so is the angle's factor.)
  const T angle = vmath::atan2(T(x1 * y2 - x2 * y1), T(x1 * x2 + y1 * y2 + T(1e-300)));
  const T j = e * lambda - up * angle;
  const T int_r = T(0.5) * (l2 * s2 - l1 * s1 + c2 * lambda);
  const T int_u = c2 * span + (l2 * l2 * l2 - l1 * l1 * l1) * T(1.0 / 3.0);
  const T lever = e * span;
  return {lever - T(4.0 / 3.0) * (e * int_r + z2 * j) + T(0.5) * e * (int_u + z2 * span),
          T(2) * j - lever, span - T(2) * int_r + int_u};
}

template <class T>
EdgeTerms<T> edge_terms(const Cone& cone, const EdgePart<T>& part, const T& z, const T& /*w*/) {
  using std::abs;
  using std::max;
  using std::sqrt;
  const T s1 = sqrt(part.c2 + part.from * part.from), s2 = sqrt(part.c2 + part.to * part.to);
  FirstOf<T, EdgeTerms<T>> terms(part.span > T(0));
  terms.take(s1 + s2 > T(kReach14) * part.span, [&] { return cone_nodes(part, z); });
  EdgeTerms<T> sum = terms.otherwise([&] { return cone_closed(part, z); });
  const T mz = max(T(0), T(T(1) - abs(z)));
  sum.value = T(0.5) * (sum.value + part.theta * sum_of(cone, mz));
  sum.normal += part.theta * (mz * mz);
  return sum;
}

inline constexpr double kConeReach6 = 11.3;

/// A part of the metaball: `share` (1 - r / radius)^2; its lines are those of the triangle itself.
template <class T>
SupportSum<T> cone_triangle(const T& radius, const T& share, const TriangleFrame<T>& triangle,
                            const Vec3<T>& point) {
  using std::abs;
  using std::sqrt;
  const T scale = T(1) / radius;
  const TrianglePlace<T> at(triangle, point, scale);
  const MaskOf<T> reached = reached_by_unit(at);
  if (!any(reached)) return {};
  FirstOf<T, SupportSum<T>> sums(reached);
  const auto within = both(at.farthest<T(1), T(9) * at.farthest> T(1));
  const T longest = scale * triangle.edge[0].length;
  const T reach = T(2) * (sqrt(at.farthest) - longest);  // times the longest edge
  const auto cone_law = [](const T& u) { return law(Cone{}, T(T(1) - sqrt(u))); };
  sums.take(within & (reach > T(kConeReach6) * longest),
            [&] { return SupportSum<T>{triangle_nodes<6>(triangle, at.d, scale, cone_law)}; });
  sums.take(within & (reach > T(kReach8) * longest),
            [&] { return SupportSum<T>{triangle_nodes<8>(triangle, at.d, scale, cone_law)}; });
  const SupportSum<T> sum =
      sums.otherwise([&] { return support_edges(Cone{}, triangle, at, scale); });
  const SupportSum<T> sized{
      {(share * radius * radius) * sum.jet.value, (share * radius) * sum.jet.gradient},
      abs(share) * radius * sum.lines};
  return select(reached, sized, SupportSum<T>{});
}

}  // namespace detail

/// The integral, and where it keeps its digits.
template <class T>
TriangleTrial<T> triangle_trial(const Metaball& kernel, const TriangleFrame<T>& triangle,
                                const Vec3<T>& point) {
  const TrianglePlace<T> at(triangle, point);
  const T radius(kernel.radius);
  MaskOf<T> reached = at.near & (triangle.height > T(0));
  if (!any(reached)) return {};
  FirstOf<T, detail::SupportSum<T>> sums(reached);
  sums.take(T(9) * at.farthest < radius * radius, [&] {
    const T fall = T(3) / (radius * radius);
    return detail::SupportSum<T>{detail::triangle_nodes<2>(triangle, at.d, T(1), [&](const T& u) {
      return detail::SupportLaw<T>{T(1) - fall * u, T(-2) * fall};
    })};
  });
  const detail::SupportSum<T> sum = sums.otherwise([&] {
    detail::SupportSum<T> both = detail::cone_triangle(radius, T(1.5), triangle, point);
    const detail::SupportSum<T> inner =
        detail::cone_triangle(T(radius * T(1.0 / 3.0)), T(-0.5), triangle, point);
    both.jet += inner.jet;
    both.lines += inner.lines;
    return both;
  });
  const MaskOf<T> good(MaskOf<T>(!reached) | detail::edges_hold(sum, triangle, at));
  return {select(reached, T(kernel.amplitude) * sum.jet, JetOf<T>{}), good};
}

}  // namespace cs2mesh
