// At which order the series of a far source may end.
//
// The terms of degree m of (|d + x|^2 + tau)^-nu are those of Gegenbauer, and by Laplace's integral
// (DLMF 18.10.4), with s = d.x / sqrt(S),
//     |term| <= S^-nu binomial(m + 2 nu - 1, m) S^(-m/2) E (s^2 + (|x|^2 - s^2) t^2)^(m/2)
// over t in [-1, 1] with density ~ (1 - t^2)^(nu - 1). Where |x| <= R and |s| <= c R that is at
// most the greatest term of series_remainder(), q = R / sqrt(S), times
//     E (c^2 + (1 - c^2) t^2)^(m/2),
// which falls with m: a source that does not stand in the direction of a cube's corner needs fewer.
// For the exponents of kernels far_reach.h has another factor, often less.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "libfield/integral/taylor_series.h"

namespace cs2mesh {

/// Degrees at which a series may end.
inline constexpr std::array<int, kTaylorOrder - 1> kFarOrders = {2, 3,  4,  5,  6,  7,           8,
                                                                 9, 10, 11, 12, 13, kTaylorOrder};

/// An index into kFarOrders, with a bound of the error that it leaves, relative to S^-nu.
struct Truncation {
  std::size_t order = 0;
  double error = 0.0;
};

/// What series_remainder() gives, looked up: by q^2 in steps of 1/32 of a power of two, each with
/// the remainder at its upper end, times the factor for c.
class FarRemainders {
 public:
  explicit FarRemainders(double two_nu);

  /// The lowest order whose remainder is at most `most`; else the highest, whose error is infinite
  /// from q = 1 on. `c2` the square of c above, or larger.
  Truncation lowest_order(double q2, double c2, double most) const;
  /// The error of the highest order, infinite from q = 1 on.
  double least(double q2, double c2) const {
    constexpr std::size_t last = kFarOrders.size() - 1;
    return q2 < 1.0 ? error(last, q2, c2) : std::numeric_limits<double>::infinity();
  }
  /// The error of that entry of kFarOrders, q2 < 1.
  double error(std::size_t order, double q2, double c2) const {
    return row_of(q2)[order] * aside_of(c2)[order];
  }

 private:
  using Row = std::array<double, kFarOrders.size()>;
  const Row& row_of(double q2) const;
  const Row& aside_of(double c2) const;
  std::vector<Row> rows_;
  std::array<Row, 33> aside_{};  ///< the lesser factor, by c^2 in steps of 1/32; 1 from c = 1 on
};

}  // namespace cs2mesh
