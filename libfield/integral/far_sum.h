// Series of far sources, and sums of series, over packs; the entries of a bulk table that a far
// field needs (see field/far_field.h, taylor_series.h).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "libfield/integral/segment_sum.h"
#include "libfield/integral/taylor_series.h"

namespace cs2mesh {

/// A cluster as seen from the centre of a series, all lengths in the unit of the series.
struct SeriesSource {
  Vec3d d;            ///< from the source to the centre
  double s = 0;       ///< |d|^2 + tau
  double weight = 0;  ///< times S^-nu: the field at the centre, were all of it in one place
  /// sum w (-q)^k / k! over the parts w at q (from the source's centre, in units of `size`).
  const double* moments = nullptr;
  double size = 1;
  int order = kTaylorOrder;  ///< at which its series may end
};

/// Clusters of one exponent, by falling order.
struct SourceList {
  double two_nu = 0.0;
  std::span<const SeriesSource> sources;
};

/// A rule for segments that go into a series: the nodes as parts of their halves, and of their
/// weights.
struct NodeRule {
  std::size_t size = 1;
  std::array<double, 8> along{}, part{1.0};

  constexpr NodeRule() = default;
  /// Pairs of nodes with their weights, and the middle with its own unless that is 0.
  template <std::size_t Half>
  constexpr NodeRule(const std::array<double, Half>& node, const std::array<double, Half>& weight,
                     double middle = 0.0)
      : size(2 * Half) {
    for (std::size_t i = 0; i < Half; ++i) {
      along[2 * i] = node[i], along[2 * i + 1] = -node[i];
      part[2 * i] = part[2 * i + 1] = 0.5 * weight[i];
    }
    if (middle > 0) part[size++] = 0.5 * middle;
  }
  template <int N>
  constexpr explicit NodeRule(const GaussLegendreRule<N>& rule)
      : NodeRule(rule.node, rule.weight) {}
};

/// The middle, for points; then those of Gauss and Legendre for segments. Of three nodes, they are
/// 0 and +-sqrt(3 / 5).
inline constexpr std::array<NodeRule, 6> kNodeRules = {
    NodeRule(),
    NodeRule(kGaussLegendre<2>),
    NodeRule(std::array{0.7745966692414834}, std::array{5.0 / 9}, 8.0 / 9),
    NodeRule(kGaussLegendre<4>),
    NodeRule(kGaussLegendre<6>),
    NodeRule(kGaussLegendre<8>)};

/// Indices of segments with the order at which the series of each may end, by falling order.
struct NodeList {
  std::span<const std::uint32_t> segments;
  std::span<const std::uint8_t> orders;
};
/// By the entry of kNodeRules that segments are taken by.
using NodeLists = std::array<NodeList, kNodeRules.size()>;

/// The centre and the unit of a series.
struct SeriesFrame {
  Vec3d center;
  double unit = 1.0;
};

/// Adds the series of the segments, by their nodes, each up to its order or a higher one; as
/// harmonics.
using AddNodes = void (*)(double two_nu, const SeriesFrame& frame, const SegmentSource* segments,
                          const NodeLists& lists, double* sums);

/// Adds the series of the sources to `series`, each up to its order or a higher one.
using AddSources = void (*)(std::span<const SourceList> lists, double* series);

/// Powers of tau's differences that moments are kept for, 0 included.
inline constexpr int kTauOrders = 3;

/// A point or a segment as seen from the centre of a cluster, lengths in units of its radius.
struct MomentSource {
  Vec3d a, b;         ///< its ends; b is not used of a point
  double weight = 0;  ///< all of it
  double t = 0;       ///< from the cluster's tau, in units of its spread
};

/// Adds sum w t^j int (-q)^k / k! dq over the sources to the moments of j < sets <= kTauOrders.
using AddMoments = void (*)(const MomentSource* sources, std::size_t count, bool segments,
                            std::size_t sets, Series* moments);

/// Adds the series at each of the points, x = (p - center) / unit; as a value or as a jet.
template <class Out>
using AddSeries = void (*)(const double* series, const Vec3d& center, double unit,
                           const Vec3d* points, Out* sums, std::size_t count);

namespace detail {

/// (-q)^n / n! for each coordinate of a place; that of x times its weight.
template <class T>
struct PlacePowers {
  T x[kTaylorOrder + 1], y[kTaylorOrder + 1], z[kTaylorOrder + 1];

  PlacePowers() = default;
  PlacePowers(const Vec3<T>& q, const T& weight) {
    divided_powers(q.x, weight, x);
    divided_powers(q.y, T(1), y);
    divided_powers(q.z, T(1), z);
  }
};

/// Adds the products of such powers over `count` places, times `factor` set by set, to those
/// moments whose row has M + 1 powers of z, and to all with shorter ones.
template <int M, class T>
void add_places(const PlacePowers<T>* places, std::size_t count, const T* factor, std::size_t sets,
                T* moments) {
  for (int a = 0; a <= kTaylorOrder - M; ++a) {
    const int b = kTaylorOrder - M - a;
    T row[M + 1] = {};
    for (std::size_t i = 0; i < count; ++i) {
      const T xy = places[i].x[a] * places[i].y[b];
#pragma GCC unroll 16
      for (int c = 0; c <= M; ++c) row[c] = fma(xy, places[i].z[c], row[c]);
    }
    for (std::size_t j = 0; j < sets; ++j) {
      T* to = moments + j * kSeriesSize + series_index(a, b, 0);
      for (int c = 0; c <= M; ++c) to[c] = fma(factor[j], row[c], to[c]);
    }
  }
  if constexpr (M > 0) add_places<M - 1>(places, count, factor, sets, moments);
}

/// k! by place.
inline constexpr std::array<double, kSeriesSize> kFactorials = [] {
  std::array<double, kTaylorOrder + 1> factorial{1.0};
  for (std::size_t n = 1; n < factorial.size(); ++n) {
    factorial[n] = factorial[n - 1] * static_cast<double>(n);
  }
  std::array<double, kSeriesSize> all{};
  visit_powers([&](int a, int b, int c) {
    all[series_index(a, b, c)] = factorial[static_cast<std::size_t>(a)] *
                                 factorial[static_cast<std::size_t>(b)] *
                                 factorial[static_cast<std::size_t>(c)];
  });
  return all;
}();

/// 1 / k! by place.
inline constexpr std::array<double, kSeriesSize> kInverseFactorials = [] {
  std::array<double, kSeriesSize> all{};
  for (std::size_t k = 0; k < kSeriesSize; ++k) all[k] = 1.0 / kFactorials[k];
  return all;
}();

/// Adds (k + m)! c_(k + m) M_m, |k + m| <= order, to k! out_k: those products whose longest row has
/// M + 1 coefficients, and all with shorter ones. Sorted so, the innermost loops have fixed
/// lengths.
template <int M, class T>
void add_products(int order, const T* derivative, const T* moments, T* out) {
  const int total = order - M;  // < 0 where there is no such row
  for (int i = 0; i <= total; ++i) {
    for (int j = 0; i + j <= total; ++j) {
      // Copies, as the compiler cannot know that the sums are elsewhere.
      T moment[M + 1];
      for (int k = 0; k <= M; ++k) moment[k] = moments[series_index(i, j, k)];
      for (int a = 0; i + j + a <= total; ++a) {
        const int b = total - i - j - a;
        const T* row = derivative + series_index(a + i, b + j, 0);
        T* sums = out + series_index(a, b, 0);
        T sum[M + 1], from[M + 1];
        for (int e = 0; e <= M; ++e) sum[e] = sums[e], from[e] = row[e];
#pragma GCC unroll 16
        for (int k = 0; k <= M; ++k) {
#pragma GCC unroll 16
          for (int e = 0; e <= M - k; ++e) sum[e] = fma(from[e + k], moment[k], sum[e]);
        }
        for (int e = 0; e <= M; ++e) sums[e] = sum[e];
      }
    }
  }
  if constexpr (M > 0) add_products<M - 1>(order, derivative, moments, out);
}

/// The sum of the series of clusters, N of them at once: from that of its centre, c,
///     out_k = 1 / k! sum_m (k + m)! c_(k + m) M_m, |k + m| <= order.
template <class P, std::size_t N>
class ClusterSeries {
 public:
  /// Adds up to N, up to the order of the first.
  void add(double two_nu, std::span<const SeriesSource> sources) {
    const int order = sources[0].order;
    Vec3<P> d;
    P s(1.0), weight(0.0), size(1.0);
    std::array<const double*, N> moments;
    moments.fill(sources[0].moments);  // times 0
    for (std::size_t lane = 0; lane < sources.size(); ++lane) {
      const SeriesSource& source = sources[lane];
      const int i = static_cast<int>(lane);
      d.x.lane[i] = source.d.x, d.y.lane[i] = source.d.y, d.z.lane[i] = source.d.z;
      s.lane[i] = source.s, weight.lane[i] = source.weight, size.lane[i] = source.size;
      moments[lane] = source.moments;
    }
    kernel_series(two_nu, order, d, s, weight, [&](std::size_t place, const P& value) {
      derivative_[place] = value * P(kFactorials[place]);
    });
    load_moments(order, moments, size);
    add_products<kTaylorOrder>(order, derivative_, moments_, sums_);
  }

  void add_to(double* series) const {
    for (std::size_t k = 0; k < kSeriesSize; ++k) {
      double sum = 0.0;
      for (std::size_t lane = 0; lane < N; ++lane) sum += sums_[k].lane[static_cast<int>(lane)];
      series[k] += kInverseFactorials[k] * sum;
    }
  }

 private:
  /// In the unit of the series.
  void load_moments(int order, const std::array<const double*, N>& moments, const P& size) {
    P power[kTaylorOrder + 1];
    power[0] = P(1);
    for (int n = 1; n <= order; ++n) power[n] = power[n - 1] * size;
    const auto load = [&](int a, int b, int e) {
      const std::size_t k = series_index(a, b, e);
      P moment;
#pragma GCC unroll 8
      for (std::size_t lane = 0; lane < N; ++lane) {
        moment.lane[static_cast<int>(lane)] = moments[lane][k];
      }
      moments_[k] = moment * power[a + b + e];
    };
    visit_powers(load, order);
  }

  P derivative_[kSeriesSize], moments_[kSeriesSize];
  P sums_[kSeriesSize];  ///< times k!
};

}  // namespace detail
}  // namespace cs2mesh
