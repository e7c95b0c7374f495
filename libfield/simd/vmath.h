// Elementary functions of doubles and packs, each within 2 ulp, the same bits one at a time, in
// packs and on every machine. (The C library's differ between machines.) Wider number types go to
// functions of their own library.
//
// Legend: k the power of two taken out of an exponential, r the rest, |r| <= ln 2 / 2.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libfield/integral/special.h"
#include "libfield/simd/lanes.h"

namespace cs2mesh::vmath {
namespace detail {

inline constexpr double kLog2E = 0x1.71547652b82fep0;
/// ln 2 in two parts; products of the first with k are exact.
inline constexpr double kLn2High = 0x1.62e42feep-1, kLn2Low = 0x1.a39ef35793c76p-33;
/// 1 / (k + 2)!; what follows is below 2e-17 of exp(r) - 1.
inline constexpr std::array<double, 12> kExponential = {
    1.0 / 2,     1.0 / 6,      1.0 / 24,      1.0 / 120,      1.0 / 720,       1.0 / 5040,
    1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};
/// 2^r for |r| <= 1/2, within 4e-18 of it (least greatest error).
inline constexpr std::array<double, 12> kPowerOfTwo = {
#include "libfield/integral/exp2_table.inc"
};
/// (artanh(z) / z - 1) / z^2 by powers of z^2 <= (3 - 2 sqrt(2))^2: what follows is below 1e-18.
inline constexpr std::array<double, 12> kArtanh = {1.0 / 3,  1.0 / 5,  1.0 / 7,  1.0 / 9,
                                                   1.0 / 11, 1.0 / 13, 1.0 / 15, 1.0 / 17,
                                                   1.0 / 19, 1.0 / 21, 1.0 / 23, 1.0 / 25};
inline constexpr std::array<double, 14> kArctan = {
#include "libfield/integral/arctan_table.inc"
};
/// And for |z| just above tan(pi / 8), where half of the angles are taken from pi / 4.
inline constexpr std::array<double, 10> kShortArctan = {
#include "libfield/integral/short_arctan_table.inc"
};
inline constexpr double kTanEighth = 0.41421356237309505;
/// pi / 4 in two parts; products of the first with 2, 3, 4 are exact.
inline constexpr double kQuarterPiHigh = 0x1.921fb54442d00p-1,
                        kQuarterPiLow = 0x1.8469898cc5170p-49;
/// Just above tan(1 / 2): what is added to pi / 4 stays below its last places.
inline constexpr double kMiddle = 35.0 / 64.0;

/// A normal x > 0 as mantissa 2^exponent, 1 <= mantissa < 2.
template <class T>
struct BinaryParts {
  T mantissa, exponent;

  explicit BinaryParts(const T& x)
      : mantissa(mantissa_of(x)), exponent(T(biased_exponent_of(x)) - T(1023)) {}
};

/// exp(x) = 2^k (1 + rest).
template <class T>
struct Exponential {
  T k, rest;

  explicit Exponential(const T& x) {
    k = (x * T(kLog2E) + T(kRounder)) - T(kRounder);
    const T r = (x - k * T(kLn2High)) - k * T(kLn2Low);
    rest = r + r * r * polynomial(kExponential, r);
  }
};

/// arctan(z), |z| <= kMiddle.
template <class T>
T small_arctan(const T& z) {
  const T w = z * z;
  return z + z * (w * polynomial(kArctan, w));
}

}  // namespace detail

/// e^x; within 1 ulp where that is no subnormal number.
template <class T>
T exp(const T& x) {
  if constexpr (kIsDouble<T>) {
    using std::max;
    using std::min;
    const detail::Exponential<T> e(max(min(x, T(720)), T(-760)));
    // In two steps: 2^k itself may be out of range.
    const T half = (T(0.5) * e.k + T(kRounder)) - T(kRounder);
    return (T(1) + e.rest) * power_of_two(half) * power_of_two(T(e.k - half));
  } else {
    using std::exp;
    return exp(x);
  }
}

/// 2^x for -1022 <= x <= 1023, within 2 ulp (1 with fma()), so its last bit differs between
/// machines.
template <class T>
T exp2(const T& x) {
  using std::fma;
  const T shifted = x + T(kRounder);
  const T r = x - (shifted - T(kRounder));
  // Horner's scheme: sources side by side fill the time that its steps wait for one another.
  const auto& c = detail::kPowerOfTwo;
  T sum(c.back());
  for (std::size_t i = c.size() - 1; i-- > 0;) sum = fma(sum, r, T(c[i]));
  return scaled_by_rounded(sum, shifted);
}

/// e^x - c for x <= 700 and c = 0 or 1, within 2 ulp; from -60 down as at -60.
template <class T>
T exp_less(const T& x, const T& c) {
  using std::max;
  const detail::Exponential<T> e(max(x, T(-60)));
  const T power = power_of_two(e.k);
  return power * e.rest + (power - c);
}

/// e^x - 1 for x <= 700, within 2 ulp.
template <class T>
T expm1(const T& x) {
  if constexpr (kIsDouble<T>) {
    return exp_less(x, T(1));
  } else {
    using std::expm1;
    return expm1(x);
  }
}

/// The natural logarithm of a normal x > 0 from the quotient of two numbers, for those who can have
/// that quotient together with others.
template <class T>
struct Logarithm {
  T exponent, numerator, denominator;

  /// x = 2^k m, m within sqrt(2) of 1; log m = 2 artanh((m - 1) / (m + 1)).
  explicit Logarithm(const T& x) {
    const detail::BinaryParts<T> parts(x);
    const auto upper = T(std::numbers::sqrt2) < parts.mantissa;
    const T m = select(upper, T(T(0.5) * parts.mantissa), parts.mantissa);
    exponent = parts.exponent + select(upper, T(1), T(0));
    numerator = m - T(1);
    denominator = m + T(1);
  }
  /// From z = numerator / denominator.
  T at(const T& z) const {
    const T w = z * z;
    const T rest = T(2) * z * (w * polynomial(detail::kArtanh, w));
    return exponent * T(detail::kLn2High) + (exponent * T(detail::kLn2Low) + rest + T(2) * z);
  }
};

/// The natural logarithm of a normal x > 0, within 2 ulp (below 1, within 2e-16 of 1 as well).
template <class T>
T log(const T& x) {
  if constexpr (kIsDouble<T>) {
    const Logarithm<T> parts(x);
    return parts.at(T(parts.numerator / parts.denominator));
  } else {
    using std::log;
    return log(x);
  }
}

/// The angle of (x, y) in [-pi, pi], within 2 ulp; x and y finite and not both 0. A zero counts as
/// positive as an x, and gives its sign to the result as a y.
template <class T>
T atan2(const T& y, const T& x) {
  if constexpr (kIsDouble<T>) {
    using std::abs;
    using std::copysign;
    const T ax = abs(x), ay = abs(y);
    const auto steep = ax < ay;
    const T least = select(steep, ax, ay), greatest = select(steep, ay, ax);
    // Near the diagonal, arctan(t) = pi / 4 + arctan((t - 1) / (t + 1)).
    const auto middle = T(detail::kMiddle) * greatest < least;
    const T arctan = detail::small_arctan(T(select(middle, T(least - greatest), least) /
                                            select(middle, T(least + greatest), greatest)));
    // The angle is `quarters` pi / 4 +- arctan.
    const auto left = x < T(0);
    T quarters = select(middle, T(1), T(0));
    quarters = select(steep, T(T(2) - quarters), quarters);
    quarters = select(left, T(T(4) - quarters), quarters);
    const T turned = select(MaskOf<T>(steep ^ left), T(-arctan), arctan);
    return copysign(
        quarters * T(detail::kQuarterPiHigh) + (quarters * T(detail::kQuarterPiLow) + turned), y);
  } else {
    using std::atan2;
    return atan2(y, x);
  }
}

/// The angle of (x, y) in [0, pi], y >= 0, by fused steps: half of the time of atan2, with an error
/// of at most 6e-16; x and y finite and not both 0.
template <class T>
T upper_angle(const T& y, const T& x) {
  using std::abs;
  using std::fma;
  using std::max;
  using std::min;
  const T ax = abs(x), least = min(ax, y), greatest = max(ax, y);
  // As in atan2().
  const auto middle = T(detail::kTanEighth) * greatest < least;
  const T z =
      select(middle, T(least - greatest), least) / select(middle, T(least + greatest), greatest);
  const T w = z * z;
  const T arctan = fma(T(z * w), fused_polynomial(detail::kShortArctan, w), z);
  const auto steep = ax < y, left = x < T(0);
  T base = select(middle, T(0.25 * std::numbers::pi), T(0));
  base = select(steep, T(T(0.5 * std::numbers::pi) - base), base);
  base = select(left, T(T(std::numbers::pi) - base), base);
  return base + select(MaskOf<T>(steep ^ left), T(-arctan), arctan);
}

/// The greatest integer <= x; x itself from 2^51 on, where few fractions are left.
template <class T>
T floor(const T& x) {
  using std::abs;
  const T nearest = (x + T(kRounder)) - T(kRounder);
  const T below = nearest - select(x < nearest, T(1), T(0));
  return select(abs(x) < T(0x1p51), below, x);
}

namespace detail {

/// (-1)^k pi^n / n!, n = 2k + 1 or 2k: sin and cos of pi z for |z| <= 1/4 to 1e-19.
template <int Odd>
consteval std::array<double, 10> circular() {
  std::array<double, 10> c{};
  long double term = Odd != 0 ? std::numbers::pi_v<long double> : 1.0L;
  for (std::size_t k = 0; k < c.size(); ++k) {
    c[k] = static_cast<double>(term);
    const long double n = 2.0L * static_cast<long double>(k) + (Odd != 0 ? 2.0L : 1.0L);
    term *= -std::numbers::pi_v<long double> * std::numbers::pi_v<long double> / (n * (n + 1.0L));
  }
  return c;
}
inline constexpr std::array<double, 10> kSine = circular<1>(), kCosine = circular<0>();

}  // namespace detail

template <class T>
struct SineCosine {
  T sine, cosine;
};

/// sin and cos of pi x, within 3e-16; those of 0 from 2^50 on, where few fractions are left.
template <class T>
SineCosine<T> sin_cos_pi(const T& x) {
  using std::abs;
  // x = quarters / 2 + z, exactly.
  const T known = select(abs(x) < T(0x1p50), x, T(0));
  const T quarters = (T(2) * known + T(kRounder)) - T(kRounder);
  const T z = known - T(0.5) * quarters;
  const T sine = z * polynomial(detail::kSine, T(z * z));
  const T cosine = polynomial(detail::kCosine, T(z * z));
  const T turned = quarters - T(4) * floor(T(T(0.25) * quarters));  // 0, 1, 2, 3
  const auto swapped = ((T(0.5) < turned) & (turned < T(1.5))) | (T(2.5) < turned);
  const auto left = (T(0.5) < turned) & (turned < T(2.5));
  const T s = select(swapped, cosine, sine), c = select(swapped, sine, cosine);
  return {select(T(1.5) < turned, T(-s), s), select(left, T(-c), c)};
}

}  // namespace cs2mesh::vmath
