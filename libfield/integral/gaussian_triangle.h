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
//    q < 40, theta is the rest.
//  - Farther out the second, over what lies within exp(-41) of the field's greatest value; panels
//    keep 2.2 times their length from the poles t = +-i e (gauss_legendre.h).
//    As a panel is no longer than 2 / a and the exponent changes by 8 along it at most, 14 nodes
//    err by 1e-18 (quadrature.h): some 5 panels a side of the foot at most in either.
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

/// Whether 14 nodes suffice for exp(-a^2 t^2) on [t, t + length].
inline bool smooth_gaussian(double a, double t, double length) {
  const double change = a * a * length * std::abs(2.0 * t + length);
  return a * length <= kGaussianSpan && change <= kGaussianChange;
}

template <class Decide, class Integrand>
double edge_integral(const Piece& piece, const Decide& decide, const Integrand& integrand) {
  double sum = 0.0;
  visit_panels(0.0, piece.length, decide, [&](double o, double panel) {
    constexpr const UnitRule<14>& rule = kUnitRule<14>;
    double part = 0.0;
    for (std::size_t j = 0; j < 14; ++j) {
      part += rule.weight[j] * integrand(piece.start + (o + rule.node[j] * panel));
    }
    sum += panel * part;
  });
  return sum;
}

/// e int (1 - exp(-a^2 q)) / q dt.
inline double gaussian_near(double a, const EdgePlace<double>& at, double length) {
  const double a2 = a * a, e2 = at.e * at.e;
  const double tau = std::sqrt(std::max(0.0, kNearEnd / a2 - e2));
  const double from = std::min(std::max(-tau, at.t1), at.t2);
  const double to = std::max(std::min(tau, at.t2), at.t1);
  const bool whole = at.t1 >= -tau && at.t2 <= tau;
  const double theta = whole ? 0.0 : angle_of_stretches(at.e, at.t1, from, to, at.t2);
  const Piece piece{from, whole ? length : to - from, 1.0};
  if (!(piece.length > 0.0)) return theta;
  const double sum = edge_integral(
      piece,
      [&](double o, double panel) {
        return smooth_gaussian(a, piece.start + o, panel) ? Panel::take : Panel::split;
      },
      [&](double t) {
        const double x = a2 * (e2 + t * t);
        return x > 0.0 ? -vmath::expm1(-x) / x : 1.0;
      });
  return at.e * a2 * sum + theta;
}

/// -e int exp(-(a^2 q - x0)) / q dt, where x0 <= a^2 q on the whole triangle.
inline double gaussian_beside(double a, const EdgePlace<double>& at, double length, double x0) {
  const double a2 = a * a, e2 = at.e * at.e;
  const Pieces pieces = pieces_of(at.t1, at.t2, length);
  double sum = 0.0;
  for (std::size_t i = 0; i < pieces.count; ++i) {
    const Piece& piece = pieces.piece[i];
    sum += edge_integral(
        piece,
        [&](double o, double panel) {
          const double t = piece.start + o, end = t + panel;
          if (a2 * (e2 + t * t) - x0 > kGaussianEnd) return Panel::skip;
          const double poles = std::sqrt(e2 + t * t) + std::sqrt(e2 + end * end);
          const bool clear = poles >= kReach14 * panel && smooth_gaussian(a, t, panel);
          return clear ? Panel::take : Panel::split;
        },
        [&](double t) {
          const double q = e2 + t * t;
          return vmath::exp(x0 - a2 * q) / q;
        });
  }
  return -at.e * sum;
}

inline TriangleTrial<double> gaussian_edges(const Gaussian& kernel,
                                            const TriangleFrame<double>& triangle,
                                            const TrianglePlace<double>& at, double gap2) {
  const double a = kernel.a, a2 = a * a, z2 = at.z * at.z;
  const bool near = a2 * gap2 < 1.0;
  const double x0 = near ? 0.0 : a2 * gap2;
  const double scale = bounded_exp(kernel.log_amplitude - a2 * z2 - x0) * (0.5 / a2);
  TriangleTrial<double> trial;
  EdgeSizes<double> size;
  for (std::size_t i = 0; i < 3; ++i) {
    const EdgePlace<double>& edge = at.edge[i];
    const double length = triangle.edge[i].length;
    const double term = edge.e == 0.0 ? 0.0
                                      : scale * (near ? gaussian_near(a, edge, length)
                                                      : gaussian_beside(a, edge, length, x0));
    const double line = gaussian_line(kernel, edge.t1, edge.t2, length, edge.e * edge.e + z2).value;
    trial.jet.value += term;
    trial.jet.gradient -= line * triangle.edge[i].outward;
    size.value += std::abs(term);
    size.gradient += line;
  }
  trial.jet.gradient -= (2.0 * a2 * at.z * trial.jet.value) * triangle.normal;
  trial.good = sums_hold(trial.jet, size, 2.0 * a2 * trial.jet.value, std::sqrt(at.farthest));
  return trial;
}

}  // namespace detail

/// The integral, and where it keeps its digits.
inline TriangleTrial<double> triangle_trial(const Gaussian& kernel,
                                            const TriangleFrame<double>& triangle,
                                            const Vec3d& point) {
  const TrianglePlace<double> at(triangle, point);
  if (!at.near || !(triangle.height > 0.0)) return {};
  const double a2 = kernel.a * kernel.a, gap2 = detail::squared_plane_gap(at);
  if (!(kernel.log_amplitude - a2 * (at.z * at.z + gap2) > detail::kLeastExponent)) return {};
  // Bounds of the exponent's slope and bend along any chord.
  const double longest = triangle.edge[0].length;
  const double w = 2.0 * a2 * longest * std::sqrt(at.farthest), b = a2 * longest * longest;
  const auto law = [&](double u) {
    const double h = detail::bounded_exp(kernel.log_amplitude - a2 * u);
    return detail::NodeLaw<double>{h, -2.0 * a2 * h};
  };
  const auto nodes = [&](auto order) {
    return TriangleTrial<double>{
        detail::triangle_nodes<decltype(order)::value>(triangle, at.d, 1.0, law), true};
  };
  if (80.0 * w + 6400.0 * b < 7.0) return nodes(std::integral_constant<std::size_t, 4>{});
  if (17.5 * w + 306.0 * b < 12.0) return nodes(std::integral_constant<std::size_t, 6>{});
  const TriangleTrial<double> trial = detail::gaussian_edges(kernel, triangle, at, gap2);
  if (trial.good || 7.5 * w + 56.0 * b >= 15.0) return trial;
  return nodes(std::integral_constant<std::size_t, 8>{});
}

}  // namespace cs2mesh
