// Two packs as one. The closed forms are long chains of dependent operations: a second, independent
// chain fills the time that the first one waits.
#pragma once

#include "libfield/simd/pack.h"

namespace cs2mesh {

/// A truth value a lane of both halves.
template <class M>
struct TwiceMask {
  M first, second;

  TwiceMask(const M& a, const M& b) : first(a), second(b) {}
  explicit TwiceMask(bool everywhere) : first(everywhere), second(everywhere) {}

  friend TwiceMask operator&(const TwiceMask& a, const TwiceMask& b) {
    return {a.first & b.first, a.second & b.second};
  }
  friend TwiceMask operator|(const TwiceMask& a, const TwiceMask& b) {
    return {a.first | b.first, a.second | b.second};
  }
  friend TwiceMask operator^(const TwiceMask& a, const TwiceMask& b) {
    return {a.first ^ b.first, a.second ^ b.second};
  }
  friend TwiceMask operator!(const TwiceMask& a) { return {!a.first, !a.second}; }
  friend bool any(const TwiceMask& a) { return any(a.first | a.second); }
  friend bool all(const TwiceMask& a) { return !any(!a); }
};

/// A number a lane of both halves, each a pack T.
template <class T>
struct Twice {
  using Mask = TwiceMask<MaskOf<T>>;
  T first, second;

  Twice() = default;
  /// Implicit, as a constant is the same in every lane.
  Twice(double x) : first(x), second(x) {}  // NOLINT(google-explicit-constructor)
  Twice(const T& a, const T& b) : first(a), second(b) {}

  Twice& operator+=(const Twice& b) { return *this = *this + b; }
  Twice& operator-=(const Twice& b) { return *this = *this - b; }
  Twice& operator*=(const Twice& b) { return *this = *this * b; }

  friend Twice operator+(const Twice& a, const Twice& b) {
    return {a.first + b.first, a.second + b.second};
  }
  friend Twice operator-(const Twice& a, const Twice& b) {
    return {a.first - b.first, a.second - b.second};
  }
  friend Twice operator*(const Twice& a, const Twice& b) {
    return {a.first * b.first, a.second * b.second};
  }
  friend Twice operator/(const Twice& a, const Twice& b) {
    return {a.first / b.first, a.second / b.second};
  }
  friend Twice operator-(const Twice& a) { return {-a.first, -a.second}; }

  friend Mask operator<(const Twice& a, const Twice& b) {
    return {a.first < b.first, a.second < b.second};
  }
  friend Mask operator<=(const Twice& a, const Twice& b) {
    return {a.first <= b.first, a.second <= b.second};
  }
  friend Mask operator>(const Twice& a, const Twice& b) { return b < a; }
  friend Mask operator>=(const Twice& a, const Twice& b) { return b <= a; }

  friend Twice select(const Mask& mask, const Twice& yes, const Twice& no) {
    return {select(mask.first, yes.first, no.first), select(mask.second, yes.second, no.second)};
  }

  // As those of a pack.
  friend Twice abs(const Twice& a) { return {abs(a.first), abs(a.second)}; }
  friend Twice sqrt(const Twice& a) { return {sqrt(a.first), sqrt(a.second)}; }
  friend Twice copysign(const Twice& a, const Twice& b) {
    return {copysign(a.first, b.first), copysign(a.second, b.second)};
  }
  friend Twice mantissa_of(const Twice& x) { return {mantissa_of(x.first), mantissa_of(x.second)}; }
  friend Twice biased_exponent_of(const Twice& x) {
    return {biased_exponent_of(x.first), biased_exponent_of(x.second)};
  }
  friend Twice scaled_by_rounded(const Twice& x, const Twice& k) {
    return {scaled_by_rounded(x.first, k.first), scaled_by_rounded(x.second, k.second)};
  }

  friend Twice fma(const Twice& a, const Twice& b, const Twice& c) {
    return {fma(a.first, b.first, c.first), fma(a.second, b.second, c.second)};
  }
  friend Twice min(const Twice& a, const Twice& b) {
    return {min(a.first, b.first), min(a.second, b.second)};
  }
  friend Twice max(const Twice& a, const Twice& b) {
    return {max(a.first, b.first), max(a.second, b.second)};
  }
  friend Twice power_of_two(const Twice& k) {
    return {power_of_two(k.first), power_of_two(k.second)};
  }
};

template <class T>
struct LanesOf<Twice<T>> {
  using Number = double;
  using Mask = TwiceMask<MaskOf<T>>;
};

}  // namespace cs2mesh
