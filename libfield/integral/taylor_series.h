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

inline constexpr int kTaylorOrder = 10;

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

namespace detail {

/// The recurrence for one coefficient: its place and those of c_(k - e_i) and c_(k - 2 e_i), which
/// is kSeriesSize where there is none.
struct SeriesStep {
  std::uint16_t self, one[3], two[3];
};

/// All but the first, by degree: coefficients of one degree do not wait for each other.
struct SeriesSteps {
  std::array<SeriesStep, kSeriesSize - 1> step{};
  std::array<std::size_t, kTaylorOrder + 1> end{};  ///< of the steps of that degree

  constexpr SeriesSteps() {
    std::size_t count = 0;
    for (int n = 1; n <= kTaylorOrder; ++n) {
      for (int a = n; a >= 0; --a) {
        for (int b = n - a; b >= 0; --b) step[count++] = step_for(a, b, n - a - b);
      }
      end[static_cast<std::size_t>(n)] = count;
    }
  }

 private:
  static constexpr std::uint16_t place(int a, int b, int c) {
    const bool none = a < 0 || b < 0 || c < 0;
    return static_cast<std::uint16_t>(none ? kSeriesSize : series_index(a, b, c));
  }
  static constexpr SeriesStep step_for(int a, int b, int c) {
    return {place(a, b, c),
            {place(a - 1, b, c), place(a, b - 1, c), place(a, b, c - 1)},
            {place(a - 2, b, c), place(a, b - 2, c), place(a, b, c - 2)}};
  }
};
inline constexpr SeriesSteps kSeriesSteps{};

}  // namespace detail

/// The coefficients c_k, up to that order, of (|d + x|^2 + tau)^-nu for S = |d|^2 + tau; `power` is
/// S^-nu. `c` has room for kSeriesSize + 1.
template <class T>
void kernel_series(double two_nu, int order, const Vec3<T>& d, const T& s, const T& power, T* c) {
  const T inverse = T(1) / s;
  c[0] = power;
  c[kSeriesSize] = T(0);
  std::size_t i = 0;
  for (int n = 1; n <= order; ++n) {
    const T first = inverse * T(-(2 * n - 2 + two_nu) / n);
    const T second = inverse * T(-(n - 2 + two_nu) / n);
    for (; i < detail::kSeriesSteps.end[static_cast<std::size_t>(n)]; ++i) {
      const detail::SeriesStep& k = detail::kSeriesSteps.step[i];
      const T near = d.x * c[k.one[0]] + d.y * c[k.one[1]] + d.z * c[k.one[2]];
      const T next = c[k.two[0]] + c[k.two[1]] + c[k.two[2]];
      c[k.self] = first * near + second * next;
    }
  }
}

/// x^-nu.
inline double inverse_power(double two_nu, double x) {
  if (two_nu == 4.0) return 1 / (x * x);
  if (two_nu == 2.0) return 1 / x;
  return 1 / std::sqrt(x);
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

/// The second derivative of a series at x.
Symmetric3 series_hessian(const Series& series, const Vec3d& x);

/// An upper bound of the operator norm of the derivative of that order >= 1 where all |x_i| <= 1.
double derivative_bound(const Series& series, int order);

}  // namespace cs2mesh
