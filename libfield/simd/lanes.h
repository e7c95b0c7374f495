// One source for formulas over one number and over packs of numbers: choices are made lane by lane.
// A plain number is a pack of one lane whose mask is a bool, so that for it everything here folds
// into ordinary branches. pack.h has the same functions for packs.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>

#include "libfield/base/jet.h"

namespace cs2mesh {

/// The number type of a lane, and what a comparison gives.
template <class T>
struct LanesOf {
  using Number = T;
  using Mask = bool;
};
template <class T>
using MaskOf = typename LanesOf<T>::Mask;

/// Number types as wide as double switch to quadrature where a closed form cancels; wider ones
/// have the digits to spare and use the closed form alone.
template <class T>
inline constexpr bool kIsDouble = std::is_same_v<typename LanesOf<T>::Number, double>;

/// 1.5 * 2^52, whose unit in the last place is 1: x + kRounder holds x rounded to an integer in its
/// low bits.
inline constexpr double kRounder = 0x1.8p52;

/// 2^k for integers -1022 <= k <= 1023.
inline double power_of_two(double k) {
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(k + kRounder) + 1023) << 52);
}

/// The parts of a normal x > 0: its mantissa in [1, 2), the bits of its exponent.
inline double mantissa_of(double x) {
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(x) & 0xfffffffffffff) |
                               0x3ff0000000000000);
}
inline double biased_exponent_of(double x) {
  return static_cast<double>(std::bit_cast<std::uint64_t>(x) >> 52);
}

/// x 2^k for k held as k + kRounder, where neither x nor the result leaves the normal numbers.
inline double scaled_by_rounded(double x, double k) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) +
                               (std::bit_cast<std::uint64_t>(k) << 52));
}

/// Whether any, or every, lane is set.
constexpr bool any(bool mask) {
  return mask;
}
constexpr bool all(bool mask) {
  return mask;
}

/// The lanes that are set in all of them. (Comparisons of wide number types are calls, between
/// which compilers want no `&`.)
template <class M, class... Others>
constexpr M both(const M& a, const Others&... others) {
  M all_of(a);
  ((all_of = all_of & others), ...);
  return all_of;
}

/// `yes` in the lanes that are set, `no` in the others.
template <class T>
constexpr T select(bool mask, const T& yes, const T& no) {
  return mask ? yes : no;
}
template <class M, class T>
requires(!std::is_same_v<M, bool>) Vec3<T> select(const M& mask, const Vec3<T>& yes,
                                                  const Vec3<T>& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
template <class M, class T>
requires(!std::is_same_v<M, bool>) JetOf<T> select(const M& mask, const JetOf<T>& yes,
                                                   const JetOf<T>& no) {
  return {select(mask, yes.value, no.value), select(mask, yes.gradient, no.gradient)};
}

/// 1 / a and 1 / b, within 2 ulp, by one division, which is what closed forms spend most of their
/// time on. Numbers beyond 1e150 count as that.
template <class T>
struct Reciprocals {
  T of_a, of_b;

  Reciprocals(const T& a, const T& b) {
    using std::min;
    const T greatest(1e150);
    const T x = min(a, greatest), y = min(b, greatest);
    const T both = T(1) / (x * y);
    of_a = y * both;
    of_b = x * both;
  }
};

/// Collects a result whose formula differs from lane to lane. Each lane takes the first formula
/// offered to it; a formula that no lane takes is not evaluated. There is a select() for R.
template <class T, class R>
class FirstOf {
 public:
  explicit FirstOf(const MaskOf<T>& lanes = MaskOf<T>(true)) : left_(lanes) {}

  /// Offers `formula` to the lanes of `where`; true once every lane has taken one.
  template <class Formula>
  bool take(const MaskOf<T>& where, const Formula& formula) {
    const MaskOf<T> here = where & left_;
    if (any(here)) {
      result_ = select(here, formula(), result_);
      left_ = left_ & !here;
    }
    return !any(left_);
  }
  /// Gives `formula` to all lanes that remain.
  template <class Formula>
  R otherwise(const Formula& formula) {
    return any(left_) ? select(left_, formula(), result_) : result_;
  }
  /// The lanes without a result.
  const MaskOf<T>& left() const { return left_; }
  /// Zero in the lanes without a result.
  const R& result() const { return result_; }

 private:
  R result_{};
  MaskOf<T> left_;
};

}  // namespace cs2mesh
