#include "libfield/field/far_remainders.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "libfield/integral/far_reach.h"

namespace cs2mesh {
namespace {

/// The exponent and the first five bits of the mantissa.
constexpr int kDropped = 52 - 5;
constexpr double kLeast = 0x1p-24;

std::uint64_t step_of(double q2) {
  return std::bit_cast<std::uint64_t>(q2) >> kDropped;
}

/// E (c^2 + (1 - c^2) t^2)^n: sum binomial(n, k) c^2(n - k) (1 - c^2)^k E t^2k, rounded up.
double expectation(double two_nu, double c2, int n) {
  double sum = 0.0, part = 1.0;  // binomial(n, k) (1 - c^2)^k E t^2k
  for (int k = 0; k <= n; ++k) {
    sum += part * std::pow(c2, n - k);
    part *= (n - k) * (1.0 - c2) * (2 * k + 1) / ((k + 1) * (2 * k + 1 + two_nu));
  }
  return sum * (1 + 1e-12);
}

}  // namespace

FarRemainders::FarRemainders(double two_nu) {
  for (std::uint64_t step = step_of(kLeast); step < step_of(1.0); ++step) {
    const double q = std::sqrt(std::bit_cast<double>((step + 1) << kDropped)) * (1 + 1e-15);
    Row& row = rows_.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i] = series_remainder(two_nu, q, kFarOrders[i]);
    }
    // They fall but for rounding, and where they are of no use.
    for (std::size_t i = row.size() - 1; i > 0; --i) row[i - 1] = std::max(row[i - 1], row[i]);
  }
  // What is left out begins one degree higher; of odd degrees the expectation is smaller still.
  const bool has_share = two_nu == 1.0 || two_nu == 2.0 || two_nu == 4.0;
  aside_.back().fill(1.0);
  for (std::size_t step = 0; step + 1 < aside_.size(); ++step) {
    const double c2 = static_cast<double>(step + 1) / static_cast<double>(aside_.size() - 1);
    for (std::size_t i = 0; i < kFarOrders.size(); ++i) {
      const double share = has_share ? far_share(two_nu, kFarOrders[i] + 1, c2) : 1.0;
      aside_[step][i] = std::min(share, expectation(two_nu, c2, (kFarOrders[i] + 1) / 2));
    }
  }
}

const FarRemainders::Row& FarRemainders::row_of(double q2) const {
  return q2 > kLeast ? rows_[step_of(q2) - step_of(kLeast)] : rows_.front();
}

const FarRemainders::Row& FarRemainders::aside_of(double c2) const {
  const double steps = static_cast<double>(aside_.size() - 1);
  return aside_[static_cast<std::size_t>(steps * std::min(c2, 1.0))];
}

Truncation FarRemainders::lowest_order(double q2, double c2, double most) const {
  constexpr std::size_t last = kFarOrders.size() - 1;
  if (!(q2 < 1.0)) return {last, std::numeric_limits<double>::infinity()};
  const Row& row = row_of(q2);
  const Row& aside = aside_of(c2);
  std::size_t order = 0;  // both fall
  for (std::size_t i = 0; i < last; ++i) order += row[i] * aside[i] <= most ? 0 : 1;
  return {order, row[order] * aside[order]};
}

}  // namespace cs2mesh
