// Polynomials of three variables as sums of |x|^2j times a solid harmonic: what the series of far
// sources are gathered as (place_harmonics.h), since to a source belongs one factor by degree of
// the polynomial and of the harmonic, and one value of each harmonic: two fifths of the
// sums that powers of its coordinates would take.
//
// The harmonics of degree l are, up to factors, r^l P_l^m(cos theta) cos m phi, and sin m phi; here
// the power of z in them that is not multiplied by x^2 + y^2 + z^2 has the factor 1:
//     Q_mm = Re, Im (x + i y)^m,
//     Q_lm = z Q_(l-1)m - b_lm |x|^2 Q_(l-2)m,   b_lm = ((l - 1)^2 - m^2) / ((2l - 1) (2l - 3)),
// and by the addition theorem (DLMF 14.18.1), with (-1)!! = 1,
//     |d|^l |x|^l P_l(cos) = sum_m N_lm Q_lm(d) Q_lm(x),
//     N_lm = e_m (2l - 1)!!^2 / ((l - m)! (l + m)!),   e_0 = 1, e_m = 2.
#pragma once

#include <array>
#include <cstddef>

#include "libfield/integral/taylor_series.h"

namespace cs2mesh {

/// The number of harmonics of degree l: m = 0, then cosine and sine of each m from 1 to l.
constexpr int harmonics_of(int l) {
  return 2 * l + 1;
}

/// The powers of |x|^2 that go with a harmonic of degree l up to that order: 0, 1, ...
constexpr int radial_powers(int l, int order = kTaylorOrder) {
  return (order - l) / 2 + 1;
}

namespace detail {

struct HarmonicRows {
  std::array<int, kTaylorOrder + 2> begin{};   ///< the sums of each degree, by harmonic and power
  std::array<int, kTaylorOrder + 2> radial{};  ///< numbers that depend on degree and power alone

  constexpr HarmonicRows() {
    for (std::size_t l = 0; l <= kTaylorOrder; ++l) {
      const int powers = radial_powers(static_cast<int>(l));
      begin[l + 1] = begin[l] + harmonics_of(static_cast<int>(l)) * powers;
      radial[l + 1] = radial[l] + powers;
    }
  }
};
inline constexpr HarmonicRows kHarmonicRows{};
static_assert(kHarmonicRows.begin.back() == static_cast<int>(kSeriesSize));

}  // namespace detail

/// The place of the factor of |x|^2j times the i-th harmonic of degree l; those of j = 0, 1, ...
/// follow one another.
constexpr int harmonic_index(int l, int i, int j) {
  return detail::kHarmonicRows.begin[static_cast<std::size_t>(l)] + i * radial_powers(l) + j;
}

/// The place of a number that belongs to degree l and power j.
constexpr int radial_index(int l, int j) {
  return detail::kHarmonicRows.radial[static_cast<std::size_t>(l)] + j;
}
inline constexpr int kRadialSize = radial_index(kTaylorOrder, 0) + 1;

/// b_lm, l >= 2.
constexpr double harmonic_step(int l, int m) {
  return ((l - 1.0) * (l - 1.0) - m * m) / ((2.0 * l - 1.0) * (2.0 * l - 3.0));
}

/// The factors of N_lm |x|^2j Q_lm(x), all of l + 2j <= kTaylorOrder.
using HarmonicSums = std::array<double, kSeriesSize>;

/// Adds that polynomial to a series. Cost: some microseconds; a millisecond the first time.
void add_harmonics(const HarmonicSums& sums, Series& series);

}  // namespace cs2mesh
