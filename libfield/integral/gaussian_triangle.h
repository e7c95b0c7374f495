// The Gaussian kernel over a flat triangle. In place of Owen's T function, whose terms cancel,
// integrals along the edges (g = exp(log A - a^2 z^2), q = e^2 + t^2):
//     f = g / (2 a^2) sum e int (1 - exp(-a^2 q)) / q dt
// and, with the foot of p outside of the triangle, where the angles of the edges add up to 0,
//     f = -g / (2 a^2) sum e int exp(-a^2 q) / q dt;
//     grad f = -sum o J - 2 a^2 z f n.
//
// Legend: z height of p over the plane along the unit normal n; of an edge, o the outward unit
// normal in the plane, e the distance of p's foot from it (> 0 on the inner side), t the abscissa
// along it from the foot, J = int h dt along it (gaussian_segment.h); theta the angle that the
// parts of an edge beyond a^2 q = 40, where exp is below rounding, subtend at the foot.
//
//  - Near or over the triangle (a times the foot's distance to it below 1) the first: every term is
//    positive over the triangle, and within e of the result beside it. Panels of 14 nodes cover a^2
//    q < 40, theta is the rest. The integrand has no pole; on a panel of length 2.5 / a 14 nodes
//    err by 2e-18 of it at most, wherever it lies (computed).
//  - Farther out the second, over what lies within exp(-45) of the field's greatest value. A panel
//    whose near end's exponent is D below the greatest may span a change of 10 + D, keeps 2.6 times
//    its length from the poles t = +-i e (edge_panels.h) and is no longer than 2.5 / a: 7e-17 of
//    the integral is the greatest error on edges from foot or end outward, whatever e and t
//    (computed; some 3 panels an edge). e is at least 1 / a where the foot lies on the edge itself.
//  - Along an interval of length 1 on which the exponent is -(w x + b x^2 + const), |exp| on the
//    ellipse of half axes' sum rho / 2 (gauss_legendre.h) exceeds its greatest value there by
//    exp(w rho / 4 + b rho^2 / 16) at most, so N nodes err by rho^-2N times that: with rho = 320,
//    70, 30 below some 1e-17 for N = 4, 6, 8 while 80 w + 6400 b < 7, 17.5 w + 306 b < 12, 7.5 w +
//    56 b < 15. N x N nodes do on a triangle for its greatest w and b.
// One exponent holds the amplitude and the distance, cut off at Gaussian::kGreatestExponent. What
// cancels still, as small or thin triangles seen from afar do, goes to quadrature. Value and
// gradient are within a few ulp of the exact result for inputs moved by a few ulp. Finite for every
// finite p.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "libfield/base/jet.h"
#include "libfield/integral/gaussian_segment.h"
#include "libfield/integral/squared_triangle.h"
#include "libfield/integral/triangle_place.h"
#include "libfield/integral/triangle_trial.h"
#include "libfield/kernel/gaussian.h"

namespace cs2mesh {
namespace detail {

inline constexpr double kNearEnd = 40.0;  ///< of the first form: exp(-40) = 4e-18
/// The longest panel, in units of 1 / a; the reach of those of the second form.
inline constexpr double kEdgeSpan = 2.5, kEdgeReach = 2.6;
/// The change of the exponent that a panel may span where the field is greatest.
inline constexpr double kEdgeChange = 10.0;

/// Which integral along the edges, in units of 1 / a: the first form near the triangle, else the
/// second, whose exponent is least, x0, at the point of the triangle next to the foot.
template <class T>
struct GaussianForm {
  MaskOf<T> near;
  T x0, one;  ///< one: 1 in the first form

  explicit GaussianForm(const T& x_least)
      : near(x_least < T(1)), x0(select(near, T(0), x_least)), one(select(near, T(1), T(0))) {}

  /// -1 times the integrand, at x = a^2 q and at y.
  T sum_at(const T& x, const T& y) const {
    const T fx = vmath::exp_less(T(x0 - x), one), fy = vmath::exp_less(T(x0 - y), one);
    return (fx * y + fy * x) / (x * y);
  }
  /// The longest panel that may begin at t.
  T limit(const T& t, const T& e2) const {
    using std::max;
    using std::min;
    using std::sqrt;
    const T span(kEdgeSpan);
    if (all(near)) return span;
    // Of change c: t' L + L^2 / 2 = c / 2, t' = t or 0.
    const T change = T(kEdgeChange) + max(T(0), T(e2 + t * t - x0)), out = max(T(0), t);
    const T falling = change / (out + sqrt(out * out + change));
    const T clear = longest_panel(T(kEdgeReach), t, e2);
    return select(near, span, min(span, min(falling, clear)));
  }
};

/// e int (1 - exp(-a^2 q)) / q dt near the triangle, -e int exp(-(a^2 q - x0)) / q dt beside it, in
/// the lanes that are set.
template <class T>
T gaussian_edge(const GaussianForm<T>& form, const T& a, const EdgePlace<T>& at, const T& length,
                const MaskOf<T>& lanes) {
  using std::max;
  using std::min;
  using std::sqrt;
  const T end = select(form.near, T(kNearEnd), T(form.x0 + T(kGaussianEnd)));
  const T tau = sqrt(max(T(0), T(end / (a * a) - at.e * at.e)));
  const T from = min(max(T(-tau), at.t1), at.t2), to = max(min(tau, at.t2), at.t1);
  const MaskOf<T> whole = both(at.t1 >= -tau, at.t2 <= tau);
  const MaskOf<T> open(lanes & form.near & MaskOf<T>(!whole));
  T theta(0);
  if (any(open)) {
    theta = select(open, angle_of_stretches(at.e, at.t1, from, to, at.t2), T(0));
  }
  const T e = a * at.e, e2 = e * e;
  T sum(0);
  visit_edge_panels(
      Stretch<T>{a * from, a * to, a * max(T(0), select(whole, length, T(to - from)))}, lanes,
      [&](const T& t) { return form.limit(t, e2); },
      [&](const T& t, const T& s, const T& weight) {
        const T least(1e-140);
        sum -= weight * form.sum_at(max(T(e2 + t * t), least), max(T(e2 + s * s), least));
      });
  return select(lanes, T(e * sum + theta), T(0));
}

template <class T>
TriangleTrial<T> gaussian_edges(const Gaussian& kernel, const TriangleFrame<T>& triangle,
                                const TrianglePlace<T>& at, const T& gap2, const MaskOf<T>& lanes) {
  using std::abs;
  using std::sqrt;
  const T a(kernel.a), a2 = a * a, z2 = at.z * at.z;
  const GaussianForm<T> form(T(a2 * gap2));
  const T scale = bounded_exp(T(T(kernel.log_amplitude) - a2 * z2 - form.x0)) * (T(0.5) / a2);
  TriangleTrial<T> trial;
  EdgeSizes<T> size;
  for (std::size_t i = 0; i < 3; ++i) {
    const EdgePlace<T>& edge = at.edge[i];
    const T& length = triangle.edge[i].length;
    const MaskOf<T> seen = lanes & (abs(edge.e) > T(0));
    const T term = scale * gaussian_edge(form, a, edge, length, seen);
    const T line = gaussian_line(kernel, edge.t1, edge.t2, length, T(edge.e * edge.e + z2)).value;
    trial.jet.value += term;
    trial.jet.gradient -= line * triangle.edge[i].outward;
    size.value += abs(term);
    size.gradient += line;
  }
  trial.jet.gradient -= (T(2) * a2 * at.z * trial.jet.value) * triangle.normal;
  trial.good = sums_hold(trial.jet, size, T(T(2) * a2 * trial.jet.value), T(sqrt(at.farthest)));
  return trial;
}

}  // namespace detail

/// The integral, and where it keeps its digits.
template <class T>
TriangleTrial<T> triangle_trial(const Gaussian& kernel, const TriangleFrame<T>& triangle,
                                const Vec3<T>& point) {
  using std::sqrt;
  const TrianglePlace<T> at(triangle, point);
  const T a2(kernel.a * kernel.a), gap2 = detail::squared_plane_gap(at);
  const T log_amplitude(kernel.log_amplitude);
  const T exponent = log_amplitude - a2 * (at.z * at.z + gap2);
  const MaskOf<T> alive =
      both(at.near, triangle.height > T(0), exponent > T(detail::kLeastExponent));
  if (!any(alive)) return {};
  // Bounds of the exponent's slope and bend along any chord.
  const T& longest = triangle.edge[0].length;
  const T w = T(2) * a2 * longest * sqrt(at.farthest), b = a2 * longest * longest;
  const auto law = [&](const T& u) {
    const T h = detail::bounded_exp(T(log_amplitude - a2 * u));
    return detail::NodeLaw<T>{h, T(-2) * a2 * h};
  };
  const auto nodes = [&](auto order) {
    return TriangleTrial<T>{
        detail::triangle_nodes<decltype(order)::value>(triangle, at.d, T(1), law)};
  };
  FirstOf<T, TriangleTrial<T>> trials(alive);
  trials.take(T(80) * w + T(6400) * b < T(7),
              [&] { return nodes(std::integral_constant<std::size_t, 4>{}); });
  trials.take(T(17.5) * w + T(306) * b < T(12),
              [&] { return nodes(std::integral_constant<std::size_t, 6>{}); });
  const TriangleTrial<T> trial = trials.otherwise(
      [&] { return detail::gaussian_edges(kernel, triangle, at, gap2, trials.left()); });
  const MaskOf<T> again(MaskOf<T>(!trial.good) & (T(7.5) * w + T(56) * b < T(15)));
  if (!any(again)) return trial;
  return select(again, nodes(std::integral_constant<std::size_t, 8>{}), trial);
}

}  // namespace cs2mesh
