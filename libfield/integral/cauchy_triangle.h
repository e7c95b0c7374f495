// The Cauchy kernel over a flat triangle:
//     f(p) = A / (2 Q) sum e J1,
//     grad f = -A sum o J2 - n A (s^2 z / Q^2) sum e (J1 + Q J2),
// sums over the edges, Q = 1 + s^2 z^2. (Any triangle, no split at the longest edge; thesis
// equation 2.23 is the value with another prefactor, right for s = 1 only.)
//
// Legend: z height of p over the plane along the unit normal n; of an edge, o the outward unit
// normal in the plane, e = -(p - vertex) . o the distance of p's foot from it (> 0 on the inner
// side), Jk = int (1 + s^2 r^2)^-k along it (cauchy_segment.h).
//
// The sums cancel where the kernel is wide against the triangle or the foot far outside of it.
// There a tensor rule takes over, whose terms are all positive: Gauss-Legendre along the longest
// edge (split at the apex, panels graded towards p by the distances to the complex poles) of the
// integral across the height, a segment in closed form. The tests for it bound the cancellation
// against what rounding the inputs alone does to the result.
// Value and gradient are within a few ulp of the exact result for inputs moved by a few ulp, times
// (longest edge) / (smallest height) in slivers. Finite for every finite p.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "libfield/base/jet.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/frames.h"
#include "libfield/integral/triangle_trial.h"
#include "libfield/kernel/cauchy.h"

namespace cs2mesh {
namespace detail {

/// One of the two right triangles at the base: legs `length` along the base, from its outer corner
/// at abscissa 0, and `height`; p at (x, y) in its plane and z over it.
struct RightTriangle {
  double length, height;
  double x, y, z;
};

/// The integral over abscissae lo to hi (unit kernel), its gradient along (abscissa, height,
/// normal).
template <int N>
JetOf<double> cauchy_panel(double s, const RightTriangle& part, double lo, double hi) {
  constexpr const UnitRule<N>& rule = kUnitRule<N>;
  const double slope = part.height / part.length;
  const double s2 = s * s;
  JetOf<double> sum;
  for (std::size_t i = 0; i < N; ++i) {
    const double abscissa = lo + (hi - lo) * rule.node[i];
    const double width = slope * abscissa;
    const double dx = part.x - abscissa;
    const CauchyLine<double> line =
        cauchy_line(s, -part.y, width - part.y, width, dx * dx + part.z * part.z);
    const double radial = -4.0 * s2 * line.j3;
    sum += rule.weight[i] * JetOf<double>{line.j2, Vec3d{radial * dx, line.drop, radial * part.z}};
  }
  return (hi - lo) * sum;
}

/// The abscissae about which panels are graded: p's foot on the base, and on the slanted side.
struct PanelGrade {
  std::array<double, 2> center, squared_gap;

  PanelGrade(double s, const RightTriangle& part) {
    const double off_plane = 1.0 / (s * s) + part.z * part.z;
    const double beyond = std::max({0.0, -part.y, part.y - part.height});
    center[0] = part.x;
    squared_gap[0] = off_plane + beyond * beyond;
    const double side = std::sqrt(part.length * part.length + part.height * part.height);
    const double cosine = part.length / side, sine = part.height / side;
    const double across = part.y * cosine - part.x * sine;
    center[1] = (part.x * cosine + part.y * sine) * cosine;
    squared_gap[1] = cosine * cosine * (off_plane + across * across);
  }

  /// The smaller of the sums of distances from the ends of [lo, hi] to the poles, over its length.
  double reach(double lo, double hi) const {
    std::array<double, 2> sum;
    for (std::size_t k = 0; k < 2; ++k) {
      const double before = lo - center[k], after = hi - center[k];
      sum[k] =
          std::sqrt(before * before + squared_gap[k]) + std::sqrt(after * after + squared_gap[k]);
    }
    return std::min(sum[0], sum[1]) / (hi - lo);
  }
};

inline JetOf<double> cauchy_right_triangle(double s, const RightTriangle& part) {
  JetOf<double> sum;
  if (!(part.length > 0.0)) return sum;
  const PanelGrade grade(s, part);
  double lo = 0.0;
  while (lo < part.length) {
    double hi = part.length;
    double reach = grade.reach(lo, hi);
    // Panels below rounding of the length cannot matter.
    while (reach < kReach14 && hi - lo > 1e-15 * part.length) {
      hi = lo + 0.5 * (hi - lo);
      reach = grade.reach(lo, hi);
    }
    if (reach > kReach4) {
      sum += cauchy_panel<4>(s, part, lo, hi);
    } else if (reach > kReach8) {
      sum += cauchy_panel<8>(s, part, lo, hi);
    } else {
      sum += cauchy_panel<14>(s, part, lo, hi);
    }
    lo = hi;
  }
  return sum;
}

/// The tensor rule.
inline JetOf<double> cauchy_triangle_tensor(double s, const TriangleFrame<double>& triangle,
                                            const Vec3d& point, double z) {
  const Vec3d& along = triangle.edge[0].along;
  const Vec3d up = -triangle.edge[0].outward;
  const Vec3d da = point - triangle.vertex[0];
  const Vec3d db = point - triangle.vertex[1];
  const double y = dot(da, up);
  const double base = triangle.edge[0].length;
  // The right part runs from the other end of the base, mirrored.
  const Jet left = cauchy_right_triangle(s, {triangle.foot, triangle.height, dot(da, along), y, z});
  const Jet right =
      cauchy_right_triangle(s, {base - triangle.foot, triangle.height, -dot(db, along), y, z});
  return {left.value + right.value, (left.gradient.x - right.gradient.x) * along +
                                        (left.gradient.y + right.gradient.y) * up +
                                        (left.gradient.z + right.gradient.z) * triangle.normal};
}

/// The sums over the edges with what they are made of, to judge cancellation.
template <class T>
struct TriangleSums {
  T value{}, value_size{};    ///< sum e J1 and sum |e J1|
  T normal{}, normal_size{};  ///< sum e (J1 + Q J2) and sum |...|
  Vec3<T> inward{};           ///< -sum o J2
  T inward_size{};            ///< sum J2
};

/// An edge as seen from p: e and the integrals along it.
template <class T>
struct EdgeView {
  T e;
  CauchyLine<T> line;

  /// d from the vertices to p, z the height of p.
  EdgeView(const T& s, const TriangleFrame<T>& triangle, const std::array<Vec3<T>, 3>& d,
           const T& z, std::size_t i) {
    using std::abs;
    const auto& edge = triangle.edge[i];
    const T t1 = -dot(d[i], edge.along);
    const T t2 = -dot(d[(i + 1) % 3], edge.along);
    e = -dot(select(abs(t1) < abs(t2), d[i], d[(i + 1) % 3]), edge.outward);
    line = cauchy_line(s, t1, t2, edge.length, T(e * e + z * z));
  }
};

template <class T>
TriangleSums<T> cauchy_edges(const T& s, const TriangleFrame<T>& triangle,
                             const std::array<Vec3<T>, 3>& d, const T& z) {
  using std::abs;
  const T big_q = T(1) + s * s * (z * z);
  TriangleSums<T> sums;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& edge = triangle.edge[i];
    const auto [e, line] = EdgeView<T>(s, triangle, d, z, i);
    const T value = e * line.j1;
    const T normal = value + e * (big_q * line.j2);
    sums.value += value;
    sums.value_size += abs(value);
    sums.normal += normal;
    sums.normal_size += abs(normal);
    sums.inward -= line.j2 * edge.outward;
    sums.inward_size += line.j2;
  }
  return sums;
}

/// Whether rounding errors of sums whose terms add up to `value_size` and `gradient_size` in
/// absolute value stay below a few times those that rounding the inputs makes,
/// eps (|f| + |grad f| l) and eps (|grad f| + |Hessian| l), l the distance of the farthest vertex.
/// The greater of 4 s^2 f / (1 + s^2 l^2) and |grad f|^2 / f stands for the Hessian, which neither
/// exceeds by much. (A value that cancellation made negative fails.)
template <class T>
MaskOf<T> well_conditioned(const JetOf<T>& jet, const T& value_size, const T& gradient_size,
                           const T& s2, const T& squared_scale) {
  using std::max;
  using std::sqrt;
  const T growth(4.0);
  const T slope = sqrt(squared_norm(jet.gradient));
  const T scale = sqrt(squared_scale);
  const T curvature =
      max(T(T(4) * s2 * jet.value / (T(1) + s2 * squared_scale)), T(slope * (slope / jet.value)));
  return (jet.value > T(0)) & (value_size < growth * (jet.value + slope * scale)) &
         (gradient_size < growth * (slope + curvature * scale));
}

/// The shortest of the three: its difference carries the smallest rounding error.
template <class T>
Vec3<T> nearest_of(const std::array<Vec3<T>, 3>& d) {
  const T u0 = squared_norm(d[0]), u1 = squared_norm(d[1]), u2 = squared_norm(d[2]);
  return select(both(u0 < u1, u0 < u2), d[0], select(u1 < u2, d[1], d[2]));
}

/// The closed form, and where it keeps its digits.
template <class T>
struct CauchyTrial {
  JetOf<T> jet;  ///< of the unit kernel; 0 too far away
  MaskOf<T> good;
  T z;  ///< height of p over the plane
};

template <class T>
CauchyTrial<T> cauchy_triangle_closed(const T& s, const TriangleFrame<T>& triangle,
                                      const Vec3<T>& point) {
  using std::abs;
  using std::max;
  std::array<Vec3<T>, 3> d;
  std::array<T, 3> u;
  for (std::size_t i = 0; i < 3; ++i) {
    d[i] = point - triangle.vertex[i];
    u[i] = squared_norm(d[i]);
  }
  const T z = dot(nearest_of(d), triangle.normal);
  const T s2 = s * s;
  const T big_q = T(1) + s2 * (z * z);
  const TriangleSums<T> sums = cauchy_edges(s, triangle, d, z);
  const T half = T(0.5) / big_q;
  const T lift = -s2 * z * (T(4) * half * half);
  const JetOf<T> jet{half * sums.value, sums.inward + (lift * sums.normal) * triangle.normal};
  const auto near = u[0] < T(kFarSquared);
  MaskOf<T> good(true);
  if constexpr (kIsDouble<T>) {
    const T gradient_size = sums.inward_size + abs(lift) * sums.normal_size;
    // Hopeless from the outset: wide or high above.
    good = (big_q <= T(4) * s2 * (triangle.height * triangle.height)) &
           well_conditioned(jet, T(half * sums.value_size), gradient_size, s2,
                            T(max(max(u[0], u[1]), u[2])));
    good = good | !MaskOf<T>(near);
  }
  return {select(near, jet, JetOf<T>{}), good, z};
}

template <class T>
JetOf<T> unit_cauchy_triangle(const T& s, const TriangleFrame<T>& triangle, const Vec3<T>& point) {
  if (!(triangle.height > T(0))) return {};
  const CauchyTrial<T> trial = cauchy_triangle_closed(s, triangle, point);
  if constexpr (kIsDouble<T>) {
    if (!trial.good) return cauchy_triangle_tensor(s, triangle, point, trial.z);
  }
  return trial.jet;
}

}  // namespace detail

/// The closed form, and where it keeps its digits.
template <class T>
TriangleTrial<T> triangle_trial(const Cauchy& kernel, const TriangleFrame<T>& triangle,
                                const Vec3<T>& point) {
  const auto trial = detail::cauchy_triangle_closed(T(kernel.s), triangle, point);
  return {T(kernel.amplitude) * trial.jet, trial.good};
}

/// Value and gradient; see the head of this file.
template <class T>
JetOf<T> integral(const Cauchy& kernel, const TriangleFrame<T>& triangle, const Vec3<T>& point) {
  return T(kernel.amplitude) * detail::unit_cauchy_triangle(T(kernel.s), triangle, point);
}

template <class T>
JetOf<T> integral(const Cauchy& kernel, const Triangle& triangle, const Vec3<T>& point) {
  return integral(kernel, TriangleFrame<T>(triangle), point);
}

}  // namespace cs2mesh
