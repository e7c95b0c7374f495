// The kernel 1 / r^2 over a flat triangle. Its value is a dilogarithm; integrals along the edges
// whose integrands have one sign are cheaper and keep their digits:
//     f = (1/2) sum e int log(1 + q / z^2) / q dt,   q = e^2 + t^2,
//     grad f = -sum o J - n (1/z) sum e J;
// with the foot of p outside of the triangle and p close to the plane, as the angles that the edges
// subtend add up to 0, for any length r0
//     f = (1/2) sum e int log(r^2 / r0^2) / q dt,   df/dn = z sum e int dt / (q r^2).
//
// Legend: z height of p over the plane along the unit normal n; of an edge, o the outward unit
// normal in the plane, e the distance of p's foot from it (> 0 on the inner side), t the abscissa
// along it from the foot, r^2 = z^2 + q, J = int dt / r^2 along it (inverse_segment.h).
//
// The first integrand is singular at t = +-i sqrt(e^2 + z^2) alone (at q = 0 it is 1 / z^2), the
// others at +-i e as well: panels of 14 nodes that keep 2.2 and 2.4 times their lengths from them
// (edge_panels.h) err by 5e-18 and, for the normal's, 2e-15 of them. In either form the logarithm
// is that of w = r^2 / r0^2, with r0 = |z| in the first. Far away and where the edges cancel: as in
// inverse_triangle.h. Value and gradient are within a few ulp of the exact result for inputs moved
// by a few ulp. Finite for every finite p.
#pragma once

#include <algorithm>
#include <cmath>

#include "libfield/base/jet.h"
#include "libfield/integral/edge_panels.h"
#include "libfield/integral/inverse_triangle.h"
#include "libfield/kernel/squared.h"

namespace cs2mesh {
namespace detail {

/// Squared distance in the plane from p's foot to the triangle.
template <class T>
T squared_plane_gap(const TrianglePlace<T>& at) {
  using std::max;
  using std::min;
  T least = select(at.over, T(0), T(HUGE_VAL));
  for (const EdgePlace<T>& edge : at.edge) {
    const T beyond = max(T(0), max(edge.t1, T(-edge.t2)));
    least = min(least, T(edge.e * edge.e + beyond * beyond));
  }
  return least;
}

/// Beside the triangle, seen from far along the edge, 1 / (q r^2) is of the fourth order in 1 / t.
inline constexpr double kBesideReach = 2.4;

/// The sums along an edge, without the factors before them.
template <class T>
struct SquaredSums {
  T value{}, normal{};
};

/// How the edges are summed, `beside` the triangle or over it: x = q / r0^2, w = r^2 / r0^2.
template <class T>
struct SquaredForm {
  MaskOf<T> beside;
  T inverse_u0;   ///< 1 / r0^2
  T w0, least_w;  ///< w where q is 0, and its least value: above 1 over the triangle
  T reach;        ///< of the panels

  SquaredForm(const T& z2, const T& gap2)
      : beside(T(4) * z2 < gap2),
        inverse_u0(T(1) / select(beside, T(gap2 + z2), z2)),
        w0(select(beside, T(z2 * inverse_u0), T(1))),
        least_w(select(beside, T(0), T(1.0 + 0x1p-52))),
        reach(select(beside, T(kBesideReach), T(kReach14))) {}
};

/// log(w) / x beside the triangle, log(w) / (w - 1) over it, but for the division.
template <class T>
struct SquaredNode {
  T w, over, divisor;
  vmath::Logarithm<T> log;

  T ratio(const T& inverse_divisor) const {
    return log.at(T(log.numerator * (inverse_divisor * over))) *
           (inverse_divisor * log.denominator);
  }
};

template <class T>
SquaredNode<T> squared_node(const SquaredForm<T>& form, const T& q) {
  using std::max;
  const T x = q * form.inverse_u0, w = max(T(form.w0 + x), form.least_w);
  // log(w) / (w - 1) for the w that rounding makes of 1 + x is that for x to rounding.
  const T over = select(form.beside, x, T(w - T(1)));
  const vmath::Logarithm<T> log(w);
  return {w, over, log.denominator * over, log};
}

/// Over the triangle int log(w) / (w - 1) dt, beside it int log(w) / x dt and int dt / (x w), where
/// x = q / r0^2.
template <class T>
SquaredSums<T> squared_sums(const SquaredForm<T>& form, const EdgePlace<T>& at, const T& z2,
                            const T& length, const MaskOf<T>& lanes) {
  const T e2 = at.e * at.e;
  const T poles2 = select(form.beside, e2, T(e2 + z2));
  const bool any_beside = any(MaskOf<T>(lanes & form.beside));
  SquaredSums<T> sum;
  visit_edge_panels(
      Stretch<T>{at.t1, at.t2, length}, lanes,
      [&](const T& t) { return longest_panel(form.reach, t, poles2); },
      [&](const T& t, const T& s, const T& weight) {
        const auto a = squared_node(form, T(e2 + t * t)), b = squared_node(form, T(e2 + s * s));
        const T inverse = T(1) / (a.divisor * b.divisor);
        sum.value += weight * (a.ratio(T(inverse * b.divisor)) + b.ratio(T(inverse * a.divisor)));
        if (any_beside) {
          const T x = a.over * a.w, y = b.over * b.w;
          sum.normal += weight * ((x + y) / (x * y));
        }
      });
  return sum;
}

template <class T>
TriangleTrial<T> squared_edges(const Squared& kernel, const TriangleFrame<T>& triangle,
                               const TrianglePlace<T>& at, const TriangleDistance<T>& distance,
                               const MaskOf<T>& lanes) {
  using std::abs;
  using std::sqrt;
  const std::array<T, 3> r{sqrt(at.u[0]), sqrt(at.u[1]), sqrt(at.u[2])};
  const std::array<T, 3> lines = inverse_lines(kernel, triangle, at, r);
  const T z2 = at.z * at.z;
  const SquaredForm<T> form(z2, squared_plane_gap(at));
  TriangleTrial<T> trial;
  EdgeSizes<T> size;
  T normal(0);
  for (std::size_t i = 0; i < 3; ++i) {
    const EdgePlace<T>& edge = at.edge[i];
    // Where e is 0 there is nothing: p's foot sees the edge under no angle.
    const MaskOf<T> seen = lanes & (abs(edge.e) > T(0));
    const SquaredSums<T> sum = squared_sums(form, edge, z2, triangle.edge[i].length, seen);
    const T lever = edge.e * form.inverse_u0;
    const T value = select(seen, T(T(0.5) * lever * sum.value), T(0));
    const T rise = select(form.beside, T(at.z * lever * form.inverse_u0 * sum.normal),
                          T(-edge.e * lines[i] / at.z));
    trial.jet.value += value;
    normal += select(seen, rise, T(0));
    trial.jet.gradient -= lines[i] * triangle.edge[i].outward;
    size.value += abs(value);
    size.gradient += lines[i] + select(seen, T(abs(rise)), T(0));
  }
  trial.jet.gradient += normal * triangle.normal;
  trial.good = sums_hold(trial.jet, size, T(trial.jet.value / at.farthest), distance.farthest);
  return trial;
}

}  // namespace detail

/// The integral, and where it keeps its digits.
template <class T>
TriangleTrial<T> triangle_trial(const Squared& kernel, const TriangleFrame<T>& triangle,
                                const Vec3<T>& point) {
  const TrianglePlace<T> at(triangle, point);
  const MaskOf<T> near(at.near & (triangle.height > T(0)));
  if (!any(near)) return {};
  const MaskOf<T> clear(!detail::may_be_clamped(kernel, triangle, at));
  const detail::TriangleDistance<T> distance(triangle, at);
  TriangleTrial<T> trial =
      detail::afar_or(kernel, triangle, at, distance, [&](const MaskOf<T>& lanes) {
        return detail::squared_edges(kernel, triangle, at, distance, lanes & near & clear);
      });
  trial.good = MaskOf<T>(!near) | (trial.good & clear);
  trial.jet = select(near, T(kernel.amplitude) * trial.jet, JetOf<T>{});
  return trial;
}

}  // namespace cs2mesh
