// The order of a convergence: y = c x^p through measured points.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace cs2mesh {

struct PowerFit {
  double exponent = 0.0;  ///< p
  double factor = 0.0;    ///< c
  double deviation =
      0.0;  ///< standard deviation of p from the scatter; 0 where two points give all
  std::size_t points = 0;  ///< that were used
};

inline constexpr double kLeastSpan = 1.5;

/// Least squares of log y over log x, all points with the same weight. Points of which a coordinate
/// is not finite or not > 0 are left out. None where the largest x is less than kLeastSpan times
/// the smallest: what is no more than noise would be told as an order. `x` and `y` are of one
/// length (ContractViolation). O(n).
std::optional<PowerFit> fit_power(std::span<const double> x, std::span<const double> y);

}  // namespace cs2mesh
