// The entries of a BulkTable over packs of N; see bulk.h and the rules at the head of pack.h.
#pragma once

#include "libfield/integral/bulk.h"
#include "libfield/integral/cauchy_arc.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/gaussian_segment.h"
#include "libfield/integral/point.h"
#include "libfield/simd/pack.h"

namespace cs2mesh::detail {

template <int N>
struct BulkPack {
  using T = Pack<N>;

  static Point in_lanes(const Point& point) { return point; }
  static SegmentFrame<T> in_lanes(const SegmentFrame<double>& f) { return SegmentFrame<T>(f); }
  static ArcFrame<T> in_lanes(const ArcFrame<double>& f) { return ArcFrame<T>(f); }

  /// Flattened: no call remains that another unit could serve.
  template <class K, class F>
  [[gnu::flatten]] static void add(const K& kernel, const F& frame, double sign,
                                   const Vec3d* points, Jet* sums, std::size_t count) {
    const auto lanes = in_lanes(frame);
    // The last point stands in for those that a pack lacks.
    Vec3d padded[N];
    Jet padded_sums[N];
    for (std::size_t i = 0; i < count; i += N) {
      const std::size_t left = count - i;
      const Vec3d* from = points + i;
      Jet* to = sums + i;
      if (left < N) {
        for (std::size_t k = 0; k < N; ++k) padded[k] = from[k < left ? k : left - 1];
        from = padded;
        for (std::size_t k = 0; k < left; ++k) padded_sums[k] = to[k];
        to = padded_sums;
      }
      add_to<N>(T(sign) * integral(kernel, lanes, load<N>(from)), to);
      if (left < N) {
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
