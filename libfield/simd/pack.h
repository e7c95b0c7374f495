// N doubles side by side, for the same computation at N points. Only operations that IEEE 754
// rounds exactly are used and nothing is fused but by fma(), so a lane holds the same bits whatever
// stands beside it and, without fma(), whatever N.
//
// N is also the name of an instruction set: the library compiles each N in one translation unit,
// with the flags that N wants, and instantiates no other. What those units call must be templates
// over Pack<N>, or inlined, or the linker could hand their code to machines that cannot run it.
#pragma once

#include <cstdint>
#include <utility>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "libfield/simd/lanes.h"

/// Before a function: all that it calls is inlined into it. Under sanitizers that would be many
/// minutes of work for the compiler; the unit that every machine can run may leave calls there.
#if defined(CS2MESH_LEAVES_CALLS)
#define CS2MESH_FLATTEN
#else
#define CS2MESH_FLATTEN [[gnu::flatten]]
#endif

namespace cs2mesh {

namespace detail {
template <int N>
struct LaneVectors {
  typedef double Doubles __attribute__((vector_size(8 * N)));
  typedef std::int64_t Integers __attribute__((vector_size(8 * N)));
  /// As it lies in memory, wherever that is.
  struct __attribute__((packed, may_alias)) Stored {
    Doubles lane;
  };
};
}  // namespace detail

/// A truth value a lane.
template <int N>
struct Mask {
  using Doubles = typename detail::LaneVectors<N>::Doubles;
  using Bits = typename detail::LaneVectors<N>::Integers;
  Bits bits;  ///< 0 or -1

  explicit Mask(const Bits& b) : bits(b) {}
  explicit Mask(bool everywhere) : bits(Bits{} - std::int64_t{everywhere}) {}
  static Mask less(const Doubles& a, const Doubles& b) { return Mask(Bits(a < b)); }
  static Mask less_equal(const Doubles& a, const Doubles& b) { return Mask(Bits(a <= b)); }
  Doubles blend(const Doubles& yes, const Doubles& no) const { return bits ? yes : no; }

  friend Mask operator&(const Mask& a, const Mask& b) { return Mask(Bits(a.bits & b.bits)); }
  friend Mask operator|(const Mask& a, const Mask& b) { return Mask(Bits(a.bits | b.bits)); }
  friend Mask operator^(const Mask& a, const Mask& b) { return Mask(Bits(a.bits ^ b.bits)); }
  friend Mask operator!(const Mask& a) { return Mask(Bits(~a.bits)); }

  friend bool any(const Mask& mask) {
#if defined(__AVX__)
    if constexpr (N == 4) return _mm256_movemask_pd((__m256d)mask.bits) != 0;
#endif
#if defined(__SSE2__)
    if constexpr (N == 2) return _mm_movemask_pd((__m128d)mask.bits) != 0;
#endif
    std::int64_t one = 0;
    for (int i = 0; i < N; ++i) one |= mask.bits[i];
    return one != 0;
  }
};

#if defined(__AVX512F__)
/// In a mask register: a bit a lane.
template <>
struct Mask<8> {
  using Doubles = typename detail::LaneVectors<8>::Doubles;
  __mmask8 bits;

  explicit Mask(__mmask8 b) : bits(b) {}
  explicit Mask(bool everywhere) : bits(everywhere ? 0xff : 0) {}
  static Mask less(const Doubles& a, const Doubles& b) {
    return Mask(_mm512_cmp_pd_mask(a, b, _CMP_LT_OS));
  }
  static Mask less_equal(const Doubles& a, const Doubles& b) {
    return Mask(_mm512_cmp_pd_mask(a, b, _CMP_LE_OS));
  }
  Doubles blend(const Doubles& yes, const Doubles& no) const {
    return _mm512_mask_blend_pd(bits, no, yes);
  }

  friend Mask operator&(Mask a, Mask b) { return Mask(static_cast<__mmask8>(a.bits & b.bits)); }
  friend Mask operator|(Mask a, Mask b) { return Mask(static_cast<__mmask8>(a.bits | b.bits)); }
  friend Mask operator^(Mask a, Mask b) { return Mask(static_cast<__mmask8>(a.bits ^ b.bits)); }
  friend Mask operator!(Mask a) { return Mask(static_cast<__mmask8>(~a.bits)); }
  friend bool any(Mask mask) { return mask.bits != 0; }
};
#endif

template <int N>
bool all(const Mask<N>& mask) {
  return !any(!mask);
}

template <int N>
struct Pack {
  using Doubles = typename detail::LaneVectors<N>::Doubles;
  using Integers = typename detail::LaneVectors<N>::Integers;
  Doubles lane{};

  Pack() = default;
  /// Implicit, as a constant is the same in every lane.
  Pack(double x) : lane(x - Doubles{}) {}  // NOLINT(google-explicit-constructor)
  explicit Pack(const Doubles& x) : lane(x) {}

  Pack& operator+=(const Pack& b) { return *this = *this + b; }
  Pack& operator-=(const Pack& b) { return *this = *this - b; }
  Pack& operator*=(const Pack& b) { return *this = *this * b; }

  friend Pack operator+(const Pack& a, const Pack& b) { return Pack(Doubles(a.lane + b.lane)); }
  friend Pack operator-(const Pack& a, const Pack& b) { return Pack(Doubles(a.lane - b.lane)); }
  friend Pack operator*(const Pack& a, const Pack& b) { return Pack(Doubles(a.lane * b.lane)); }
  friend Pack operator/(const Pack& a, const Pack& b) { return Pack(Doubles(a.lane / b.lane)); }
  friend Pack operator-(const Pack& a) { return Pack(Doubles(-a.lane)); }

  friend Mask<N> operator<(const Pack& a, const Pack& b) { return Mask<N>::less(a.lane, b.lane); }
  friend Mask<N> operator<=(const Pack& a, const Pack& b) {
    return Mask<N>::less_equal(a.lane, b.lane);
  }
  friend Mask<N> operator>(const Pack& a, const Pack& b) { return b < a; }
  friend Mask<N> operator>=(const Pack& a, const Pack& b) { return b <= a; }

  friend Pack select(const Mask<N>& mask, const Pack& yes, const Pack& no) {
    return Pack(mask.blend(yes.lane, no.lane));
  }

  friend Pack abs(const Pack& a) {
    const Integers rest = Integers{} + INT64_MAX;
    return Pack((Doubles)((Integers)a.lane & rest));
  }
  /// |a| with the sign of b.
  friend Pack copysign(const Pack& a, const Pack& b) {
    const Integers sign = Integers{} + INT64_MIN;
    return Pack((Doubles)(((Integers)a.lane & ~sign) | ((Integers)b.lane & sign)));
  }
  /// 2^k for integers -1022 <= k <= 1023.
  friend Pack power_of_two(const Pack& k) {
    return Pack((Doubles)(((Integers)(k + kRounder).lane + 1023) << 52));
  }
  /// The parts of a normal x > 0: its mantissa in [1, 2), the bits of its exponent.
  friend Pack mantissa_of(const Pack& x) {
    return Pack((Doubles)(((Integers)x.lane & 0xfffffffffffff) | 0x3ff0000000000000));
  }
  friend Pack biased_exponent_of(const Pack& x) {
    const Pack rounder(kRounder);
    return Pack((Doubles)((Integers)rounder.lane + ((Integers)x.lane >> 52))) - rounder;
  }
  /// x 2^k for k held as k + kRounder, where neither x nor the result leaves the normal numbers.
  friend Pack scaled_by_rounded(const Pack& x, const Pack& k) {
    return Pack((Doubles)((Integers)x.lane + ((Integers)k.lane << 52)));
  }
  /// a b + c, rounded once where the machine can; see point_sum.h for what may use it.
  friend Pack fma(const Pack& a, const Pack& b, const Pack& c) {
#if defined(__AVX512F__)
    if constexpr (N == 8) {
      return Pack((Doubles)_mm512_fmadd_pd((__m512d)a.lane, (__m512d)b.lane, (__m512d)c.lane));
    }
#endif
#if defined(__FMA__)
    if constexpr (N == 4) {
      return Pack((Doubles)_mm256_fmadd_pd((__m256d)a.lane, (__m256d)b.lane, (__m256d)c.lane));
    }
#endif
    return a * b + c;
  }

  /// As std::min and std::max: a, unless b is less or greater.
  friend Pack min(const Pack& a, const Pack& b) {
#if defined(__AVX512F__)
    if constexpr (N == 8) {
      return Pack((Doubles)_mm512_maskz_min_pd(0xff, (__m512d)b.lane, (__m512d)a.lane));
    }
#endif
#if defined(__AVX__)
    if constexpr (N == 4) return Pack((Doubles)_mm256_min_pd((__m256d)b.lane, (__m256d)a.lane));
#endif
#if defined(__SSE2__)
    if constexpr (N == 2) return Pack((Doubles)_mm_min_pd((__m128d)b.lane, (__m128d)a.lane));
#endif
    return select(b < a, b, a);
  }
  friend Pack max(const Pack& a, const Pack& b) {
#if defined(__AVX512F__)
    if constexpr (N == 8) {
      return Pack((Doubles)_mm512_maskz_max_pd(0xff, (__m512d)b.lane, (__m512d)a.lane));
    }
#endif
#if defined(__AVX__)
    if constexpr (N == 4) return Pack((Doubles)_mm256_max_pd((__m256d)b.lane, (__m256d)a.lane));
#endif
#if defined(__SSE2__)
    if constexpr (N == 2) return Pack((Doubles)_mm_max_pd((__m128d)b.lane, (__m128d)a.lane));
#endif
    return select(a < b, b, a);
  }

  friend Pack sqrt(const Pack& a) {
#if defined(__AVX512F__)
    if constexpr (N == 8) return Pack((Doubles)_mm512_maskz_sqrt_pd(0xff, (__m512d)a.lane));
#endif
#if defined(__AVX__)
    if constexpr (N == 4) return Pack((Doubles)_mm256_sqrt_pd((__m256d)a.lane));
#endif
#if defined(__SSE2__)
    if constexpr (N == 2) return Pack((Doubles)_mm_sqrt_pd((__m128d)a.lane));
#endif
    Pack root;
    for (int i = 0; i < N; ++i) root.lane[i] = __builtin_sqrt(a.lane[i]);
    return root;
  }
};

template <int N>
struct LanesOf<Pack<N>> {
  using Number = double;
  using Mask = cs2mesh::Mask<N>;
};

namespace detail {

/// Lane i is element index(i) of a, or of b from N on.
template <int N, class Index, int... I>
Pack<N> shuffled(const Pack<N>& a, const Pack<N>& b, Index, std::integer_sequence<int, I...>) {
  return Pack<N>(__builtin_shufflevector(a.lane, b.lane, Index::of(I)...));
}

/// Half of the lanes of a and b, taken alternately in groups.
template <int N, int Group, int Half>
struct Zip {
  static constexpr int of(int i) {
    const int place = i + Half * N;
    const int group = place / Group;
    return (group % 2) * N + (group / 2) * Group + place % Group;
  }
};

/// Every third element, from number First on, of three packs in a row: those found in the first two
/// packs, then the others.
template <int N, int First>
struct Third {
  struct Front {
    static constexpr int of(int i) { return 3 * i + First < 2 * N ? 3 * i + First : 0; }
  };
  struct Back {
    static constexpr int of(int i) { return 3 * i + First < 2 * N ? i : 3 * i + First - N; }
  };
};

template <int N, int First>
Pack<N> every_third(const Pack<N> (&rows)[3]) {
  using Lanes = std::make_integer_sequence<int, N>;
  const Pack<N> front = shuffled(rows[0], rows[1], typename Third<N, First>::Front{}, Lanes{});
  return shuffled(front, rows[2], typename Third<N, First>::Back{}, Lanes{});
}

}  // namespace detail

/// N vectors, one a lane.
template <int N>
Vec3<Pack<N>> load(const Vec3d* vectors) {
  static_assert(sizeof(Vec3d) == 3 * sizeof(double));
  const auto* stored = reinterpret_cast<const typename detail::LaneVectors<N>::Stored*>(vectors);
  Pack<N> rows[3];
  for (int i = 0; i < 3; ++i) rows[i].lane = stored[i].lane;
  return {detail::every_third<N, 0>(rows), detail::every_third<N, 1>(rows),
          detail::every_third<N, 2>(rows)};
}

/// Adds the number in each lane to one of N sums.
template <int N>
void add_to(const Pack<N>& value, double* sums) {
  reinterpret_cast<typename detail::LaneVectors<N>::Stored*>(sums)->lane += value.lane;
}

/// Adds the jet of each lane to one of N sums.
template <int N>
void add_to(const JetOf<Pack<N>>& jet, Jet* sums) {
  static_assert(sizeof(Jet) == 4 * sizeof(double));
  using Lanes = std::make_integer_sequence<int, N>;
  auto* stored = reinterpret_cast<typename detail::LaneVectors<N>::Stored*>(sums);
  const auto zip = [](const auto& a, const auto& b, auto index) {
    return detail::shuffled(a, b, index, Lanes{});
  };
  const Vec3<Pack<N>>& g = jet.gradient;
  const Pack<N> vx0 = zip(jet.value, g.x, detail::Zip<N, 1, 0>{});
  const Pack<N> vx1 = zip(jet.value, g.x, detail::Zip<N, 1, 1>{});
  const Pack<N> yz0 = zip(g.y, g.z, detail::Zip<N, 1, 0>{});
  const Pack<N> yz1 = zip(g.y, g.z, detail::Zip<N, 1, 1>{});
  stored[0].lane += zip(vx0, yz0, detail::Zip<N, 2, 0>{}).lane;
  stored[1].lane += zip(vx0, yz0, detail::Zip<N, 2, 1>{}).lane;
  stored[2].lane += zip(vx1, yz1, detail::Zip<N, 2, 0>{}).lane;
  stored[3].lane += zip(vx1, yz1, detail::Zip<N, 2, 1>{}).lane;
}

}  // namespace cs2mesh
