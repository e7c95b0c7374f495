// Series of far sources, and sums of series, over packs; the entries of a bulk table that a far
// field needs (see field/far_field.h, taylor_series.h).
#pragma once

#include <cstddef>

#include "libfield/integral/taylor_series.h"

namespace cs2mesh {

/// A source as seen from the centre of a series, all lengths in the unit of the series.
struct SeriesSource {
  Vec3d d;            ///< from the source to the centre
  double s = 0;       ///< |d|^2 + tau
  double weight = 0;  ///< times S^-nu: the field at the centre, were all of it in one place
  /// sum w (-q)^k / k! over the parts w at q (from the source's centre, in units of `size`);
  /// null for a single place of weight 1.
  const double* moments = nullptr;
  double size = 1;
};

/// Adds the series of the sources to `series`, up to that order. Either all of them have moments,
/// or none.
using AddSources = void (*)(double two_nu, int order, const SeriesSource* sources,
                            std::size_t count, double* series);

/// Adds the series at each of the points, x = (p - center) / unit; as a value or as a jet.
template <class Out>
using AddSeries = void (*)(const double* series, const Vec3d& center, double unit,
                           const Vec3d* points, Out* sums, std::size_t count);

namespace detail {

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

/// Adds to series_of_clusters()' sums, times k!, those products whose longest row has M + 1
/// coefficients, and all with shorter ones. Sorted so, the innermost loops have fixed lengths.
template <int M, class T>
void add_products(int order, const T* derivative, const T* moments, T* out) {
  const int total = order - M;  // < 0 where there is no such row
  for (int i = 0; i <= total; ++i) {
    for (int j = 0; i + j <= total; ++j) {
      const T* moment = moments + series_index(i, j, 0);
      for (int a = 0; i + j + a <= total; ++a) {
        const int b = total - i - j - a;
        const T* from = derivative + series_index(a + i, b + j, 0);
        T* sums = out + series_index(a, b, 0);
        T sum[M + 1];
        for (int e = 0; e <= M; ++e) sum[e] = sums[e];
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

/// The series of clusters from that of their centres, lane by lane, into `out`:
///     out_k = 1 / k! sum_m (k + m)! c_(k + m) M_m, |k + m| <= order.
template <class T>
void series_of_clusters(int order, const T* c, const T* moments, T* out) {
  std::array<T, kSeriesSize> derivative;
  const auto differentiate = [&](int a, int b, int e) {
    const std::size_t place = series_index(a, b, e);
    derivative[place] = c[place] * T(kFactorials[place]);
    out[place] = T(0);
  };
  visit_powers(differentiate, order);
  add_products<kTaylorOrder>(order, derivative.data(), moments, out);
  visit_powers(
      [&](int a, int b, int e) {
        const std::size_t place = series_index(a, b, e);
        out[place] *= T(kInverseFactorials[place]);
      },
      order);
}

}  // namespace detail
}  // namespace cs2mesh
