// How the sources of terms look into them: each kernel with each primitive, one at a time.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <type_traits>
#include <utility>

#include "libfield/base/check.h"
#include "libfield/field/term.h"
#include "libfield/integral/bulk.h"
#include "libfield/integral/integral.h"

namespace cs2mesh {

/// Calls f(kernel, primitive) with the alternatives held, but for the pairs that have no field,
/// which compile() never lets through.
template <class F>
auto visit_pair(const Term& term, F&& f) {
  return std::visit(
      [&f](const auto& kernel, const auto& primitive) {
        using K = std::decay_t<decltype(kernel)>;
        using P = std::decay_t<decltype(primitive)>;
        if constexpr (!kHasField<K, P>) {
          require(false, "that kernel has no field over that primitive");
          return f(Cauchy{1.0}, primitive);
        } else {
          return f(kernel, primitive);
        }
      },
      term.kernel, term.primitive);
}

/// The alternative of Frame for a primitive.
template <class P>
struct FrameTypeOf {
  using type = P;
};
template <>
struct FrameTypeOf<Segment> {
  using type = SegmentFrame<double>;
};
template <>
struct FrameTypeOf<Arc> {
  using type = ArcFrame<double>;
};
template <>
struct FrameTypeOf<TaperedSegment> {
  using type = TaperedFrame<double>;
};
template <>
struct FrameTypeOf<Triangle> {
  using type = TriangleFrame<double>;
};

/// The frame of a term over that kind of primitive.
template <class P>
const auto& frame_for(const Term& term) {
  using F = typename FrameTypeOf<P>::type;
  if constexpr (std::is_same_v<P, Arc> || std::is_same_v<P, Triangle>) {
    return *std::get<std::shared_ptr<const F>>(term.frame);
  } else {
    return std::get<F>(term.frame);
  }
}

/// The integral at a point, from the frame where the pair has a closed form that uses it.
template <class K, class P>
Jet integral_of(const Term& term, const K& kernel, const P& primitive, const Vec3d& local) {
  const auto& frame = frame_for<P>(term);
  if constexpr (requires { integral(kernel, frame, local); }) {
    return integral(kernel, frame, local);
  } else {
    return integral(kernel, primitive, local);
  }
}

/// What a sum of Out takes of a jet.
template <class Out>
Out part_of(const Jet& jet) {
  if constexpr (std::is_same_v<Out, double>) {
    return jet.value;
  } else {
    return jet;
  }
}

/// Up to 64 points near or over a triangle: those that the closed form leaves over go one by one.
template <class K, class Out>
void add_triangle_run(const Term& term, const K& kernel, const Triangle& triangle, double sign,
                      std::span<const Vec3d> points, std::span<Out> sums) {
  std::array<double, 64 + kMostLanes> left{};
  const auto try_all = std::get<TryTriangle<K, Out>>(bulk_table().triangle_row<Out>());
  try_all(kernel, frame_for<Triangle>(term), sign, points.data(), sums.data(), left.data(),
          points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (left[i] == 0.0) continue;
    sums[i] += sign * part_of<Out>(integral_of(term, kernel, triangle, points[i]));
  }
}

/// Adds sign * integral at each point: jets, or values alone.
template <class K, class P, class Out>
void add_integrals(const Term& term, const K& kernel, const P& primitive, double sign,
                   std::span<const Vec3d> points, std::span<Out> sums) {
  using F = typename FrameTypeOf<P>::type;
  if constexpr (std::is_same_v<P, Point>) {
    const PointSource source = PointLaw<K>::fold(kernel, primitive.position, sign);
    const std::uint32_t index = 0;
    const auto add = bulk_table().point_row<Out>()[static_cast<std::size_t>(K::kKind)];
    add(&source, &index, 1, points.data(), sums.data(), points.size());
    return;
  }
  if constexpr (kHasBulk<K, F>) {
    if (points.size() >= kBulkCount) {
      const auto add = std::get<AddIntegrals<K, F, Out>>(bulk_table().row<Out>());
      add(kernel, frame_for<P>(term), sign, points.data(), sums.data(), points.size());
      return;
    }
  }
  std::size_t first = 0;
  if constexpr (std::is_same_v<P, Triangle> && kTriesTriangle<K>) {
    constexpr std::size_t kRun = 64;
    for (; points.size() - first >= kBulkCount; first += std::min(kRun, points.size() - first)) {
      add_triangle_run(term, kernel, primitive, sign,
                       points.subspan(first, std::min(kRun, points.size() - first)),
                       sums.subspan(first));
    }
  }
  for (std::size_t i = first; i < points.size(); ++i) {
    sums[i] += sign * part_of<Out>(integral_of(term, kernel, primitive, points[i]));
  }
}

/// A gradient in the coordinates of the primitive as one in those of the scene.
inline Vec3d to_world_gradient(const Term& term, const Vec3d& local) {
  return term.to_local ? transpose(term.to_local->linear) * local : local;
}

}  // namespace cs2mesh
