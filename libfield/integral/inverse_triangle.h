// The kernel 1 / r over a flat triangle:
//     f = sum e J - |z| Omega,   grad f = -sum o J - n sign(z) Omega,
//     Omega = sum [atan2(e t, c^2 + |z| r)] from t1 to t2,
// sums over the edges, Omega the solid angle of the triangle. (One arctangent of triple products,
// as Van Oosterom and Strackee 1983 have it, loses thin triangles.)
//
// Legend: z height of p over the plane along the unit normal n; of an edge, o the outward unit
// normal in the plane, e the distance of p's foot from it (> 0 on the inner side), c that of p, t
// the abscissa along it from the foot, t1 and t2 its ends, r the distance to p, J = int dt / r
// along it (inverse_segment.h).
//
// Seen from afar the sums cancel. Gauss-Legendre nodes, all of one sign, take over: 4 x 4, 6 x 6 or
// 8 x 8, whose reach is twice the distance over the longest edge at least, errors (2 reach)^-2N:
// below 1e-17 from reach 300, 16 and 6.5 on with room for the gradient's poles of third order. The
// rest that cancels, as thin triangles seen from their own distance do, goes to quadrature, as do
// points within the kernel's clamp (or 1e-13 of the size) of the triangle, where the value at that
// distance is used with gradient 0.
// Value and gradient are within a few ulp of the exact result for inputs moved by a few ulp. Finite
// for every finite p.
#pragma once

#include <algorithm>
#include <cmath>

#include "libfield/base/jet.h"
#include "libfield/integral/inverse_segment.h"
#include "libfield/integral/triangle_place.h"
#include "libfield/integral/triangle_trial.h"
#include "libfield/kernel/inverse.h"

namespace cs2mesh {
namespace detail {

/// h and 2 dh/du.
template <class T>
struct NodeLaw {
  T h, slope;
};
template <class T>
NodeLaw<T> node_law(const Inverse&, const T& u) {
  using std::sqrt;
  const T w = T(1) / sqrt(u);
  return {w, -w * (w * w)};
}
template <class T>
NodeLaw<T> node_law(const Squared&, const T& u) {
  const T w = T(1) / u;
  return {w, T(-2) * (w * w)};
}

inline constexpr double kReach6 = 16.0;

/// Of the triangle as a place: lengths that tell which formula to use.
template <class T>
struct TriangleDistance {
  T least;     ///< p is at least that far away
  T farthest;  ///< distance of the farthest vertex

  TriangleDistance(const TriangleFrame<T>& triangle, const TrianglePlace<T>& at) {
    using std::abs;
    using std::max;
    using std::sqrt;
    farthest = sqrt(at.farthest);
    least = max(abs(at.z), T(farthest - triangle.edge[0].length));
  }
  MaskOf<T> beyond(double reach, const TriangleFrame<T>& triangle) const {
    return T(2) * least > T(reach) * triangle.edge[0].length;
  }
};

/// Whether p may be so close to the triangle that the kernel is cut off.
template <class K, class T>
MaskOf<T> may_be_clamped(const K& kernel, const TriangleFrame<T>& triangle,
                         const TrianglePlace<T>& at) {
  using std::abs;
  using std::max;
  const T least = T(1.0 + 1e-12) * max(T(kernel.clamp), T(1e-13) * triangle.edge[0].length);
  MaskOf<T> close(abs(at.z) <= least);
  for (const EdgePlace<T>& edge : at.edge) close = close & (edge.e >= -least);
  return close;
}

/// The integrals of the kernel along the edges.
template <class K, class T>
std::array<T, 3> inverse_lines(const K& kernel, const TriangleFrame<T>& triangle,
                               const TrianglePlace<T>& at, const std::array<T, 3>& r) {
  std::array<T, 3> lines;
  for (std::size_t i = 0; i < 3; ++i) {
    const EdgePlace<T>& edge = at.edge[i];
    const InversePlace<T> place{
        edge.t1, edge.t2,       triangle.edge[i].length, edge.e * edge.e + at.z * at.z,
        r[i],    r[(i + 1) % 3]};
    lines[i] = inverse_line(kernel, place).value;
  }
  return lines;
}

/// [atan2(e t, c^2 + |z| r)] from t1 to t2, which an edge adds to the solid angle, as one angle; r1
/// and r2 not 0.
template <class T>
T solid_angle(const EdgePlace<T>& at, const T& length, const T& z, const T& r1, const T& r2) {
  using std::abs;
  const T up = abs(z), c2 = at.e * at.e + z * z;
  const T w1 = T(1) / r1, w2 = T(1) / r2;
  const T x1 = (c2 * w1 + up) * w1, x2 = (c2 * w2 + up) * w2;
  const T y1 = at.e * w1 * (at.t1 * w1), y2 = at.e * w2 * (at.t2 * w2);
  // r1 t2 - r2 t1 without a difference.
  const T far = abs(at.t2) * r1 + abs(at.t1) * r2;
  const auto between = MaskOf<T>((at.t1 > T(0)) ^ (at.t2 > T(0)));
  const T turn = select(between, far, T(c2 * (length * abs(at.t1 + at.t2)) / far));
  const T sine = at.e * (w1 * w2) * ((c2 * length + up * turn) * (w1 * w2));
  return vmath::atan2(sine, T(x1 * x2 + y1 * y2));
}

template <class T>
TriangleTrial<T> inverse_edges(const Inverse& kernel, const TriangleFrame<T>& triangle,
                               const TrianglePlace<T>& at, const TriangleDistance<T>& distance) {
  using std::abs;
  using std::copysign;
  using std::sqrt;
  const std::array<T, 3> r{sqrt(at.u[0]), sqrt(at.u[1]), sqrt(at.u[2])};
  const std::array<T, 3> lines = inverse_lines(kernel, triangle, at, r);
  TriangleTrial<T> trial;
  EdgeSizes<T> size;
  T omega(0);
  for (std::size_t i = 0; i < 3; ++i) {
    const T& length = triangle.edge[i].length;
    const T angle = solid_angle(at.edge[i], length, at.z, r[i], r[(i + 1) % 3]);
    const T term = at.edge[i].e * lines[i] - abs(at.z) * angle;
    omega += angle;
    trial.jet.value += term;
    trial.jet.gradient -= lines[i] * triangle.edge[i].outward;
    size.value += abs(term);
    size.gradient += lines[i] + abs(angle);
  }
  trial.jet.gradient -= copysign(omega, at.z) * triangle.normal;
  const T bend = trial.jet.value / at.farthest;
  trial.good = sums_hold(trial.jet, size, bend, distance.farthest);
  return trial;
}

/// Nodes from afar, else edges(lanes), else nodes again; amplitude 1.
template <class K, class T, class Edges>
TriangleTrial<T> afar_or(const K& kernel, const TriangleFrame<T>& triangle,
                         const TrianglePlace<T>& at, const TriangleDistance<T>& distance,
                         const Edges& edges) {
  const auto law_of = [&](const T& u) { return node_law(kernel, u); };
  FirstOf<T, TriangleTrial<T>> trials;
  const bool done = trials.take(distance.beyond(kReach4, triangle), [&] {
    return TriangleTrial<T>{triangle_nodes<4>(triangle, at.d, T(1), law_of)};
  }) || trials.take(distance.beyond(kReach6, triangle), [&] {
    return TriangleTrial<T>{triangle_nodes<6>(triangle, at.d, T(1), law_of)};
  });
  if (done) return trials.result();
  const TriangleTrial<T> trial = trials.otherwise([&] { return edges(trials.left()); });
  const MaskOf<T> again(MaskOf<T>(!trial.good) & distance.beyond(kReach8, triangle));
  if (!any(again)) return trial;
  return select(again, TriangleTrial<T>{triangle_nodes<8>(triangle, at.d, T(1), law_of)}, trial);
}

}  // namespace detail

/// The integral, and where it keeps its digits.
template <class T>
TriangleTrial<T> triangle_trial(const Inverse& kernel, const TriangleFrame<T>& triangle,
                                const Vec3<T>& point) {
  const TrianglePlace<T> at(triangle, point);
  const MaskOf<T> near(at.near & (triangle.height > T(0)));
  if (!any(near)) return {};
  const detail::TriangleDistance<T> distance(triangle, at);
  TriangleTrial<T> trial = detail::afar_or(kernel, triangle, at, distance, [&](const MaskOf<T>&) {
    return detail::inverse_edges(kernel, triangle, at, distance);
  });
  trial.good =
      MaskOf<T>(!near) | (trial.good & MaskOf<T>(!detail::may_be_clamped(kernel, triangle, at)));
  trial.jet = select(near, T(kernel.amplitude) * trial.jet, JetOf<T>{});
  return trial;
}

}  // namespace cs2mesh
