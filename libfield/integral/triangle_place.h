// Where a point is as seen from a triangle, and the rule for triangles seen from afar; see the
// triangle forms for what follows from it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "libfield/integral/frames.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh {

/// Of an edge: t the abscissa along it counted from the foot of p on its line, e the distance from
/// p's foot in the plane to that line, > 0 on the inner side.
template <class T>
struct EdgePlace {
  T t1, t2, e;
};

/// Lengths are in units of 1 / scale.
template <class T>
struct TrianglePlace {
  std::array<Vec3<T>, 3> d;  ///< from the vertices to p
  std::array<T, 3> u;        ///< |d|^2
  T z;                       ///< height of p over the plane
  T farthest;                ///< squared distance of the farthest vertex
  std::array<EdgePlace<T>, 3> edge;
  MaskOf<T> over;  ///< p's foot in the plane is on the triangle
  MaskOf<T> near;  ///< coordinates small enough for the arithmetic that follows

  TrianglePlace(const TriangleFrame<T>& triangle, const Vec3<T>& p, const T& scale = T(1))
      : over(true), near(true) {
    using std::abs;
    using std::max;
    for (std::size_t i = 0; i < 3; ++i) {
      d[i] = scale * (p - triangle.vertex[i]);
      u[i] = squared_norm(d[i]);
    }
    // From the nearest vertex: its difference carries the smallest rounding error.
    const auto first = both(u[0] < u[1], u[0] < u[2]);
    z = dot(select(first, d[0], select(u[1] < u[2], d[1], d[2])), triangle.normal);
    farthest = max(max(u[0], u[1]), u[2]);
    near = farthest < T(kFarSquared);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& side = triangle.edge[i];
      const Vec3<T>& from = d[i];
      const Vec3<T>& to = d[(i + 1) % 3];
      EdgePlace<T>& at = edge[i];
      at.t1 = -dot(from, side.along);
      at.t2 = -dot(to, side.along);
      at.e = -dot(select(abs(at.t1) < abs(at.t2), from, to), side.outward);
      over = over & (at.e >= T(0));
    }
  }
};

namespace detail {

/// The angle that the stretch from t1 to t2 of a line at distance e subtends, plus that of the
/// stretch from t3 to t4, t1 <= t2 <= t3 <= t4; with the sign of e.
template <class T>
T angle_of_stretches(const T& e, const T& t1, const T& t2, const T& t3, const T& t4) {
  using std::abs;
  // As complex numbers whose arguments are the angles, of a size whose product is finite.
  const auto direction = [&](const T& from, const T& to, T& x, T& y) {
    x = e * e + from * to;
    y = abs(e) * (to - from);
    const T size = abs(x) + y;
    const auto none = !(size > T(0));
    const T inverse = T(1) / select(none, T(1), size);
    x = select(none, T(1), T(x * inverse));
    y = y * inverse;
  };
  T x1, y1, x2, y2;
  direction(t1, t2, x1, y1);
  direction(t3, t4, x2, y2);
  const T angle = vmath::atan2(T(x1 * y2 + x2 * y1), T(x1 * x2 - y1 * y2));
  return select(e < T(0), T(-angle), angle);
}

/// N x N Gauss-Legendre nodes: along the chords from vertex 0 to the opposite side, and along that
/// side. Every weight is positive and they add up to the area; exact for polynomials of degree
/// 2N - 2. For another function the error is that of the rule on intervals no longer than the
/// longest edge: distances from p to the ends of one add up to twice the distance to the triangle
/// at least (see gauss_legendre.h). law(u) gives {h, slope}, slope = 2 dh/du.
template <std::size_t N, class T, class Law>
JetOf<T> triangle_nodes(const TriangleFrame<T>& triangle, const std::array<Vec3<T>, 3>& d,
                        const T& scale, const Law& law) {
  constexpr const UnitRule<N>& rule = kUnitRule<N>;
  const Vec3<T> to_side = d[1] - d[0], along = d[2] - d[1];
  JetOf<T> sum;
  for (std::size_t j = 0; j < N; ++j) {
    const Vec3<T> chord = to_side + T(rule.node[j]) * along;
    for (std::size_t i = 0; i < N; ++i) {
      const Vec3<T> r = d[0] + T(rule.node[i]) * chord;
      const auto here = law(T(squared_norm(r)));
      const T weight(rule.weight[j] * (rule.weight[i] * rule.node[i]));
      sum.value += weight * here.h;
      sum.gradient += (weight * here.slope) * r;
    }
  }
  const T doubled_area = (scale * triangle.edge[0].length) * (scale * triangle.height);
  return doubled_area * sum;
}

}  // namespace detail
}  // namespace cs2mesh
