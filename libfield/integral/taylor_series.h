// Polynomials of three variables and total degree kTaylorOrder, as they stand for the part of a
// field that comes from far away, and the Taylor series of the kernels that reach that far,
//     g(x) = (|d + x|^2 + tau)^-nu,
// whose coefficients c_k, k a multi-index of length n, follow one another (Duan and Krasny 2001):
//     S n c_k = -(2n - 2 + 2 nu) sum_i d_i c_(k - e_i) - (n - 2 + 2 nu) sum_i c_(k - 2 e_i),
// S = |d|^2 + tau. What is left out is bounded by Gegenbauer polynomials, whose greatest value is
// binomial(m + 2 nu - 1, m): with q = |x| / sqrt(S) < 1,
//     |g - series| <= S^-nu sum_(m > order) binomial(m + 2 nu - 1, m) q^m.
//
// Legend: nu the kernel's exponent (Cauchy 2, inverse squared 1, inverse 1/2), tau its own squared
// length (1 / s^2, 0, 0); d from the source to the centre of the series.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "libfield/base/jet2.h"
#include "libfield/simd/lanes.h"

namespace cs2mesh {

inline constexpr int kTaylorOrder = 14;

namespace detail {

struct SeriesRows {
  static constexpr int kWidth = kTaylorOrder + 1;
  /// Where the coefficients of x^a y^b begin; those of z^c follow in order.
  std::array<std::array<int, kWidth>, kWidth> begin{};
  int size = 0;

  constexpr SeriesRows() {
    for (int a = 0; a <= kTaylorOrder; ++a) {
      for (int b = 0; a + b <= kTaylorOrder; ++b) {
        begin[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] = size;
        size += kTaylorOrder + 1 - a - b;
      }
    }
  }
};
inline constexpr SeriesRows kSeriesRows{};

}  // namespace detail

inline constexpr std::size_t kSeriesSize = detail::kSeriesRows.size;

/// The place of the coefficient of x^a y^b z^c, a + b + c <= kTaylorOrder.
constexpr std::size_t series_index(int a, int b, int c) {
  return static_cast<std::size_t>(
      detail::kSeriesRows.begin[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)] + c);
}

/// Calls visit(a, b, c) for every coefficient, lower powers before higher ones.
template <class Visit>
constexpr void visit_powers(const Visit& visit, int order = kTaylorOrder) {
  for (int a = 0; a <= order; ++a) {
    for (int b = 0; a + b <= order; ++b) {
      for (int c = 0; a + b + c <= order; ++c) visit(a, b, c);
    }
  }
}

/// sum c_k x^k.
using Series = std::array<double, kSeriesSize>;

/// Value and gradient of a series at x.
template <class T>
JetOf<T> series_jet(const double* series, const Vec3<T>& x) {
  using std::fma;
  JetOf<T> sum{};
  for (int a = kTaylorOrder; a >= 0; --a) {
    T value(0), by_y(0), by_z(0);
    for (int b = kTaylorOrder - a; b >= 0; --b) {
      const double* row = series + series_index(a, b, 0);
      T in_z(0), slope(0);
      for (int c = kTaylorOrder - a - b; c >= 0; --c) {
        slope = fma(slope, x.z, in_z);
        in_z = fma(in_z, x.z, T(row[c]));
      }
      by_y = fma(by_y, x.y, value);
      by_z = fma(by_z, x.y, slope);
      value = fma(value, x.y, in_z);
    }
    sum.gradient.x = fma(sum.gradient.x, x.x, sum.value);
    sum.gradient.y = fma(sum.gradient.y, x.x, by_y);
    sum.gradient.z = fma(sum.gradient.z, x.x, by_z);
    sum.value = fma(sum.value, x.x, value);
  }
  return sum;
}

/// Calls use(place, c_k) for the coefficients, up to that order, of (|d + x|^2 + tau)^-nu for
/// S = |d|^2 + tau; `power` is S^-nu. Those of x^a y^b z^n follow from those of lower a + b, of
/// which two levels are kept, in the nearest cache. The lengths of the rows are known where they
/// are run through, or their many ends would be mispredicted; all of it unrolled would be too much
/// code.
template <class T, class Use>
void kernel_series(double two_nu, int order, const Vec3<T>& d, const T& s, const T& power,
                   const Use& use) {
  using std::fma;
  constexpr int kWidth = kTaylorOrder + 1;
  const T inverse = T(1) / s;
  T first[kWidth], second[kWidth], along[kWidth], none[kWidth];
  for (int n = 0; n <= order; ++n) {
    first[n] = n > 0 ? inverse * T(-(2 * n - 2 + two_nu) / n) : T(0);
    second[n] = n > 0 ? inverse * T(-(n - 2 + two_nu) / n) : T(0);
    along[n] = first[n] * d.z;
    none[n] = T(0);
  }
  T level[3][(kWidth + 1) * (kWidth + 1) / 4];
  const auto row = [&](int m, int a) { return level[m % 3] + a * (kWidth - m); };
#pragma GCC unroll 16
  for (int m = 0; m <= kTaylorOrder; ++m) {
    if (m > order) return;
#pragma GCC unroll 1
    for (int a = 0; a <= m; ++a) {
      const int b = m - a;
      const T* ax = a > 0 ? row(m - 1, a - 1) : none;
      const T* bx = b > 0 ? row(m - 1, a) : none;
      const T* ax2 = a > 1 ? row(m - 2, a - 2) : none;
      const T* bx2 = b > 1 ? row(m - 2, a) : none;
      T* self = row(m, a);
      const std::size_t place = series_index(a, b, 0);
      T before(0), last(0);  // along z
#pragma GCC unroll 16
      for (int k = 0; k <= kTaylorOrder - m; ++k) {
        if (k > order - m) break;
        const int n = m + k;
        // What waits for the last coefficient comes last.
        T value = fma(first[n], fma(d.y, bx[k], d.x * ax[k]), second[n] * (ax2[k] + bx2[k]));
        value = fma(along[n], last, fma(second[n], before, value));
        if (n == 0) value = power;
        self[k] = value;
        use(place + static_cast<std::size_t>(k), value);
        before = last, last = value;
      }
    }
  }
}

/// (-x)^n / n! for n <= kTaylorOrder, times `factor`.
template <class T>
void divided_powers(const T& x, const T& factor, T* power) {
  power[0] = factor;
  for (int n = 1; n <= kTaylorOrder; ++n) power[n] = power[n - 1] * (x * T(-1.0 / n));
}

/// x^nu.
inline double half_power(double two_nu, double x) {
  if (two_nu == 4.0) return x * x;
  if (two_nu == 2.0) return x;
  return std::sqrt(x);
}
/// x^-nu.
inline double inverse_power(double two_nu, double x) {
  return 1 / half_power(two_nu, x);
}

/// sum_(m > order) binomial(m + 2 nu - 1, m) q^m, rounded up; infinite from q = 1 on.
inline double series_remainder(double two_nu, double q, int order = kTaylorOrder) {
  double term = 1.0;
  for (int m = 1; m <= order + 1; ++m) term *= q * (m + two_nu - 1) / m;
  // The ratio of two terms falls or rises towards q.
  const double ratio = q * std::max(1.0, (order + 1 + two_nu) / (order + 2));
  return ratio < 1.0 ? term / (1.0 - ratio) * (1 + 1e-12) : std::numeric_limits<double>::infinity();
}

/// The same polynomial about another centre and in another unit: x = offset + scale x'.
Series recentered(const Series& series, const Vec3d& offset, double scale);

/// The moments int (-q)^k / k! of a distribution, q counted from another place and in another unit:
/// q = offset + scale q'.
Series moved_moments(const Series& moments, const Vec3d& offset, double scale);

/// The second derivative of a series at x.
Symmetric3 series_hessian(const Series& series, const Vec3d& x);

/// An upper bound of the operator norm of the derivative of that order >= 1 where all |x_i| <= 1.
double derivative_bound(const Series& series, int order);

}  // namespace cs2mesh
