#include "libfield/field/far_remainders.h"

#include <bit>
#include <cmath>
#include <limits>

namespace cs2mesh {
namespace {

/// The exponent and the first five bits of the mantissa.
constexpr int kDropped = 52 - 5;
constexpr double kLeast = 0x1p-24;

std::uint64_t step_of(double q2) {
  return std::bit_cast<std::uint64_t>(q2) >> kDropped;
}

}  // namespace

FarRemainders::FarRemainders(double two_nu) {
  for (std::uint64_t step = step_of(kLeast); step < step_of(1.0); ++step) {
    const double q = std::sqrt(std::bit_cast<double>((step + 1) << kDropped)) * (1 + 1e-15);
    Row& row = rows_.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i] = series_remainder(two_nu, q, kFarOrders[i]);
    }
  }
}

Truncation FarRemainders::lowest_order(double q2, double most) const {
  constexpr std::size_t last = kFarOrders.size() - 1;
  if (!(q2 < 1.0)) return {last, std::numeric_limits<double>::infinity()};
  const Row& row = q2 > kLeast ? rows_[step_of(q2) - step_of(kLeast)] : rows_.front();
  std::size_t order = 0;
  while (order < last && !(row[order] <= most)) ++order;
  return {order, row[order]};
}

}  // namespace cs2mesh
