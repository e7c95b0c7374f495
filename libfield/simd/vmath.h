// Elementary functions of packs, each within 2 ulp, the same bits on every machine.
//
// Legend: M = 1.5 * 2^52, whose unit in the last place is 1: x + M holds x rounded to an integer in
// its low bits; k the power of two taken out of an exponential, r the rest, |r| <= ln 2 / 2.
#pragma once

#include <array>

#include "libfield/integral/special.h"
#include "libfield/simd/pack.h"

namespace cs2mesh {
namespace detail {

inline constexpr double kRounder = 0x1.8p52;
inline constexpr double kLog2E = 0x1.71547652b82fep0;
/// ln 2 in two parts; products of the first with k are exact.
inline constexpr double kLn2High = 0x1.62e42feep-1, kLn2Low = 0x1.a39ef35793c76p-33;
/// 1 / (k + 2)!; what follows is below 2e-17 of exp(r) - 1.
inline constexpr std::array<double, 12> kExponential = {
    1.0 / 2,     1.0 / 6,      1.0 / 24,      1.0 / 120,      1.0 / 720,       1.0 / 5040,
    1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};
inline constexpr std::array<double, 14> kArctan = {
#include "libfield/integral/arctan_table.inc"
};
/// pi / 4 in two parts; products of the first with 2, 3, 4 are exact.
inline constexpr double kQuarterPiHigh = 0x1.921fb54442d00p-1,
                        kQuarterPiLow = 0x1.8469898cc5170p-49;
/// Just above tan(1 / 2): what is added to pi / 4 stays below its last places.
inline constexpr double kMiddle = 35.0 / 64.0;

/// 2^k for integers -1022 <= k <= 1023.
template <int N>
Pack<N> power_of_two(const Pack<N>& k) {
  using Doubles = typename Pack<N>::Doubles;
  using Integers = typename Pack<N>::Integers;
  return Pack<N>((Doubles)(((Integers)(k + kRounder).lane + 1023) << 52));
}

/// exp(x) = 2^k (1 + rest).
template <int N>
struct Exponential {
  Pack<N> k, rest;

  explicit Exponential(const Pack<N>& x) {
    k = (x * kLog2E + kRounder) - kRounder;
    const Pack<N> r = (x - k * kLn2High) - k * kLn2Low;
    rest = r + r * r * polynomial(kExponential, r);
  }
};

}  // namespace detail

/// e^x; within 1 ulp where that is no subnormal number.
template <int N>
Pack<N> exp(const Pack<N>& x) {
  const Pack<N> kept = max(min(x, Pack<N>(720.0)), Pack<N>(-760.0));
  const detail::Exponential<N> e(kept);
  // In two steps: 2^k itself may be out of range.
  const Pack<N> half = (0.5 * e.k + detail::kRounder) - detail::kRounder;
  return (1.0 + e.rest) * detail::power_of_two(half) * detail::power_of_two(e.k - half);
}

/// e^x - 1 for x <= 700, within 2 ulp.
template <int N>
Pack<N> expm1(const Pack<N>& x) {
  const detail::Exponential<N> e(max(x, Pack<N>(-60.0)));
  const Pack<N> power = detail::power_of_two(e.k);
  return power * e.rest + (power - 1.0);
}

/// The angle of (x, y) in [-pi, pi], within 2 ulp; x and y finite and not both 0. A zero counts as
/// positive as an x, and gives its sign to the result as a y.
template <int N>
Pack<N> atan2(const Pack<N>& y, const Pack<N>& x) {
  const Pack<N> ax = abs(x), ay = abs(y);
  const auto steep = ax < ay;
  const Pack<N> least = select(steep, ax, ay), greatest = select(steep, ay, ax);
  // Near the diagonal, arctan(t) = pi / 4 + arctan((t - 1) / (t + 1)).
  const auto middle = detail::kMiddle * greatest < least;
  const Pack<N> z =
      select(middle, least - greatest, least) / select(middle, least + greatest, greatest);
  const Pack<N> w = z * z;
  const Pack<N> arctan = z + z * (w * polynomial(detail::kArctan, w));
  // The angle is `quarters` pi / 4 +- arctan.
  const auto left = x < Pack<N>(0.0);
  Pack<N> quarters = select(middle, Pack<N>(1.0), Pack<N>(0.0));
  quarters = select(steep, 2.0 - quarters, quarters);
  quarters = select(left, 4.0 - quarters, quarters);
  const Pack<N> turned = select(steep ^ left, -arctan, arctan);
  return copysign(quarters * detail::kQuarterPiHigh + (quarters * detail::kQuarterPiLow + turned),
                  y);
}

}  // namespace cs2mesh
