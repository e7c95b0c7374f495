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
// others at +-i e as well: panels of 14 nodes whose ends' distances to them add up to 2.2 lengths
// (gauss_legendre.h) err by 5e-18 of them; they halve towards the foot, so about 2 log2(length /
// distance) of them do. Far away and where the edges cancel: as in inverse_triangle.h.
// Value and gradient are within a few ulp of the exact result for inputs moved by a few ulp. Finite
// for every finite p.
#pragma once

#include <algorithm>
#include <cmath>

#include "libfield/base/jet.h"
#include "libfield/integral/inverse_triangle.h"
#include "libfield/integral/panel.h"
#include "libfield/kernel/squared.h"

namespace cs2mesh {
namespace detail {

/// Calls take(t, weight) at the nodes of panels along an edge, each at least kReach14 lengths from
/// t = +-i gap.
template <class Take>
void visit_edge(const EdgePlace<double>& at, double length, double squared_gap, const Take& take) {
  // From the foot on where offsets must keep their digits next to it, else in one piece.
  Pieces pieces = pieces_of(at.t1, at.t2, length);
  if (squared_gap > 0.01 * (length * length)) pieces = {{Piece{at.t1, length, 1.0}}, 1};
  for (std::size_t i = 0; i < pieces.count; ++i) {
    const Piece& piece = pieces.piece[i];
    const auto decide = [&](double o, double panel) {
      const double a = piece.start + o, b = a + panel;
      const double sum = std::sqrt(a * a + squared_gap) + std::sqrt(b * b + squared_gap);
      return sum >= kReach14 * panel ? Panel::take : Panel::split;
    };
    visit_panels(0.0, piece.length, decide, [&](double o, double panel) {
      constexpr const UnitRule<14>& rule = kUnitRule<14>;
      for (std::size_t j = 0; j < 14; ++j) {
        take(piece.start + (o + rule.node[j] * panel), rule.weight[j] * panel);
      }
    });
  }
}

/// int log(1 + q / z^2) / q dt.
inline double squared_over(const EdgePlace<double>& at, double length, double z2) {
  const double e2 = at.e * at.e, inverse = 1.0 / z2;
  double sum = 0.0;
  visit_edge(at, length, e2 + z2, [&](double t, double weight) {
    // log(w) / (w - 1) for the w that rounding makes of 1 + x is that for x to rounding.
    const double w = 1.0 + (e2 + t * t) * inverse;
    sum += weight * (w > 1.0 ? vmath::log(w) / (w - 1.0) : 1.0);
  });
  return inverse * sum;
}

/// int log(r^2 / r0^2) / q dt and int dt / (q r^2).
struct SquaredBeside {
  double value = 0.0, normal = 0.0;
};
inline SquaredBeside squared_beside(const EdgePlace<double>& at, double length, double z2,
                                    double inverse_u0) {
  const double e2 = at.e * at.e;
  SquaredBeside sum;
  visit_edge(at, length, e2, [&](double t, double weight) {
    const double q = e2 + t * t, u = q + z2;
    const double part = weight / q;
    sum.value += part * vmath::log(u * inverse_u0);
    sum.normal += part / u;
  });
  return sum;
}

/// Squared distance in the plane from p's foot to the triangle.
inline double squared_plane_gap(const TrianglePlace<double>& at) {
  double least = at.over ? 0.0 : HUGE_VAL;
  for (const EdgePlace<double>& edge : at.edge) {
    const double beyond = std::max({0.0, edge.t1, -edge.t2});
    least = std::min(least, edge.e * edge.e + beyond * beyond);
  }
  return least;
}

inline TriangleTrial<double> squared_edges(const Squared& kernel,
                                           const TriangleFrame<double>& triangle,
                                           const TrianglePlace<double>& at,
                                           const TriangleDistance<double>& distance) {
  const double z2 = at.z * at.z, gap2 = squared_plane_gap(at);
  const std::array<double, 3> r{std::sqrt(at.u[0]), std::sqrt(at.u[1]), std::sqrt(at.u[2])};
  const std::array<double, 3> lines = inverse_lines(kernel, triangle, at, r);
  const bool beside = 4.0 * z2 < gap2;
  TriangleTrial<double> trial;
  EdgeSizes<double> size;
  double normal = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const EdgePlace<double>& edge = at.edge[i];
    const double length = triangle.edge[i].length;
    double value = 0.0, rise = 0.0;
    if (edge.e == 0.0) {
      // Nothing: p's foot sees the edge under no angle.
    } else if (beside) {
      const SquaredBeside sum = squared_beside(edge, length, z2, 1.0 / (gap2 + z2));
      value = 0.5 * edge.e * sum.value;
      rise = at.z * edge.e * sum.normal;
    } else {
      value = 0.5 * edge.e * squared_over(edge, length, z2);
      rise = -edge.e * lines[i] / at.z;
    }
    trial.jet.value += value;
    normal += rise;
    trial.jet.gradient -= lines[i] * triangle.edge[i].outward;
    size.value += std::abs(value);
    size.gradient += lines[i] + std::abs(rise);
  }
  trial.jet.gradient += normal * triangle.normal;
  trial.good = sums_hold(trial.jet, size, trial.jet.value / at.farthest, distance.farthest);
  return trial;
}

}  // namespace detail

/// The integral, and where it keeps its digits.
inline TriangleTrial<double> triangle_trial(const Squared& kernel,
                                            const TriangleFrame<double>& triangle,
                                            const Vec3d& point) {
  const TrianglePlace<double> at(triangle, point);
  if (!at.near || !(triangle.height > 0.0)) return {};
  if (detail::may_be_clamped(kernel, triangle, at)) return {{}, false};
  const detail::TriangleDistance<double> distance(triangle, at);
  TriangleTrial<double> trial = detail::afar_or(kernel, triangle, at, distance, [&] {
    return detail::squared_edges(kernel, triangle, at, distance);
  });
  trial.jet = kernel.amplitude * trial.jet;
  return trial;
}

}  // namespace cs2mesh
