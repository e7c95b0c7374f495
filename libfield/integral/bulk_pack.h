// The entries of a BulkTable over packs of N; see bulk.h and the rules at the head of pack.h.
#pragma once

#include "libfield/integral/bulk.h"
#include "libfield/integral/cauchy_arc.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/gaussian_segment.h"
#include "libfield/integral/point.h"
#include "libfield/simd/twice.h"

namespace cs2mesh::detail {

template <int N>
struct BulkPack {
  using T = Twice<Pack<N>>;
  static constexpr std::size_t kLanes = 2 * N;

  static Vec3<T> load(const Vec3d* points) {
    const Vec3<Pack<N>> a = cs2mesh::load<N>(points), b = cs2mesh::load<N>(points + N);
    return {{a.x, b.x}, {a.y, b.y}, {a.z, b.z}};
  }
  static void add_to(const JetOf<T>& jet, Jet* sums) {
    const Vec3<T>& g = jet.gradient;
    cs2mesh::add_to<N>({jet.value.first, {g.x.first, g.y.first, g.z.first}}, sums);
    cs2mesh::add_to<N>({jet.value.second, {g.x.second, g.y.second, g.z.second}}, sums + N);
  }

  static Point in_lanes(const Point& point) { return point; }
  static SegmentFrame<T> in_lanes(const SegmentFrame<double>& f) { return SegmentFrame<T>(f); }
  static ArcFrame<T> in_lanes(const ArcFrame<double>& f) { return ArcFrame<T>(f); }

  /// Flattened: no call remains that another unit could serve.
  template <class K, class F>
  [[gnu::flatten]] static void add(const K& kernel, const F& frame, double sign,
                                   const Vec3d* points, Jet* sums, std::size_t count) {
    const auto lanes = in_lanes(frame);
    // The last point stands in for those that a pack lacks.
    Vec3d padded[kLanes];
    Jet padded_sums[kLanes];
    for (std::size_t i = 0; i < count; i += kLanes) {
      const std::size_t left = count - i;
      const Vec3d* from = points + i;
      Jet* to = sums + i;
      if (left < kLanes) {
        for (std::size_t k = 0; k < kLanes; ++k) padded[k] = from[k < left ? k : left - 1];
        from = padded;
        for (std::size_t k = 0; k < left; ++k) padded_sums[k] = to[k];
        to = padded_sums;
      }
      add_to(T(sign) * integral(kernel, lanes, load(from)), to);
      if (left < kLanes) {
        for (std::size_t k = 0; k < left; ++k) sums[i + k] = padded_sums[k];
      }
    }
  }

  static consteval BulkTable table() {
    return {&add<Cauchy, Point>, &add<Cauchy, SegmentFrame<double>>, &add<Cauchy, ArcFrame<double>>,
            &add<Gaussian, Point>, &add<Gaussian, SegmentFrame<double>>};
  }
};

}  // namespace cs2mesh::detail
