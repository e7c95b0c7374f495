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
#include "libfield/integral/line_sum.h"
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

template <class T>
T inner(const Vec3<T>& d, const Vec3d& way) {
  using std::fma;
  return fma(d.x, T(way.x), fma(d.y, T(way.y), T(d.z * T(way.z))));
}

/// D and v of a vertex.
template <class T>
struct SumVertex {
  Vec3<T> d;
  T v;

  SumVertex(const Vec3d& vertex, const T& s, const Vec3<T>& p)
      : d(s * (p.x - T(vertex.x)), s * (p.y - T(vertex.y)), s * (p.z - T(vertex.z))), v([this] {
          using std::fma;
          return fma(d.x, d.x, fma(d.y, d.y, fma(d.z, d.z, T(1))));
        }()) {}
};

/// e, t1 t2, P and its root of an edge.
template <class T>
struct SumEdge {
  T e, product, p, root;

  SumEdge(const Vec3d& along, const Vec3d& outward, const SumVertex<T>& from,
          const SumVertex<T>& to, const T& q) {
    using std::abs;
    using std::fma;
    using std::sqrt;
    const T t1 = inner(from.d, along), t2 = inner(to.d, along);
    product = t1 * t2;
    // From the nearer end: its difference carries the smaller rounding error.
    e = select(abs(t1) < abs(t2), T(-inner(from.d, outward)), T(-inner(to.d, outward)));
    p = fma(e, e, q);
    root = sqrt(p);
  }
};

/// J1 and J2 of an edge, from 1 / P and 1 / (v1 v2).
template <class T>
LineIntegrals<T> edge_integrals(const SumEdge<T>& edge, const T& length, const T& over_p,
                                const T& over_v) {
  return {edge.root,
          over_p,
          T(edge.root * length),
          T(edge.p + edge.product),
          T(1),
          T(length * (edge.p - edge.product) * over_v)};
}

}  // namespace detail

/// The sum of value and gradient at p over the sources[index[i]], i < count. Squares of distances
/// in units of 1 / s must be below 1e36.
template <class T>
JetOf<T> triangle_sum(const TriangleSource* sources, const std::uint32_t* index, std::size_t count,
                      const Vec3<T>& p) {
  using detail::edge_integrals, detail::LineIntegrals, detail::SumEdge, detail::SumVertex;
  using std::fma;
  JetOf<T> sum{};
  for (std::size_t k = 0; k < count; ++k) {
    const TriangleSource& source = sources[index[k]];
    const T s(source.s);
    const SumVertex<T> v0(source.vertex[0], s, p), v1(source.vertex[1], s, p),
        v2(source.vertex[2], s, p);
    const T z = detail::inner(v0.d, source.normal), q = fma(z, z, T(1));
    const SumEdge<T> e0(source.along[0], source.outward[0], v0, v1, q);
    const SumEdge<T> e1(source.along[1], source.outward[1], v1, v2, q);
    const SumEdge<T> e2(source.along[2], source.outward[2], v2, v0, q);

    // All reciprocals by two divisions.
    const T p01 = e0.p * e1.p, p2q = e2.p * q, over_both = T(1) / (p01 * p2q);
    const T over01 = p2q * over_both, over2q = p01 * over_both, over_q = e2.p * over2q;
    const T over_v = T(1) / (v0.v * v1.v * v2.v);
    const LineIntegrals<T> l0 =
        edge_integrals(e0, T(source.length[0]), e1.p * over01, v2.v * over_v);
    const LineIntegrals<T> l1 =
        edge_integrals(e1, T(source.length[1]), e0.p * over01, v0.v * over_v);
    const LineIntegrals<T> l2 = edge_integrals(e2, T(source.length[2]), q * over2q, v1.v * over_v);

    const T value = fma(e0.e, l0.j1, fma(e1.e, l1.j1, T(e2.e * l2.j1)));
    sum.value = fma(T(source.weight) * over_q, value, sum.value);
    const T turned = fma(e0.e, l0.j2, fma(e1.e, l1.j2, T(e2.e * l2.j2)));
    const T slope(-2.0 * source.weight * source.s);
    const T lift = slope * (z * fma(q, turned, value)) * (over_q * over_q);
    const T s0 = slope * l0.j2, s1 = slope * l1.j2, s2 = slope * l2.j2;
    const auto add = [&](T& to, double normal, double o0, double o1, double o2) {
      to = fma(s0, T(o0), fma(s1, T(o1), fma(s2, T(o2), fma(lift, T(normal), to))));
    };
    const auto& o = source.outward;
    add(sum.gradient.x, source.normal.x, o[0].x, o[1].x, o[2].x);
    add(sum.gradient.y, source.normal.y, o[0].y, o[1].y, o[2].y);
    add(sum.gradient.z, source.normal.z, o[0].z, o[1].z, o[2].z);
  }
  return sum;
}

/// Adds triangle_sum() at each of the points; where `Out` is double, the value alone.
template <class Out>
using AddTriangles = void (*)(const TriangleSource* sources, const std::uint32_t* index,
                              std::size_t source_count, const Vec3d* points, Out* sums,
                              std::size_t count);

}  // namespace cs2mesh
