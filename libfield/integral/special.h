// Special functions that the standard library lacks.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace cs2mesh {

/// The polynomial sum of c[k] z^k by two interleaved Horner chains: half the latency of one.
template <class T, std::size_t N>
constexpr T polynomial(const std::array<double, N>& c, const T& z) {
  static_assert(N % 2 == 0 && N >= 2);
  const T z2 = z * z;
  T even(c[N - 2]);
  T odd(c[N - 1]);
  for (std::size_t k = N - 2; k >= 2; k -= 2) {
    even = even * z2 + c[k - 2];
    odd = odd * z2 + c[k - 1];
  }
  return even + odd * z;
}

/// The same by fused steps: fewer where the machine has them, slow where it has not.
template <class T, std::size_t N>
T fused_polynomial(const std::array<double, N>& c, const T& z) {
  using std::fma;
  static_assert(N % 2 == 0 && N >= 2);
  const T z2 = z * z;
  T even(c[N - 2]);
  T odd(c[N - 1]);
  for (std::size_t k = N - 2; k >= 2; k -= 2) {
    even = fma(even, z2, T(c[k - 2]));
    odd = fma(odd, z2, T(c[k - 1]));
  }
  return fma(odd, z, even);
}

namespace detail {
inline constexpr std::array<double, 26> kErfcxPowers = {
#include "libfield/integral/erfcx_table.inc"
};
inline constexpr std::array<double, 26> kErfcxFirst = {
#include "libfield/integral/erfcx_first_table.inc"
};
inline constexpr std::array<double, 26> kErfcxSecond = {
#include "libfield/integral/erfcx_second_table.inc"
};
inline constexpr std::array<double, 14> kSmallErf = {
#include "libfield/integral/small_erf_table.inc"
};
}  // namespace detail

/// erf(x) for 0 <= x <= 1, within 2 ulp.
template <class T>
T small_erf(const T& x) {
  return x + x * polynomial(detail::kSmallErf, T(x * x));
}

/// The scaled complementary error function exp(x^2) erfc(x) for x >= 0, within 7e-16 of its size;
/// finite up to the greatest double. (1 + 2x) erfcx(x) varies by an eighth over the whole half
/// line, which t = (x - 3) / (x + 3) maps to [-1, 1], where a polynomial of degree 25 suffices
/// (Shepherd and Laframboise 1981).
template <class T>
T erfcx(const T& x) {
  const T t = T(1) - T(6) / (x + T(3));
  return polynomial(detail::kErfcxPowers, t) / (T(1) + T(2) * x);
}

/// Ik = int_0^inf u^k exp(-2 x u - u^2) du for k = 0, 1, 2 and x >= 0.
template <class T>
struct ErfcxMoments {
  T i0, i1, i2;
};

/// Each within 3e-15 of its size: polynomials in the t of erfcx() give (1 + x)^2 I1, (1 + x)^3 I2,
/// and I0 = sqrt(pi) / 2 erfcx(x) = 2 x I1 + 2 I2, by parts, has no difference.
template <class T>
ErfcxMoments<T> erfcx_moments(const T& x) {
  const T t = T(1) - T(6) / (x + T(3));
  const T w = T(1) / (T(1) + x);
  const T i1 = polynomial(detail::kErfcxFirst, t) * (w * w);
  const T i2 = polynomial(detail::kErfcxSecond, t) * (w * w * w);
  return {T(2) * (x * i1 + i2), i1, i2};
}

}  // namespace cs2mesh
