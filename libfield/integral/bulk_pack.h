// The entries of a BulkTable over packs of N; see bulk.h and the rules at the head of pack.h.
#pragma once

#include "libfield/integral/bulk.h"
#include "libfield/integral/cauchy_arc.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/gaussian_segment.h"
#include "libfield/integral/inverse_segment.h"
#include "libfield/integral/support_segment.h"
#include "libfield/profile/along.h"
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
  static void add_to(const JetOf<T>& jet, double* sums) {
    cs2mesh::add_to<N>(jet.value.first, sums);
    cs2mesh::add_to<N>(jet.value.second, sums + N);
  }
  static void add_to(const JetOf<T>& jet, Jet* sums) {
    const Vec3<T>& g = jet.gradient;
    cs2mesh::add_to<N>({jet.value.first, {g.x.first, g.y.first, g.z.first}}, sums);
    cs2mesh::add_to<N>({jet.value.second, {g.x.second, g.y.second, g.z.second}}, sums + N);
  }

  static SegmentFrame<T> in_lanes(const SegmentFrame<double>& f) { return SegmentFrame<T>(f); }
  static ArcFrame<T> in_lanes(const ArcFrame<double>& f) { return ArcFrame<T>(f); }

  /// Adds f(p) for each of the points. Flattened: no call remains that another unit could serve,
  /// and nothing is computed for a gradient that is not asked for.
  template <class Out, class Formula>
  [[gnu::flatten]] static void add_each(const Vec3d* points, Out* sums, std::size_t count,
                                        const Formula& formula) {
    // The last point stands in for those that a pack lacks.
    Vec3d padded[kLanes];
    Out padded_sums[kLanes];
    for (std::size_t i = 0; i < count; i += kLanes) {
      const std::size_t left = count - i;
      const Vec3d* from = points + i;
      Out* to = sums + i;
      if (left < kLanes) {
        for (std::size_t k = 0; k < kLanes; ++k) padded[k] = from[k < left ? k : left - 1];
        from = padded;
        for (std::size_t k = 0; k < left; ++k) padded_sums[k] = to[k];
        to = padded_sums;
      }
      add_to(formula(load(from)), to);
      if (left < kLanes) {
        for (std::size_t k = 0; k < left; ++k) sums[i + k] = padded_sums[k];
      }
    }
  }

  template <class K, class F, class Out>
  [[gnu::flatten]] static void add(const K& kernel, const F& frame, double sign,
                                   const Vec3d* points, Out* sums, std::size_t count) {
    const auto lanes = in_lanes(frame);
    add_each(points, sums, count,
             [&](const Vec3<T>& p) { return T(sign) * integral(kernel, lanes, p); });
  }

  template <class K, class Out>
  [[gnu::flatten]] static void add_points(const PointSource* sources, const std::uint32_t* index,
                                          std::size_t source_count, const Vec3d* points, Out* sums,
                                          std::size_t count) {
    add_each(points, sums, count,
             [&](const Vec3<T>& p) { return point_sum<K, T>(sources, index, source_count, p); });
  }

  template <class F, class Out>
  [[gnu::flatten]] static void find_weights(const StrengthProfile& profile, const F& frame,
                                            const Vec3d* points, Out* weights, std::size_t count) {
    const auto lanes = in_lanes(frame);
    for (std::size_t i = 0; i < count; ++i) weights[i] = Out{};
    add_each(points, weights, count,
             [&](const Vec3<T>& p) { return weight<T>(profile, lanes, p); });
  }

  template <class Out>
  static consteval BulkRow<Out> row() {
    return {&add<Cauchy, SegmentFrame<double>, Out>,   &add<Cauchy, ArcFrame<double>, Out>,
            &add<Gaussian, SegmentFrame<double>, Out>, &add<Inverse, SegmentFrame<double>, Out>,
            &add<Squared, SegmentFrame<double>, Out>,  &add<Metaball, SegmentFrame<double>, Out>,
            &add<Soft, SegmentFrame<double>, Out>,     &add<Quartic, SegmentFrame<double>, Out>};
  }
  template <class Out>
  static consteval BulkWeights<Out> weights() {
    return {&find_weights<SegmentFrame<double>, Out>, &find_weights<ArcFrame<double>, Out>};
  }
  template <class Out>
  static consteval PointRow<Out> points() {
    return {&add_points<Cauchy, Out>,  &add_points<Gaussian, Out>, &add_points<Inverse, Out>,
            &add_points<Squared, Out>, &add_points<Metaball, Out>, &add_points<Soft, Out>,
            &add_points<Quartic, Out>};
  }
  static consteval BulkTable table() {
    return {row<Jet>(),        row<double>(), weights<Jet>(),
            weights<double>(), points<Jet>(), points<double>()};
  }
};

}  // namespace cs2mesh::detail
