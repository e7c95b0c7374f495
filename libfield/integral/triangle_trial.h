// Closed forms over triangles keep their digits at most points; quadrature has the others.
#pragma once

#include "libfield/base/jet.h"
#include "libfield/integral/frames.h"
#include "libfield/integral/quadrature.h"

namespace cs2mesh {

/// A closed form, and where it keeps its digits; triangle_trial(kernel, frame, point) gives it.
template <class T>
struct TriangleTrial {
  JetOf<T> jet{};
  MaskOf<T> good{true};

  friend TriangleTrial select(const MaskOf<T>& mask, const TriangleTrial& yes,
                              const TriangleTrial& no) {
    const MaskOf<T> good((mask & yes.good) | (MaskOf<T>(!mask) & no.good));
    return {select(mask, yes.jet, no.jet), good};
  }
};

namespace detail {

/// What sums over the edges are made of, to judge how much they cancel.
template <class T>
struct EdgeSizes {
  T value{}, gradient{};  ///< sums of absolute values
};

/// Whether rounding of sums of that size stays below `kGrowth` times what rounding the inputs does
/// to value and gradient, eps (|f| + |grad f| l) and eps (|grad f| + |Hessian| l), l the distance
/// of the farthest vertex. The greater of `curvature` and |grad f|^2 / f stands for the Hessian,
/// which neither may exceed by much. (A value that cancellation made negative fails.)
template <class T>
MaskOf<T> sums_hold(const JetOf<T>& jet, const EdgeSizes<T>& size, const T& curvature, const T& l) {
  using std::max;
  using std::sqrt;
  constexpr double kGrowth = 16.0;
  const T slope = sqrt(squared_norm(jet.gradient));
  const T bend = max(curvature, T(slope * (slope / jet.value)));
  return both(jet.value > T(0), T(kGrowth) * (jet.value + slope * l) > size.value,
              T(kGrowth) * (slope + bend * l) > size.gradient);
}

}  // namespace detail

/// Value and gradient over a triangle: the kernel's triangle_trial(), or quadrature where that
/// fails. (The Cauchy kernel has a rule of its own to fall back on.)
template <class K>
requires(!std::is_same_v<K, Cauchy>) Jet
    integral(const K& kernel, const TriangleFrame<double>& triangle, const Vec3d& point) {
  const TriangleTrial<double> trial = triangle_trial(kernel, triangle, point);
  return trial.good ? trial.jet : quadrature(kernel, Triangle{triangle.vertex}, point);
}
template <class K>
requires(!std::is_same_v<K, Cauchy>) Jet
    integral(const K& kernel, const Triangle& triangle, const Vec3d& point) {
  return integral(kernel, TriangleFrame<double>(triangle), point);
}

}  // namespace cs2mesh
