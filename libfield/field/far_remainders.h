// At which order the series of a far source may end.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libfield/integral/taylor_series.h"

namespace cs2mesh {

/// Degrees at which a series may end.
inline constexpr std::array<int, 6> kFarOrders = {2, 4, 6, 8, 10, kTaylorOrder};

/// An index into kFarOrders, with a bound of the error that it leaves, relative to S^-nu.
struct Truncation {
  std::size_t order = 0;
  double error = 0.0;
};

/// What series_remainder() gives, looked up: by q^2 in steps of 1/32 of a power of two, each with
/// the remainder at its upper end.
class FarRemainders {
 public:
  explicit FarRemainders(double two_nu);

  /// The lowest order whose remainder is at most `most`; else the highest, whose error is infinite
  /// from q = 1 on.
  Truncation lowest_order(double q2, double most) const;

 private:
  using Row = std::array<double, kFarOrders.size()>;
  std::vector<Row> rows_;
};

}  // namespace cs2mesh
