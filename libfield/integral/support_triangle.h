// The soft and quartic kernels over a flat triangle, by Green's theorem on the triangle cut by the
// support. In units of the support, with h = A h(v), G(v) = int_0^v h:
//     f = (1/2) sum [e int D_G dt + theta G(w)],
//     grad f = -sum o int h dt - n z sum [e int D_h dt + theta h(w)],
// sums over the edges, D_G = (G(w) - G(v)) / (w - v), D_h alike.
//
// Legend: z height of p over the plane along the unit normal n, w = 1 - z^2; of an edge, o the
// outward unit normal in the plane, e the distance of p's foot from it (> 0 on the inner side), t
// the abscissa along it from the foot, v = 1 - z^2 - e^2 - t^2, computed as (tau - t) (tau + t),
// which keeps its digits at the edge of the support; int is over the part |t| < tau within the
// support, theta the angle that the parts outside subtend at the foot.
//
// The integrands are polynomials: four nodes are exact. With the foot on the triangle all terms of
// f are positive. With it outside they cancel, and the form changes:
//  - a triangle within the support is a polynomial itself: 4 x 4 nodes are exact;
//  - all edges seen from afar, sqrt(e^2 + l1^2) + sqrt(e^2 + l2^2) > 2.2 (l2 - l1) for the ends of
//    their parts within the support: as the edges' whole angles add up to 0,
//        f = -(1/2) sum e int G(v) / (e^2 + t^2) dt,   df/dn = z sum e int h / (e^2 + t^2) dt,
//    whose terms are as small as the field where the support cuts little off. Nodes err on w^k /
//    (e^2 + t^2) alone (the rest is a polynomial), by (2 reach)^-2N of it, reach the ratio above;
//    v > w / reach^2 half way along, so by reach^(2k) (2 reach)^-2N of the integral: with 14 nodes
//    below 1e-15 (k = 3), and so with 8 from reach 12 on. The field of such a cap falls so
//    steeply that rounding of the inputs does as much from there on;
//  - else an edge as long as half its distance carries the field, and the terms exceed it little.
// Rounding moves the edges apart by eps l, l the distance of the farthest vertex, which changes f
// by eps l sum int h dt. Where that is more than rounding the inputs does, eps (kappa f + |grad f|
// l), kappa the longest edge over the smallest height, as in slivers far smaller than the support
// and across its edge, quadrature takes over. Value and gradient are within a few ulp of the exact
// result for inputs moved by a few ulp. 0 outside the support; finite for every finite p.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "libfield/base/jet.h"
#include "libfield/integral/support_segment.h"
#include "libfield/integral/triangle_place.h"
#include "libfield/integral/triangle_trial.h"
#include "libfield/kernel/quartic.h"
#include "libfield/kernel/soft.h"

namespace cs2mesh {
namespace detail {

/// What an edge adds: to f, to df/dn / -z, and the line integral of h.
template <class T>
struct EdgeTerms {
  T value{}, normal{}, line{};

  friend EdgeTerms select(const MaskOf<T>& mask, const EdgeTerms& yes, const EdgeTerms& no) {
    return {select(mask, yes.value, no.value), select(mask, yes.normal, no.normal),
            select(mask, yes.line, no.line)};
  }
};

/// The part of an edge within a support of radius 1.
template <class T>
struct EdgePart {
  T e, c2, tau;
  T from, to;   ///< its ends; equal if it has none
  T span;       ///< to - from: the length itself where nothing is cut off
  T theta;      ///< angle at the foot of what is cut off
  T sums, gap;  ///< sqrt(e^2 + from^2) + sqrt(e^2 + to^2); 2.2 span

  EdgePart(const EdgePlace<T>& at, const T& length, const T& z) : e(at.e) {
    using std::max;
    using std::min;
    using std::sqrt;
    c2 = e * e + z * z;
    tau = half_chord_of(T(1), T(sqrt(c2)));
    from = min(max(T(-tau), at.t1), at.t2);
    to = max(min(tau, at.t2), at.t1);
    const auto whole = both(at.t1 >= -tau, at.t2 <= tau);
    // The length itself where nothing is cut off: t1 and t2 carry the rounding of the distance.
    span = max(T(0), select(whole, length, T(to - from)));
    theta = T(0);
    if (!all(whole)) theta = angle_of_stretches(e, at.t1, from, to, at.t2);
    sums = sqrt(e * e + from * from) + sqrt(e * e + to * to);
    gap = T(kReach14) * span;
  }
  MaskOf<T> from_afar() const { return sums > gap; }
};

/// G(v) = int_0^v h.
template <class T>
T sum_of(const Quartic&, const T& v) {
  return v * v * v * T(1.0 / 3.0);
}
template <class T>
T sum_of(const Soft&, const T& v) {
  return v * v * v * (T(5) + T(3) * v) * T(1.0 / 27.0);
}
/// The divided differences of G and h between w and v.
template <class T>
struct Differences {
  T sum, law;
};
template <class T>
Differences<T> differences(const Quartic&, const T& w, const T& v) {
  return {(w * w + w * v + v * v) * T(1.0 / 3.0), w + v};
}
template <class T>
Differences<T> differences(const Soft&, const T& w, const T& v) {
  const T squares = w * w + v * v, sum = w + v;
  const T three = squares + w * v;
  return {(T(5) * three + T(3) * sum * squares) * T(1.0 / 27.0),
          (T(5) * sum + T(4) * three) * T(1.0 / 9.0)};
}

template <class K, class T>
EdgeTerms<T> edge_terms(const K& kernel, const EdgePart<T>& part, const T& /*z*/, const T& w) {
  using std::max;
  constexpr const UnitRule<4>& rule = kUnitRule<4>;
  EdgeTerms<T> sum;
  for (std::size_t i = 0; i < 4; ++i) {
    const T t = part.from + part.span * T(rule.node[i]);
    const T v = max(T(0), T((part.tau - t) * (part.tau + t)));
    const Differences<T> over = differences(kernel, w, v);
    const T weight(rule.weight[i]);
    sum.value += weight * over.sum;
    sum.normal += weight * over.law;
    sum.line += weight * law(kernel, v).h;
  }
  const T lever = part.e * part.span;
  return {T(0.5) * (lever * sum.value + part.theta * sum_of(kernel, w)),
          lever * sum.normal + part.theta * law(kernel, w).h, part.span * sum.line};
}

/// What h is a polynomial of, as a function of v.
template <class K, class T>
T height_of(const K&, const T& v) {
  return v;
}

/// Value and normal with the angles of whole edges left out.
template <std::size_t N, class K, class T>
EdgeTerms<T> edge_terms_from_afar(const K& kernel, const EdgePart<T>& part) {
  using std::max;
  constexpr const UnitRule<N>& rule = kUnitRule<N>;
  const T e2 = part.e * part.e;
  EdgeTerms<T> sum;
  for (std::size_t i = 0; i < N; ++i) {
    const T t = part.from + part.span * T(rule.node[i]);
    const T v = max(T(0), T((part.tau - t) * (part.tau + t)));
    const T weight = T(rule.weight[i]) / max(T(e2 + t * t), T(1e-300));
    const T height = height_of(kernel, v);
    sum.value += weight * sum_of(kernel, height);
    sum.normal += weight * law(kernel, height).h;
  }
  const T lever = part.e * part.span;
  return {T(-0.5) * lever * sum.value, -lever * sum.normal, {}};
}

inline constexpr double kCapReach8 = 12.0;

/// Foot outside of the triangle: the edges from afar in place of value and normal.
template <class K, class T>
void see_from_afar(const K& kernel, const std::array<EdgePart<T>, 3>& part,
                   const MaskOf<T>& outside, std::array<EdgeTerms<T>, 3>& terms) {
  MaskOf<T> afar = outside, farther = outside;
  for (std::size_t i = 0; i < 3; ++i) {
    afar = afar & part[i].from_afar();
    farther = farther & (part[i].sums > T(kCapReach8) * part[i].span);
  }
  if (!any(afar)) return;
  for (std::size_t i = 0; i < 3; ++i) {
    FirstOf<T, EdgeTerms<T>> from_afar(afar);
    from_afar.take(farther, [&] { return edge_terms_from_afar<8>(kernel, part[i]); });
    EdgeTerms<T> seen =
        from_afar.otherwise([&] { return edge_terms_from_afar<14>(kernel, part[i]); });
    seen.line = terms[i].line;
    terms[i] = select(afar, seen, terms[i]);
  }
}

/// A kernel of support 1 and amplitude 1, by the edges.
template <class T>
struct SupportSum {
  JetOf<T> jet{};
  T lines{};  ///< sum int h dt

  friend SupportSum select(const MaskOf<T>& mask, const SupportSum& yes, const SupportSum& no) {
    return {select(mask, yes.jet, no.jet), select(mask, yes.lines, no.lines)};
  }
};

template <class K, class T>
SupportSum<T> support_edges(const K& kernel, const TriangleFrame<T>& triangle,
                            const TrianglePlace<T>& at, const T& scale) {
  using std::abs;
  using std::max;
  const T w = max(T(0), T((T(1) - abs(at.z)) * (T(1) + abs(at.z))));
  const auto part_of = [&](std::size_t i) {
    return EdgePart<T>(at.edge[i], T(scale * triangle.edge[i].length), at.z);
  };
  const std::array<EdgePart<T>, 3> part{part_of(0), part_of(1), part_of(2)};
  std::array<EdgeTerms<T>, 3> terms;
  for (std::size_t i = 0; i < 3; ++i) terms[i] = edge_terms(kernel, part[i], at.z, w);
  see_from_afar(kernel, part, MaskOf<T>(!at.over), terms);
  JetOf<T> jet;
  T normal(0), lines(0);
  MaskOf<T> reached = at.over;
  for (std::size_t i = 0; i < 3; ++i) {
    reached = reached | (part[i].span > T(0));
    jet.value += terms[i].value;
    normal += terms[i].normal;
    lines += terms[i].line;
    jet.gradient -= terms[i].line * triangle.edge[i].outward;
  }
  jet.gradient -= (at.z * normal) * triangle.normal;
  // Beside a disc that meets no edge, angles that add up to 0 are left.
  return {select(reached, jet, JetOf<T>{}), lines};
}

/// Whether edges as far apart as rounding moves them change the value little; lengths in units of
/// 1 / scale.
template <class T>
MaskOf<T> edges_hold(const SupportSum<T>& sum, const TriangleFrame<T>& triangle,
                     const TrianglePlace<T>& at) {
  using std::sqrt;
  const T l = sqrt(at.farthest);
  const T allowed = (triangle.edge[0].length / triangle.height) * sum.jet.value +
                    sqrt(squared_norm(sum.jet.gradient)) * l;
  return l * sum.lines <= T(10) * allowed;
}

/// Whether the ball of radius 1 about p can reach the triangle: necessary, not sufficient.
template <class T>
MaskOf<T> reached_by_unit(const TrianglePlace<T>& at) {
  using std::abs;
  MaskOf<T> reached = abs(at.z) < T(1);
  for (const EdgePlace<T>& edge : at.edge) reached = reached & (edge.e > T(-1));
  return reached;
}

}  // namespace detail

/// The integral, and where it keeps its digits.
template <class K, class T>
requires detail::kIsPolynomial<K> TriangleTrial<T> triangle_trial(const K& kernel,
                                                                  const TriangleFrame<T>& triangle,
                                                                  const Vec3<T>& point) {
  const T scale(1.0 / kernel.radius);
  const TrianglePlace<T> at(triangle, point, scale);
  const MaskOf<T> reached = at.near & (triangle.height > T(0)) & detail::reached_by_unit(at);
  if (!any(reached)) return {};
  FirstOf<T, detail::SupportSum<T>> sums(reached);
  sums.take(at.farthest < T(1), [&] {
    return detail::SupportSum<T>{detail::triangle_nodes<4>(
        triangle, at.d, scale, [&](const T& u) { return detail::law(kernel, T(T(1) - u)); })};
  });
  const detail::SupportSum<T> sum =
      sums.otherwise([&] { return detail::support_edges(kernel, triangle, at, scale); });
  const T amplitude(kernel.amplitude), radius(kernel.radius);
  const JetOf<T> jet{(amplitude * radius * radius) * sum.jet.value,
                     (amplitude * radius) * sum.jet.gradient};
  const MaskOf<T> good(MaskOf<T>(!reached) | detail::edges_hold(sum, triangle, at));
  return {select(reached, jet, JetOf<T>{}), good};
}

}  // namespace cs2mesh
