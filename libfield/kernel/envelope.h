// What the kernels share to bound themselves.
//
// The derivative of order k of a radial h(r) = g(r^2) is a symmetric tensor, whose operator norm is
// the greatest |D^k h[e, ..., e]| over unit vectors e (Banach). Along the line p + t e the squared
// distance is a quadratic of t, u' = 2 r c and u'' = 2 with c the cosine between e and the ray from
// the source, so that
//     D^3 h[e, e, e]    = 12 r c g'' + 8 r^3 c^3 g''',
//     D^4 h[e, e, e, e] = 12 g'' + 48 r^2 c^2 g''' + 16 r^4 c^4 g'''':
// polynomials of c, whose greatest values are known.
//
// Over all distances >= r: along a line at distance delta from the source, the Gaussian is itself
// times exp(-a^2 delta^2), and the Cauchy kernel (1 + s^2 delta^2)^-2 times itself, wider by
// p = sqrt(1 + s^2 delta^2). So with t / p held fixed |D^k h| falls while delta grows: the greatest
// value is attained at the distance r itself, in some direction, or along a ray (delta = 0), where
// the derivative of order k + 1 vanishes. Hence the greatest of the norms at r and at those peaks
// beyond r.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace cs2mesh {

/// `bound` >= 0 widened by 1e-12 of itself: far above the rounding of any kernel's few operations.
inline double rounded_up(double bound) {
  return bound * (1.0 + 1e-12);
}

/// max |D^3 h[e, e, e]| over unit e at distance r from the derivatives of g by u.
inline double third_derivative_norm(double r, double g2, double g3) {
  const double linear = 12.0 * r * g2;
  const double cubic = 8.0 * r * r * r * g3;
  double most = std::abs(linear + cubic);
  // c (linear + cubic c^2) turns at c^2 = -linear / (3 cubic).
  if (linear * cubic < 0.0 && std::abs(linear) < 3.0 * std::abs(cubic)) {
    most = std::max(most, std::abs(linear) * (2.0 / 3.0) * std::sqrt(-linear / (3.0 * cubic)));
  }
  return most;
}

/// max |D^4 h[e, e, e, e]| over unit e, likewise.
inline double fourth_derivative_norm(double r, double g2, double g3, double g4) {
  const double constant = 12.0 * g2;
  const double linear = 48.0 * (r * r) * g3;
  const double square = 16.0 * (r * r) * (r * r) * g4;
  double most = std::max(std::abs(constant), std::abs(constant + linear + square));
  // In w = c^2 it turns at w = -linear / (2 square).
  if (linear * square < 0.0 && std::abs(linear) < 2.0 * std::abs(square)) {
    most = std::max(most, std::abs(constant - linear * linear / (4.0 * square)));
  }
  return most;
}

/// The greatest norm(x) at x and at the `peaks` beyond it, which ascend.
template <class Norm>
double greatest_from(double x, std::span<const double> peaks, const Norm& norm) {
  double most = norm(x);
  for (std::size_t i = peaks.size(); i > 0 && peaks[i - 1] > x; --i) {
    most = std::max(most, norm(peaks[i - 1]));
  }
  return most;
}

}  // namespace cs2mesh
