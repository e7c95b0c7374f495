// The entries of a BulkTable over packs of N; see bulk.h and the rules at the head of pack.h.
#pragma once

#include <algorithm>
#include <utility>

#include "libfield/integral/bulk.h"
#include "libfield/integral/cauchy_arc.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/cauchy_triangle.h"
#include "libfield/integral/gaussian_arc.h"
#include "libfield/integral/gaussian_segment.h"
#include "libfield/integral/gaussian_triangle.h"
#include "libfield/integral/inverse_arc.h"
#include "libfield/integral/inverse_segment.h"
#include "libfield/integral/inverse_triangle.h"
#include "libfield/integral/metaball_arc.h"
#include "libfield/integral/metaball_triangle.h"
#include "libfield/integral/place_harmonics.h"
#include "libfield/integral/plane.h"
#include "libfield/integral/squared_triangle.h"
#include "libfield/integral/support_arc.h"
#include "libfield/integral/support_segment.h"
#include "libfield/integral/support_triangle.h"
#include "libfield/integral/tapered_segment.h"
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
  static void add_to(const JetOf<Pack<N>>& jet, double* sums) {
    cs2mesh::add_to<N>(jet.value, sums);
  }
  static void add_to(const JetOf<Pack<N>>& jet, Jet* sums) { cs2mesh::add_to<N>(jet, sums); }
  static void add_to(const JetOf<T>& jet, double* sums) {
    cs2mesh::add_to<N>(jet.value.first, sums);
    cs2mesh::add_to<N>(jet.value.second, sums + N);
  }
  static void add_to(const JetOf<T>& jet, Jet* sums) {
    const Vec3<T>& g = jet.gradient;
    cs2mesh::add_to<N>({jet.value.first, {g.x.first, g.y.first, g.z.first}}, sums);
    cs2mesh::add_to<N>({jet.value.second, {g.x.second, g.y.second, g.z.second}}, sums + N);
  }

  static Plane in_lanes(const Plane& plane) { return plane; }
  static SegmentFrame<T> in_lanes(const SegmentFrame<double>& f) { return SegmentFrame<T>(f); }
  static ArcFrame<T> in_lanes(const ArcFrame<double>& f) { return ArcFrame<T>(f); }
  static TaperedFrame<T> in_lanes(const TaperedFrame<double>& f) { return TaperedFrame<T>(f); }

  /// Adds f(p) for some points, no more than there are lanes. The last point stands in for those
  /// that are missing. Flattened: no call remains that another unit could serve, and nothing is
  /// computed for a gradient that is not asked for.
  template <std::size_t Lanes, class Out, class Load, class Formula>
  CS2MESH_FLATTEN static void add_some(const Vec3d* points, Out* sums, std::size_t count,
                                       const Load& load_lanes, const Formula& formula) {
    if (count == Lanes) return add_to(formula(load_lanes(points)), sums);
    Vec3d padded[Lanes];
    Out padded_sums[Lanes];
    for (std::size_t k = 0; k < Lanes; ++k) padded[k] = points[k < count ? k : count - 1];
    for (std::size_t k = 0; k < count; ++k) padded_sums[k] = sums[k];
    add_to(formula(load_lanes(padded)), padded_sums);
    for (std::size_t k = 0; k < count; ++k) sums[k] = padded_sums[k];
  }

  /// Adds f(p) for each of the points.
  template <class Out, class Formula>
  CS2MESH_FLATTEN static void add_each(const Vec3d* points, Out* sums, std::size_t count,
                                       const Formula& formula) {
    for (std::size_t i = 0; i < count; i += kLanes) {
      const std::size_t left = count - i;
      add_some<kLanes>(points + i, sums + i, left < kLanes ? left : kLanes, load, formula);
    }
  }

  /// The same bits, by one pack instead of two where so few points are left: for formulas that take
  /// long, and points that come a few at a time.
  template <class Out, class Formula>
  CS2MESH_FLATTEN static void add_few(const Vec3d* points, Out* sums, std::size_t count,
                                      const Formula& formula) {
    constexpr std::size_t kHalf = N;
    const std::size_t rest = count % kLanes, wide = rest > kHalf ? count : count - rest;
    add_each(points, sums, wide, formula);
    if (wide == count) return;
    add_some<kHalf>(points + wide, sums + wide, rest, cs2mesh::load<N>, formula);
  }

  template <class K, class F, class Out>
  CS2MESH_FLATTEN static void add(const K& kernel, const F& frame, double sign, const Vec3d* points,
                                  Out* sums, std::size_t count) {
    const auto lanes = in_lanes(frame);
    add_each(points, sums, count,
             [&](const Vec3<T>& p) { return T(sign) * integral(kernel, lanes, p); });
  }

  template <class K, class Out>
  CS2MESH_FLATTEN static void add_points(const PointSource* sources, const std::uint32_t* index,
                                         std::size_t source_count, const Vec3d* points, Out* sums,
                                         std::size_t count) {
    add_each(points, sums, count,
             [&](const Vec3<T>& p) { return point_sum<K, T>(sources, index, source_count, p); });
  }

  template <int TwoNu, int Nodes, class Out>
  CS2MESH_FLATTEN static void add_as_nodes(const SegmentSource* sources, const std::uint32_t* index,
                                           std::size_t source_count, const Vec3d* points, Out* sums,
                                           std::size_t count) {
    add_few(points, sums, count, [&]<class U>(const Vec3<U>& p) {
      return segment_sum<TwoNu, Nodes, U>(sources, index, source_count, p);
    });
  }
  template <int TwoNu, class Out>
  static void add_by_nodes(std::size_t which, const SegmentSource* sources,
                           const std::uint32_t* index, std::size_t source_count,
                           const Vec3d* points, Out* sums, std::size_t count) {
    const auto add = [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((which == I ? add_as_nodes<TwoNu, kFarNodes[I], Out>(sources, index, source_count, points,
                                                            sums, count)
                   : void()),
       ...);
    };
    add(std::make_index_sequence<kFarNodes.size()>{});
  }
  template <class Out>
  static void add_segments(double two_nu, std::size_t which, const SegmentSource* sources,
                           const std::uint32_t* index, std::size_t source_count,
                           const Vec3d* points, Out* sums, std::size_t count) {
    if (two_nu == 4.0) {
      add_by_nodes<4>(which, sources, index, source_count, points, sums, count);
    } else if (two_nu == 2.0) {
      add_by_nodes<2>(which, sources, index, source_count, points, sums, count);
    } else {
      add_by_nodes<1>(which, sources, index, source_count, points, sums, count);
    }
  }

  template <class K, class Out>
  CS2MESH_FLATTEN static void try_triangle(const K& kernel, const TriangleFrame<double>& frame,
                                           double sign, const Vec3d* points, Out* sums,
                                           double* left, std::size_t count) {
    const TriangleFrame<T> lanes(frame);
    add_each(points, sums, count, [&](const Vec3<T>& p) {
      const TriangleTrial<T> trial = triangle_trial(kernel, lanes, p);
      const T missed = select(trial.good, T(0), T(1));
      cs2mesh::add_to<N>(missed.first, left);
      cs2mesh::add_to<N>(missed.second, left + N);
      left += kLanes;
      return T(sign) * select(trial.good, trial.jet, JetOf<T>{});
    });
  }

  template <class Out>
  CS2MESH_FLATTEN static void add_lines(const SegmentSource* sources, const std::uint32_t* index,
                                        std::size_t source_count, const Vec3d* points, Out* sums,
                                        std::size_t count) {
    add_few(points, sums, count, [&]<class U>(const Vec3<U>& p) {
      return line_sum<U>(sources, index, source_count, p);
    });
  }

  template <class Out>
  CS2MESH_FLATTEN static void sum_triangles(const TriangleSource* sources,
                                            const std::uint32_t* index, std::size_t source_count,
                                            const Vec3d* points, Out* sums, std::size_t count) {
    add_each(points, sums, count,
             [&](const Vec3<T>& p) { return triangle_sum<T>(sources, index, source_count, p); });
  }

  /// Some segments, one number of all of them after the other: looked up well before they are
  /// wanted in lanes, as what is written number by number is not at once there to be read in packs.
  struct SegmentBlock {
    static constexpr std::size_t kMost = 64;
    double numbers[8][kMost];

    void load(const SegmentSource* segments, const std::uint32_t* index, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) {
        const SegmentSource& segment = segments[index[i]];
        const Vec3d &m = segment.middle, &h = segment.half;
        numbers[0][i] = m.x, numbers[1][i] = m.y, numbers[2][i] = m.z;
        numbers[3][i] = h.x, numbers[4][i] = h.y, numbers[5][i] = h.z;
        numbers[6][i] = segment.weight, numbers[7][i] = segment.tau;
      }
      // Where a pack lacks some, they weigh nothing.
      for (std::size_t i = count; i % N != 0; ++i) {
        for (auto& number : numbers) number[i] = 0.0;
        numbers[7][i] = 1.0;
      }
    }
  };
  /// A segment a lane.
  struct Segments {
    Vec3<Pack<N>> middle, half;
    Pack<N> weight, tau;

    Segments(const SegmentBlock& block, std::size_t first) {
      Pack<N>* const to[8] = {&middle.x, &middle.y, &middle.z, &half.x,
                              &half.y,   &half.z,   &weight,   &tau};
      for (std::size_t k = 0; k < 8; ++k) {
        for (int lane = 0; lane < N; ++lane) {
          to[k]->lane[lane] = block.numbers[k][first + static_cast<std::size_t>(lane)];
        }
      }
    }
  };
  /// Calls visit(first, some) for every pack of segments.
  template <class Visit>
  static void visit_segments(const SegmentSource* segments, const std::uint32_t* index,
                             std::size_t count, const Visit& visit) {
    SegmentBlock block;
    for (std::size_t begin = 0; begin < count; begin += SegmentBlock::kMost) {
      const std::size_t here = std::min(count - begin, SegmentBlock::kMost);
      block.load(segments, index + begin, here);
      for (std::size_t i = 0; i < here; i += N) visit(begin + i, Segments(block, i));
    }
  }

  CS2MESH_FLATTEN static void choose_far(const FarBounds& law, const FarFrame& frame,
                                         const SegmentSource* segments, const std::uint32_t* index,
                                         std::size_t count, FarChoice* choices,
                                         OctantErrors& errors) {
    std::array<Pack<N>, kOctantPairs> sums{};
    visit_segments(segments, index, count, [&](std::size_t first, const Segments& some) {
      const FarSegments<Pack<N>> far(law, frame, some.middle, some.half, some.weight, some.tau);
      for (std::size_t k = 0; k < kOctantPairs; ++k) sums[k] += far.errors[k];
      for (std::size_t lane = 0; lane < N && first + lane < count; ++lane) {
        const auto i = static_cast<int>(lane);
        choices[first + lane] = {static_cast<std::uint8_t>(far.order.lane[i]),
                                 static_cast<std::uint8_t>(far.rule.lane[i])};
      }
    });
    for (std::size_t k = 0; k < kOctantPairs; ++k) {
      for (int lane = 0; lane < N; ++lane) errors[k] += sums[k].lane[lane];
    }
  }

  CS2MESH_FLATTEN static double choose_nodes(const FarBounds& law, const FarFrame& frame,
                                             const SegmentSource* segments,
                                             const std::uint32_t* index, std::size_t count,
                                             std::uint8_t* choices) {
    using P = Pack<N>;
    P sum(0);
    visit_segments(segments, index, count, [&](std::size_t first, const Segments& some) {
      const Vec3<P> d{P(frame.center.x) - some.middle.x, P(frame.center.y) - some.middle.y,
                      P(frame.center.z) - some.middle.z};
      const FarNodes<P> nodes(law.two_nu, frame, law.sums, d, some.half,
                              over_squared(squared_norm(some.half)), some.weight, some.tau);
      sum += select(nodes.entry > P(0), nodes.error, P(0));
      for (std::size_t lane = 0; lane < N && first + lane < count; ++lane) {
        choices[first + lane] = static_cast<std::uint8_t>(nodes.entry.lane[static_cast<int>(lane)]);
      }
    });
    double error = 0.0;
    for (int lane = 0; lane < N; ++lane) error += sum.lane[lane];
    return error;
  }

  CS2MESH_FLATTEN static void add_nodes(double two_nu, const SeriesFrame& frame,
                                        const SegmentSource* segments, const NodeLists& lists,
                                        double* sums) {
    using P = Pack<N>;
    PlaceHarmonics<N> harmonics(two_nu);
    const double inverse = 1.0 / frame.unit;
    const double scale = two_nu == 4.0   ? inverse * inverse * inverse * inverse
                         : two_nu == 2.0 ? inverse * inverse
                                         : inverse;
    const auto place = [&](const Segments& some, double along, double part) {
      const P unit(inverse), t(along);
      const Vec3<P> d{unit * (P(frame.center.x) - fma(t, some.half.x, some.middle.x)),
                      unit * (P(frame.center.y) - fma(t, some.half.y, some.middle.y)),
                      unit * (P(frame.center.z) - fma(t, some.half.z, some.middle.z))};
      const P squared = fma(d.x, d.x, fma(d.y, d.y, d.z * d.z));
      const P s = fma(unit * unit, some.tau, squared), root = sqrt(max(squared, P(1e-280)));
      const P both = P(1) / (s * root), over = both * root, apart = both * s;
      const P power = two_nu == 4.0 ? over * over : two_nu == 2.0 ? over : sqrt(over);
      return FarPlaces<P>{{apart * d.x, apart * d.y, apart * d.z},
                          apart * squared * over,
                          over,
                          P(scale * part) * some.weight * power};
    };
    // Many are looked up before they are added: looking up waits for memory.
    constexpr int kAdded = PlaceHarmonics<N>::kPacks, kMost = 4 * kAdded;
    FarPlaces<P> places[kMost] = {};
    int orders[kMost] = {}, waiting = 0;
    const auto add = [&] {
      for (int k = 0; k < waiting; k += kAdded) {
        harmonics.add(*std::max_element(orders + k, orders + k + kAdded), places + k);
      }
      waiting = 0;
    };
    for (std::size_t which = 0; which < lists.size(); ++which) {
      const auto& list = lists[which].segments;
      const auto& list_orders = lists[which].orders;
      const NodeRule& rule = kNodeRules[which];
      const auto add_pack = [&](std::size_t first, const Segments& some) {
        for (std::size_t k = 0; k < rule.size; ++k) {
          orders[waiting] = list_orders[first];  // of a pack the highest
          places[waiting++] = place(some, rule.along[k], rule.part[k]);
          if (waiting == kMost) add();
        }
      };
      visit_segments(segments, list.data(), list.size(), add_pack);
    }
    for (; waiting % kAdded != 0; ++waiting) places[waiting] = {}, orders[waiting] = 0;
    add();
    harmonics.add_to(sums);
  }

  /// A source a lane.
  CS2MESH_FLATTEN static void add_sources(std::span<const SourceList> lists, double* series) {
    ClusterSeries<Pack<N>, N> all;
    for (const SourceList& list : lists) {
      for (auto rest = list.sources; !rest.empty();) {
        const std::size_t here = std::min<std::size_t>(N, rest.size());
        all.add(list.two_nu, rest.first(here));
        rest = rest.subspan(here);
      }
    }
    all.add_to(series);
  }

  /// A source a lane; eight nodes integrate all powers that count along a segment exactly.
  CS2MESH_FLATTEN static void add_moments(const MomentSource* sources, std::size_t count,
                                          bool segments, std::size_t sets, Series* moments) {
    using P = Pack<N>;
    constexpr const UnitRule<8>& rule = kUnitRule<8>;
    P sums[kTauOrders * kSeriesSize];
    for (std::size_t first = 0; first < count; first += N) {
      Vec3<P> a, b;
      P weight(0.0), t(0.0);
      for (std::size_t lane = 0; lane < N && first + lane < count; ++lane) {
        const MomentSource& source = sources[first + lane];
        const int i = static_cast<int>(lane);
        a.x.lane[i] = source.a.x, a.y.lane[i] = source.a.y, a.z.lane[i] = source.a.z;
        b.x.lane[i] = source.b.x, b.y.lane[i] = source.b.y, b.z.lane[i] = source.b.z;
        weight.lane[i] = source.weight, t.lane[i] = source.t;
      }
      PlacePowers<P> places[8];
      for (std::size_t i = 0; segments && i < 8; ++i) {
        places[i] = PlacePowers<P>(a + P(rule.node[i]) * (b - a), weight * P(rule.weight[i]));
      }
      if (!segments) places[0] = PlacePowers<P>(a, weight);
      const P factor[kTauOrders] = {P(1), t, t * t};
      add_places<kTaylorOrder>(places, segments ? 8 : 1, factor, sets, sums);
    }
    for (std::size_t k = 0; k < sets * kSeriesSize; ++k) {
      double& to = moments[k / kSeriesSize][k % kSeriesSize];
      for (int lane = 0; lane < N; ++lane) to += sums[k].lane[lane];
    }
  }

  template <class Out>
  CS2MESH_FLATTEN static void add_series(const double* series, const Vec3d& center, double unit,
                                         const Vec3d* points, Out* sums, std::size_t count) {
    add_few(points, sums, count, [&]<class U>(const Vec3<U>& p) {
      const U inverse(1.0 / unit);
      const Vec3<U> x{(p.x - U(center.x)) * inverse, (p.y - U(center.y)) * inverse,
                      (p.z - U(center.z)) * inverse};
      JetOf<U> jet = series_jet(series, x);
      jet.gradient = inverse * jet.gradient;
      return jet;
    });
  }

  template <class F, class Out>
  CS2MESH_FLATTEN static void find_weights(const StrengthProfile& profile, const F& frame,
                                           const Vec3d* points, Out* weights, std::size_t count) {
    const auto lanes = in_lanes(frame);
    for (std::size_t i = 0; i < count; ++i) weights[i] = Out{};
    add_each(points, weights, count,
             [&](const Vec3<T>& p) { return weight<T>(profile, lanes, p); });
  }

  template <class Out>
  static consteval BulkRow<Out> row() {
    return {&add<Cauchy, SegmentFrame<double>, Out>,
            &add<Cauchy, ArcFrame<double>, Out>,
            &add<Gaussian, SegmentFrame<double>, Out>,
            &add<Inverse, SegmentFrame<double>, Out>,
            &add<Squared, SegmentFrame<double>, Out>,
            &add<Metaball, SegmentFrame<double>, Out>,
            &add<Soft, SegmentFrame<double>, Out>,
            &add<Quartic, SegmentFrame<double>, Out>,
            &add<Gaussian, ArcFrame<double>, Out>,
            &add<Metaball, ArcFrame<double>, Out>,
            &add<Inverse, ArcFrame<double>, Out>,
            &add<Squared, ArcFrame<double>, Out>,
            &add<Soft, ArcFrame<double>, Out>,
            &add<Quartic, ArcFrame<double>, Out>,
            &add<Cauchy, Plane, Out>,
            &add<Gaussian, Plane, Out>,
            &add<Metaball, Plane, Out>,
            &add<Soft, Plane, Out>,
            &add<Quartic, Plane, Out>,
            &add<Cauchy, TaperedFrame<double>, Out>,
            &add<Gaussian, TaperedFrame<double>, Out>};
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
  template <class Out>
  static consteval TriangleRow<Out> triangles() {
    return {&try_triangle<Cauchy, Out>, &try_triangle<Inverse, Out>, &try_triangle<Metaball, Out>,
            &try_triangle<Soft, Out>,   &try_triangle<Quartic, Out>, &try_triangle<Gaussian, Out>,
            &try_triangle<Squared, Out>};
  }
  static consteval BulkTable table() {
    return {row<Jet>(),          row<double>(),          weights<Jet>(),   weights<double>(),
            points<Jet>(),       points<double>(),       triangles<Jet>(), triangles<double>(),
            &add_segments<Jet>,  &add_segments<double>,  &add_lines<Jet>,  &add_lines<double>,
            &sum_triangles<Jet>, &sum_triangles<double>, &choose_far,      &choose_nodes,
            &add_nodes,          &add_sources,           &add_moments,     &add_series<Jet>,
            &add_series<double>};
  }
};

}  // namespace cs2mesh::detail
