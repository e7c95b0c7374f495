// The Taylor series of many places at once. In harmonics (see harmonics.h) the terms of degree
// D = l + 2j of
//     (|d + x|^2 + tau)^-nu = sum_l,j g_lj |x|^2j (|d|^l |x|^l P_l(cos)),   S = |d|^2 + tau,
// follow from the recurrence in taylor_series.h and that of Legendre's polynomials:
//     S D g_lj = -(2D - 2 + 2 nu) (l / (2l - 1) g_(l-1)j + (l + 1) / (2l + 3) |d|^2 g_(l+1)(j-1))
//                - (D - 2 + 2 nu) g_l(j-1),   g_00 = S^-nu.
// So a place has 64 such factors and 225 harmonics, and to each of 680 sums it adds the product of
// two of them; the polynomial is put together once, at the end. Both are taken of d as a direction,
// with g_lj times |d|^l.
//
// A lane is a place; what the lanes have added up to is added up at the end. Of a few packs at once
// the harmonics of one m follow from one another in registers, degree by degree.
#pragma once

#include <array>
#include <cstddef>

#include "libfield/integral/harmonics.h"
#include "libfield/simd/pack.h"

namespace cs2mesh::detail {

/// Places as seen from the centre of a series, d from each to the centre.
template <class P>
struct FarPlaces {
  Vec3<P> direction;  ///< d / |d|, 0 where |d| is
  P reach;            ///< |d| / S
  P inverse_s;        ///< 1 / S
  P weight;           ///< w S^-nu
};

/// b_lm by degree, once; none is wanted of the last.
inline constexpr auto kHarmonicSteps = [] {
  std::array<std::array<double, kTaylorOrder + 1>, kTaylorOrder + 2> steps{};
  for (int l = 2; l <= kTaylorOrder; ++l) {
    for (int m = 0; m <= l - 2; ++m) {
      steps[static_cast<std::size_t>(l)][static_cast<std::size_t>(m)] = harmonic_step(l, m);
    }
  }
  return steps;
}();

/// The sums of the places added; a template of N alone (see pack.h).
template <int N>
class PlaceHarmonics {
  using P = Pack<N>;
  /// The factors of the recurrence of g, its values divided by `unit`s that make that of
  /// g_(l-1)j 1.
  struct Step {
    double above = 0.0, lower = 0.0, unit = 1.0;
  };

 public:
  /// So many packs are added at once: they share the way of the sums from and to memory.
  static constexpr int kPacks = 4;

  explicit PlaceHarmonics(double two_nu) {
    for (int j = 0; 2 * j <= kTaylorOrder; ++j) {
      for (int l = 0; l + 2 * j <= kTaylorOrder; ++l) {
        Step& step = steps_[radial_index(l, j)];
        const double degree = l + 2 * j;
        if (degree == 0.0) continue;
        const double first = -(2 * degree - 2 + two_nu) / degree;
        if (l > 0) step.unit = first * l / (2 * l - 1) * steps_[radial_index(l - 1, j)].unit;
        if (j == 0) continue;
        const auto part = [&](int lower_l) {
          return steps_[radial_index(lower_l, j - 1)].unit / step.unit;
        };
        step.above = first * (l + 1) / (2 * l + 3) * part(l + 1);
        step.lower = -(degree - 2 + two_nu) / degree * part(l);
      }
    }
  }

  /// Adds kPacks packs of places, up to that order.
  void add(int order, const FarPlaces<P>* places) {
    find_radial(order, places);
    P z[kPacks], power[2][kPacks];  // real and imaginary part of (x + i y)^m
    for (int k = 0; k < kPacks; ++k) {
      z[k] = places[k].direction.z;
      power[0][k] = P(1), power[1][k] = P(0);
    }
    add_rows<1>(order, 0, z, power);
    for (int m = 1; m <= order; ++m) {
#pragma GCC unroll 4
      for (int k = 0; k < kPacks; ++k) {
        const Vec3<P>& u = places[k].direction;
        const P cosine = power[0][k], sine = power[1][k];
        power[0][k] = u.x * cosine - u.y * sine;
        power[1][k] = fma(u.x, sine, u.y * cosine);
      }
      add_rows<2>(order, m, z, power);
    }
  }

  /// Adds what the lanes have added up to.
  void add_to(double* sums) const {
    for (int l = 0; l <= kTaylorOrder; ++l) {
      for (int i = 0; i < harmonics_of(l); ++i) {
        for (int j = 0; j < radial_powers(l); ++j) {
          const int at = harmonic_index(l, i, j);
          double sum = 0.0;
          for (int lane = 0; lane < N; ++lane) sum += sums_[at].lane[lane];
          sums[at] += steps_[radial_index(l, j)].unit * sum;
        }
      }
    }
  }

 private:
  /// w g |d|^l of each pack, in its units.
  void find_radial(int order, const FarPlaces<P>* places) {
    const auto at = [&](int l, int j) { return radial_[radial_index(l, j)]; };
    P reach[kPacks], inverse[kPacks], last[kPacks];
#pragma GCC unroll 4
    for (int k = 0; k < kPacks; ++k) {
      reach[k] = places[k].reach, inverse[k] = places[k].inverse_s;
      at(0, 0)[k] = last[k] = places[k].weight;
    }
    for (int l = 1; l <= order; ++l) {
#pragma GCC unroll 4
      for (int k = 0; k < kPacks; ++k) at(l, 0)[k] = last[k] = reach[k] * last[k];
    }
    for (int j = 1; 2 * j <= order; ++j) {
#pragma GCC unroll 4
      for (int k = 0; k < kPacks; ++k) last[k] = P(0);
      for (int l = 0; l + 2 * j <= order; ++l) {
        const Step& step = steps_[radial_index(l, j)];
        const P above(step.above), lower(step.lower);
        const P *up = at(l + 1, j - 1), *low = at(l, j - 1);
        P* self = at(l, j);
#pragma GCC unroll 4
        for (int k = 0; k < kPacks; ++k) {
          const P other = inverse[k] * (lower * low[k]);
          self[k] = last[k] = fma(reach[k], fma(above, up[k], last[k]), other);
        }
      }
    }
  }

  /// Rows of harmonics of one degree and one m: cosine and sine, or the one of m = 0.
  template <int Rows>
  using Values = P[Rows][kPacks];

  template <int Rows>
  void add_rows(int order, int m, const P (&z)[kPacks], const Values<2>& power) {
    // Of the degrees of which as many powers of |x|^2 are wanted, the lower one and the higher one.
    Values<Rows> lower, higher;
    const bool first = (order + 1 - m) % 2 == 0;
    const P in_lower(first ? 1.0 : 0.0), in_higher(first ? 0.0 : 1.0);
#pragma GCC unroll 2
    for (int i = 0; i < Rows; ++i) {
#pragma GCC unroll 4
      for (int k = 0; k < kPacks; ++k) {
        lower[i][k] = in_lower * power[i][k], higher[i][k] = in_higher * power[i][k];
      }
    }
    add_degrees<kTaylorOrder / 2 + 1, Rows>(order, m, z, lower, higher);
  }

  /// Adds the two degrees of which `Powers` powers of |x|^2 are wanted, and all higher ones. Sorted
  /// so, the innermost loops have fixed lengths.
  template <int Powers, int Rows>
  void add_degrees(int order, int m, const P (&z)[kPacks], Values<Rows>& lower,
                   Values<Rows>& higher) {
    const int l = order - 2 * Powers + 1;
    if (l >= m) {
      add_products<Powers, Rows>(l, m, lower);
      find_next<Rows>(l, m, z, lower, higher);
    }
    if (l + 1 >= m) {
      add_products<Powers, Rows>(l + 1, m, higher);
      find_next<Rows>(l + 1, m, z, higher, lower);
    }
    if constexpr (Powers > 1) add_degrees<Powers - 1, Rows>(order, m, z, lower, higher);
  }

  /// From the harmonics of degree l and, in `next`, of l - 1 those of l + 1.
  template <int Rows>
  static void find_next(int l, int m, const P (&z)[kPacks], const Values<Rows>& self,
                        Values<Rows>& next) {
    const P step(-kHarmonicSteps[l + 1][m]);
#pragma GCC unroll 2
    for (int i = 0; i < Rows; ++i) {
#pragma GCC unroll 4
      for (int k = 0; k < kPacks; ++k) next[i][k] = fma(step, next[i][k], z[k] * self[i][k]);
    }
  }

  template <int Powers, int Rows>
  void add_products(int l, int m, const Values<Rows>& self) {
    P* const sums = sums_ + harmonic_index(l, Rows == 1 ? 0 : 2 * m - 1, 0);
    const int stride = radial_powers(l);
    const P* radial = radial_[radial_index(l, 0)];
#pragma GCC unroll 8
    for (int j = 0; j < Powers; ++j, radial += kPacks) {
      P sum[Rows];
#pragma GCC unroll 2
      for (int i = 0; i < Rows; ++i) sum[i] = sums[i * stride + j];
#pragma GCC unroll 4
      for (int k = 0; k < kPacks; ++k) {
#pragma GCC unroll 2
        for (int i = 0; i < Rows; ++i) sum[i] = fma(radial[k], self[i][k], sum[i]);
      }
#pragma GCC unroll 2
      for (int i = 0; i < Rows; ++i) sums[i * stride + j] = sum[i];
    }
  }

  P sums_[kSeriesSize];            ///< in units of steps_
  P radial_[kRadialSize][kPacks];  ///< w g |d|^l of each pack
  Step steps_[kRadialSize];
};

}  // namespace cs2mesh::detail
