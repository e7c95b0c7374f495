// The Cauchy kernel over many triangles at many places, to a small part of the kernel's strength:
// the closed form of cauchy_triangle.h alone, which is never judged nor replaced. Each lane of a
// pack holds one place and runs through the triangles in their order.
//
// In units of 1 / s, with D = s (p - vertex), and of an edge the abscissae t1, t2 of its ends,
// counted from the foot of p on its line, L its length, e the distance of the foot of p in the
// plane from it (> 0 on the inner side), z the height of p, Q = 1 + z^2, P = Q + e^2, v = 1 +
// |D|^2:
//     J1 = atan2(sqrt(P) L, P + t1 t2) / sqrt(P),   J2 = (J1 + L (P - t1 t2) / (v1 v2)) / (2 P),
//     f = A / (2 s^2 Q) sum e J1,   grad f = -A / s (sum o J2 + n z / Q^2 sum e (J1 + Q J2)).
//
// |e| J1 <= pi, so that what rounding does to f, beside what it does to the vertices, stays below
// triangle_rounding(), however much the sums cancel, and to the gradient below some ten times s of
// that. The field of a plane at its foot is pi A / s^2: where sums of fields are of the order of T,
// that is a few ulp of them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "libfield/base/jet.h"
#include "libfield/integral/frames.h"
#include "libfield/kernel/cauchy.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh {

struct TriangleSource {
  std::array<Vec3d, 3> vertex, along, outward;  ///< as in TriangleFrame
  std::array<double, 3> length;                 ///< in units of 1 / s
  Vec3d normal;
  double s = 1.0;
  double weight = 0.0;  ///< A / (2 s^2), signed
};

/// Of a triangle of some area.
inline TriangleSource triangle_source(const Cauchy& kernel, const TriangleFrame<double>& frame,
                                      double sign) {
  TriangleSource source;
  for (std::size_t i = 0; i < 3; ++i) {
    source.vertex[i] = frame.vertex[i];
    source.along[i] = frame.edge[i].along;
    source.outward[i] = frame.edge[i].outward;
    source.length[i] = kernel.s * frame.edge[i].length;
  }
  source.normal = frame.normal;
  source.s = kernel.s;
  source.weight = 0.5 * sign * kernel.amplitude / (kernel.s * kernel.s);
  return source;
}

/// What rounding leaves open of the field of one triangle, but for that of places and vertices.
inline double triangle_rounding(const Cauchy& kernel) {
  constexpr double kUlps = 128;
  return kUlps * std::numeric_limits<double>::epsilon() * kernel.amplitude / (kernel.s * kernel.s);
}

namespace detail {

/// 1 / x, of all by one division; their product must be finite.
template <class T, std::size_t N>
std::array<T, N> reciprocals(const std::array<T, N>& x) {
  std::array<T, N> before{}, inverse{};
  before[0] = T(1);
  for (std::size_t i = 1; i < N; ++i) before[i] = before[i - 1] * x[i - 1];
  T rest = T(1) / (before[N - 1] * x[N - 1]);
  for (std::size_t i = N; i-- > 0;) {
    inverse[i] = before[i] * rest;
    rest = rest * x[i];
  }
  return inverse;
}

}  // namespace detail

/// The sum of value and gradient at p over the sources[index[i]], i < count. Squares of distances
/// in units of 1 / s must be below 1e36.
template <class T>
JetOf<T> triangle_sum(const TriangleSource* sources, const std::uint32_t* index, std::size_t count,
                      const Vec3<T>& p) {
  using std::abs;
  using std::fma;
  using std::sqrt;
  JetOf<T> sum{};
  for (std::size_t k = 0; k < count; ++k) {
    const TriangleSource& source = sources[index[k]];
    const T s(source.s);
    const auto along = [](const Vec3<T>& d, const Vec3d& way) {
      return fma(d.x, T(way.x), fma(d.y, T(way.y), T(d.z * T(way.z))));
    };
    std::array<Vec3<T>, 3> d;
    std::array<T, 3> v, e, product, root;
    std::array<T, 4> big;  // P of the edges, Q
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d& vertex = source.vertex[i];
      d[i] = {s * (p.x - T(vertex.x)), s * (p.y - T(vertex.y)), s * (p.z - T(vertex.z))};
      v[i] = fma(d[i].x, d[i].x, fma(d[i].y, d[i].y, fma(d[i].z, d[i].z, T(1))));
    }
    const T z = along(d[0], source.normal);
    big[3] = fma(z, z, T(1));
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t next = (i + 1) % 3;
      const T t1 = -along(d[i], source.along[i]), t2 = -along(d[next], source.along[i]);
      // From the nearer end: its difference carries the smaller rounding error.
      e[i] = select(abs(t1) < abs(t2), T(-along(d[i], source.outward[i])),
                    T(-along(d[next], source.outward[i])));
      product[i] = t1 * t2;
      big[i] = fma(e[i], e[i], big[3]);
      root[i] = sqrt(big[i]);
    }
    const std::array<T, 4> over = detail::reciprocals(big);
    const std::array<T, 3> w = detail::reciprocals(v);
    T value(0), normal(0);
    Vec3<T> inward{};
    for (std::size_t i = 0; i < 3; ++i) {
      const T length(source.length[i]);
      const T angle = vmath::atan2(T(root[i] * length), T(big[i] + product[i]));
      const T j1 = angle * (root[i] * over[i]);
      const T j2 =
          fma(length * (big[i] - product[i]), w[i] * w[(i + 1) % 3], j1) * (T(0.5) * over[i]);
      value = fma(e[i], j1, value);
      normal = fma(e[i], fma(big[3], j2, j1), normal);
      const Vec3d& out = source.outward[i];
      inward.x = fma(j2, T(-out.x), inward.x);
      inward.y = fma(j2, T(-out.y), inward.y);
      inward.z = fma(j2, T(-out.z), inward.z);
    }
    sum.value = fma(T(source.weight) * over[3], value, sum.value);
    const T slope = T(2.0 * source.weight * source.s);
    const T lift = -slope * (z * normal) * (over[3] * over[3]);
    sum.gradient.x = fma(slope, inward.x, fma(lift, T(source.normal.x), sum.gradient.x));
    sum.gradient.y = fma(slope, inward.y, fma(lift, T(source.normal.y), sum.gradient.y));
    sum.gradient.z = fma(slope, inward.z, fma(lift, T(source.normal.z), sum.gradient.z));
  }
  return sum;
}

/// Adds triangle_sum() at each of the points; where `Out` is double, the value alone.
template <class Out>
using AddTriangles = void (*)(const TriangleSource* sources, const std::uint32_t* index,
                              std::size_t source_count, const Vec3d* points, Out* sums,
                              std::size_t count);

}  // namespace cs2mesh
