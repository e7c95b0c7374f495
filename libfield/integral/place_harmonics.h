// The Taylor series of many places at once. In harmonics (see harmonics.h) the terms of degree
// D = l + 2j of
//     (|d + x|^2 + tau)^-nu = sum_l,j g_lj |x|^2j (|d|^l |x|^l P_l(cos)),   S = |d|^2 + tau,
// follow from the recurrence in taylor_series.h and that of Legendre's polynomials:
//     S D g_lj = -(2D - 2 + 2 nu) (l / (2l - 1) g_(l-1)j + (l + 1) / (2l + 3) |d|^2 g_(l+1)(j-1))
//                - (D - 2 + 2 nu) g_l(j-1),   g_00 = S^-nu.
// So a place has 64 such factors and 225 harmonics, and to each of 680 sums it adds the product of
// two of them; the polynomial is put together once, at the end.
//
// A lane is a place; what the lanes have added up to is added up at the end.
#pragma once

#include <array>
#include <cstddef>

#include "libfield/integral/harmonics.h"
#include "libfield/simd/pack.h"

namespace cs2mesh::detail {

/// Places as seen from the centre of a series.
template <class P>
struct FarPlaces {
  Vec3<P> d;    ///< from each to the centre
  P inverse_s;  ///< 1 / S
  P weight;     ///< w S^-nu
};

/// b_lm by degree, once.
inline constexpr auto kHarmonicSteps = [] {
  std::array<std::array<double, kTaylorOrder + 1>, kTaylorOrder + 1> steps{};
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
  /// The factors of the recurrence of g, without 1 / S and |d|^2.
  struct Step {
    double below = 0.0, above = 0.0, lower = 0.0;
  };

 public:
  /// So many packs at once share the way of the sums from and to memory.
  static constexpr int kMostPacks = 4;

  explicit PlaceHarmonics(double two_nu) {
    for (int l = 0; l <= kTaylorOrder; ++l) {
      for (int j = 0; j < radial_powers(l); ++j) {
        const double degree = l + 2 * j;
        if (degree == 0.0) continue;
        const double first = -(2 * degree - 2 + two_nu) / degree;
        steps_[radial_index(l, j)] = {first * l / (2 * l - 1), first * (l + 1) / (2 * l + 3),
                                      -(degree - 2 + two_nu) / degree};
      }
    }
  }

  /// Adds K <= kMostPacks packs of places, up to that order.
  template <int K>
  void add(int order, const FarPlaces<P>* places) {
    P squared[K];
    for (int k = 0; k < K; ++k) {
      const Vec3<P>& d = places[k].d;
      squared[k] = fma(d.x, d.x, fma(d.y, d.y, d.z * d.z));
    }
    find_radial<K>(order, places, squared);
    add_degrees<kTaylorOrder / 2 + 1, K>(order, places, squared);
  }

  /// Adds what the lanes have added up to.
  void add_to(double* sums) const {
    for (std::size_t k = 0; k < kSeriesSize; ++k) {
      for (int lane = 0; lane < N; ++lane) sums[k] += sums_[k].lane[lane];
    }
  }

 private:
  /// w g of each pack, pack by pack.
  template <int K>
  void find_radial(int order, const FarPlaces<P>* places, const P* squared) {
    const auto at = [&](int l, int j, int k) -> P& { return radial_[radial_index(l, j) * K + k]; };
    for (int k = 0; k < K; ++k) at(0, 0, k) = places[k].weight;
    for (int l = 1; l <= order; ++l) {
      const P below(steps_[radial_index(l, 0)].below);
      for (int k = 0; k < K; ++k) at(l, 0, k) = below * places[k].inverse_s * at(l - 1, 0, k);
    }
    for (int j = 1; 2 * j <= order; ++j) {
      P last[K] = {};
      for (int l = 0; l + 2 * j <= order; ++l) {
        const Step& step = steps_[radial_index(l, j)];
        const P below(step.below), above(step.above), lower(step.lower);
#pragma GCC unroll 4
        for (int k = 0; k < K; ++k) {
          const P& inverse = places[k].inverse_s;
          const P others = fma(above, squared[k] * at(l + 1, j - 1, k), lower * at(l, j - 1, k));
          // What waits for the last one comes last.
          last[k] = fma(below * inverse, last[k], inverse * others);
          at(l, j, k) = last[k];
        }
      }
    }
  }

  /// Adds the two degrees of which `Powers` powers of |x|^2 are wanted, and all higher ones. Sorted
  /// so, the innermost loops have fixed lengths.
  template <int Powers, int K>
  void add_degrees(int order, const FarPlaces<P>* places, const P* squared) {
    for (int l = order - 2 * Powers + 1; l <= order - 2 * Powers + 2; ++l) {
      if (l < 0) continue;
      find_row<K>(l, places, squared);
      add_products<Powers, K>(l);
    }
    if constexpr (Powers > 1) add_degrees<Powers - 1, K>(order, places, squared);
  }

  /// The harmonics of degree l from those of the two degrees below.
  template <int K>
  void find_row(int l, const FarPlaces<P>* places, const P* squared) {
    P* self = rows_[l % 3];
    if (l == 0) {
      for (int k = 0; k < K; ++k) self[k] = P(1);
      return;
    }
    const P* last = rows_[(l + 2) % 3];
    const P* before = rows_[(l + 1) % 3];
    for (int i = 0; i < harmonics_of(l - 2); ++i) {  // none where l = 1
      const P step(-kHarmonicSteps[l][(i + 1) / 2]);
#pragma GCC unroll 4
      for (int k = 0; k < K; ++k) {
        const int at = i * K + k;
        self[at] = fma(step * squared[k], before[at], places[k].d.z * last[at]);
      }
    }
    for (int i = l > 1 ? harmonics_of(l - 2) : 0; i < harmonics_of(l - 1); ++i) {
      for (int k = 0; k < K; ++k) self[i * K + k] = places[k].d.z * last[i * K + k];
    }
    for (int k = 0; k < K; ++k) {
      const Vec3<P>& d = places[k].d;
      const P cosine = last[(l > 1 ? 2 * l - 3 : 0) * K + k];
      const P sine = l > 1 ? last[(2 * l - 2) * K + k] : P(0);
      self[(2 * l - 1) * K + k] = d.x * cosine - d.y * sine;
      self[2 * l * K + k] = fma(d.x, sine, d.y * cosine);
    }
  }

  template <int Powers, int K>
  void add_products(int l) {
    const P* row = rows_[l % 3];
    const P* radial = radial_ + radial_index(l, 0) * K;
    P by[Powers * K];
#pragma GCC unroll 32
    for (int i = 0; i < Powers * K; ++i) by[i] = radial[i];
    P* sums = sums_ + harmonic_index(l, 0, 0);
    const int stride = radial_powers(l);
    for (int i = 0; i < harmonics_of(l); ++i, row += K, sums += stride) {
#pragma GCC unroll 16
      for (int j = 0; j < Powers; ++j) {
        P sum = sums[j];
#pragma GCC unroll 4
        for (int k = 0; k < K; ++k) sum = fma(by[j * K + k], row[k], sum);
        sums[j] = sum;
      }
    }
  }

  P sums_[kSeriesSize];
  P radial_[kRadialSize * kMostPacks];  ///< w g of each pack
  P rows_[3][harmonics_of(kTaylorOrder) *
             kMostPacks];  ///< the harmonics of three degrees, of each pack
  Step steps_[kRadialSize];
};

}  // namespace cs2mesh::detail
