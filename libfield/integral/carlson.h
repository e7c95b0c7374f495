// Elliptic integrals in Carlson's symmetric forms, by his duplication theorem (Carlson 1995,
// "Numerical computation of real or complex elliptic integrals"; DLMF 19.26 and 19.36):
//     RF(x, y, z) = (1/2) int_0^inf dt / sqrt((t + x) (t + y) (t + z)),
//     RD(x, y, z) = (3/2) int_0^inf dt / ((t + z) sqrt((t + x) (t + y) (t + z))).
// Every term is positive, so no digits are lost for any arguments.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libfield/simd/lanes.h"

namespace cs2mesh {

template <class T>
struct CarlsonPair {
  T rf{}, rd{};
};

namespace detail {

// How far apart, in parts of their mean, duplication leaves the arguments. Then a power series of
// the deviations |X|, |Y|, |Z| <= d serves to the seventh degree. RF and RD are means of
// (1 - (aX + bY + cZ))^-p over weights a + b + c = 1, with p = 1/2 and 3/2, so that what follows
// the seventh degree is below the sum of (p)_n / n! d^n from n = 8 on: 1.2e-18 for RF and 2e-17
// for RD (whose series is a small part of the whole), and 1e-101 for wide numbers.
template <class T>
inline constexpr double kCarlsonSpread = kIsDouble<T> ? 0.007 : 2e-13;

/// Each of the arguments becomes (it + lambda) / 4; what RD leaves behind at each step adds up.
template <class T>
struct CarlsonStep {
  T x, y, z;
  T sum{}, power = T(1);  ///< sum of 4^-n / (sqrt(z) (z + lambda)); 4^-n

  MaskOf<T> spread() const {
    using std::max;
    using std::min;
    const T greatest = max(x, max(y, z)), least = min(x, min(y, z));
    return greatest - least > T(kCarlsonSpread<T>) * greatest;
  }
  CarlsonStep next() const {
    using std::sqrt;
    const T rx = sqrt(x), ry = sqrt(y), rz = sqrt(z);
    const T lambda = rx * ry + rz * (rx + ry);
    const T quarter(0.25);
    return {quarter * (x + lambda), quarter * (y + lambda), quarter * (z + lambda),
            sum + power / (rz * (z + lambda)), quarter * power};
  }
  friend CarlsonStep select(const MaskOf<T>& mask, const CarlsonStep& yes, const CarlsonStep& no) {
    return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z),
            select(mask, yes.sum, no.sum), select(mask, yes.power, no.power)};
  }
};

/// RF of arguments close together: DLMF 19.36.1.
template <class T>
T carlson_rf_series(const T& x, const T& y, const T& z) {
  using std::sqrt;
  const T mean = (x + y + z) / T(3), inverse = T(1) / mean;
  const T dx = (mean - x) * inverse, dy = (mean - y) * inverse, dz = -(dx + dy);
  const T e2 = dx * dy - dz * dz, e3 = dx * dy * dz;
  const T e22 = e2 * e2, e23 = e2 * e3;
  const T rest = (e22 / T(24) - e2 / T(10)) + (e3 / T(14) - T(3) / T(44) * e23) +
                 (T(3) / T(104) * e3 * e3 - T(5) / T(208) * e22 * e2 + e2 * e23 / T(16));
  return (T(1) + rest) / sqrt(mean);
}

/// RD of arguments close together: DLMF 19.36.2.
template <class T>
T carlson_rd_series(const T& x, const T& y, const T& z) {
  using std::sqrt;
  const T mean = (x + y + T(3) * z) / T(5), inverse = T(1) / mean;
  const T dx = (mean - x) * inverse, dy = (mean - y) * inverse, dz = -(dx + dy) / T(3);
  const T xy = dx * dy, zz = dz * dz;
  const T e2 = xy - T(6) * zz, e3 = (T(3) * xy - T(8) * zz) * dz;
  const T e4 = T(3) * (xy - zz) * zz, e5 = xy * zz * dz;
  const T e22 = e2 * e2;
  const T low = e3 / T(6) - T(3) / T(14) * e2 + T(9) / T(88) * e22 - T(3) / T(22) * e4;
  const T middle = T(3) / T(26) * e5 - T(9) / T(52) * e2 * e3;
  const T high = T(3) / T(40) * e3 * e3 + T(3) / T(20) * e2 * e4 - e22 * e2 / T(16) +
                 T(45) / T(272) * e22 * e3 - T(9) / T(68) * (e3 * e4 + e2 * e5);
  return (T(1) + (low + middle + high)) * (inverse / sqrt(mean));
}

}  // namespace detail

/// RF and RD of x, y >= 0 and z > 0, x and y not both 0: within some 3 ulp, as far as their
/// products and ratios are normal numbers. The steps are about log4 of log2 of the ratios of the
/// arguments, and four more.
template <class T>
CarlsonPair<T> carlson(const T& x, const T& y, const T& z) {
  detail::CarlsonStep<T> at{x, y, z};
  // Each step brings ratios to their square roots and then differences to a quarter: no ratio of
  // normal numbers takes more than this.
  constexpr int kMostSteps = kIsDouble<T> ? 24 : 80;
  for (int i = 0; i < kMostSteps; ++i) {
    const MaskOf<T> spread = at.spread();
    if (!any(spread)) break;
    at = select(spread, at.next(), at);
  }
  return {detail::carlson_rf_series(at.x, at.y, at.z),
          T(3) * at.sum + at.power * detail::carlson_rd_series(at.x, at.y, at.z)};
}

namespace detail {

template <class T>
T half_pi() {
  if constexpr (kIsDouble<T>) {
    return T(0.5 * std::numbers::pi);
  } else {
    using std::acos;
    return acos(T(0));
  }
}

/// int dpsi / sqrt(u) and int m cos^2 psi / u^(3/2) dpsi, u = m cos^2 psi + q sin^2 psi, over a
/// quarter turn, 0 < m <= q: RF(0, q, m) and m RD(0, q, m) / 3, by the arithmetic-geometric mean
/// (DLMF 19.8) in a third of the time. Where m / q is small the second loses as many digits as its
/// share of the first has zeros.
template <class T>
CarlsonPair<T> carlson_quarter(const T& m, const T& q) {
  using std::sqrt;
  T a = sqrt(q), g = sqrt(m);
  // With c_n = (a_(n-1) - g_(n-1)) / 2, c_(n+1) = c_n^2 / (4 a_(n+1)), the second is the first
  // times 1/2 - sum 2^(n-1) c_n^2 / (q - m); the first term is (a - g) / (a + g) / 4. From
  // g = 1e-15 a on, eight steps bring g to a.
  T term = T(0.25) * (a - g) / (a + g), sum(0);
  constexpr int kSteps = kIsDouble<T> ? 8 : 14;
  for (int i = 0; i < kSteps; ++i) {
    const T c = T(0.5) * (a - g), mean = T(0.5) * (a + g);
    g = sqrt(a * g);
    a = mean;
    sum += term;
    const T ratio = c / (T(2) * (a + g));
    term = T(2) * term * (ratio * ratio);
  }
  const T first = half_pi<T>() / a;
  return {first, first * (T(0.5) - sum)};
}

}  // namespace detail
}  // namespace cs2mesh
