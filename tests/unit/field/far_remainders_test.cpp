// At which order the series of a far source may end, against the series themselves.

#include "libfield/field/far_remainders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

/// |(|d + x|^2 + tau)^-nu - its series up to that order|, S = 1.
double error_at(double two_nu, int order, const Vec3d& d, const Vec3d& x) {
  Series series{};
  kernel_series(two_nu, order, d, 1.0, 1.0,
                [&](std::size_t place, double value) { series[place] = value; });
  const double exact = std::pow(1.0 + 2.0 * dot(d, x) + squared_norm(x), -0.5 * two_nu);
  return std::abs(series_jet(series.data(), x).value - exact);
}

TEST(FarRemainders, HoldOverCubesSeenFromAnySide) {
  Random random(7);
  for (const double two_nu : {1.0, 2.0, 4.0, 6.0, 8.0}) {
    const FarRemainders remainders(two_nu);
    double tightest = 0.0;
    for (int i = 0; i < 300; ++i) {
      // |d| < 1 where tau takes the rest of S.
      const Vec3d d = (i % 3 == 0 ? random.uniform() : 1.0) * random.direction();
      const double half = std::pow(10.0, random.uniform(-2.0, -0.35));
      const double radius = std::sqrt(3.0) * half;
      const double c = (std::abs(d.x) + std::abs(d.y) + std::abs(d.z)) / std::sqrt(3.0);
      const Truncation cut = remainders.lowest_order(radius * radius, c * c,
                                                     std::pow(10.0, random.uniform(-12.0, -1.0)));
      double worst = 0.0;
      for (int k = 0; k < 60; ++k) {
        const auto side = [&] { return k < 40 ? random.uniform(-half, half) : half; };
        const auto sign = [&] { return random.uniform() < 0.5 ? -1.0 : 1.0; };
        const Vec3d x{sign() * side(), sign() * side(), sign() * side()};
        worst = std::max(worst, error_at(two_nu, kFarOrders[cut.order], d, x));
      }
      ASSERT_LE(worst, cut.error + 1e-14) << two_nu << ", half " << half;
      if (cut.error > 1e-11) tightest = std::max(tightest, worst / cut.error);
    }
    EXPECT_GT(tightest, 0.1) << two_nu;
  }
}

TEST(FarRemainders, TheLowestOrderIsTaken) {
  const FarRemainders remainders(4.0);
  EXPECT_EQ(remainders.lowest_order(0x1p-40, 1.0, 1e-6).order, 0U);
  EXPECT_EQ(remainders.lowest_order(0.01, 1.0, 0.0).order, kFarOrders.size() - 1);
  EXPECT_TRUE(std::isinf(remainders.lowest_order(1.0, 1.0, 1.0).error));
  for (const double most : {1e-2, 1e-4, 1e-6}) {
    const Truncation cut = remainders.lowest_order(0.01, 1.0, most);
    EXPECT_LE(cut.error, most);
    // Within the step of q^2.
    EXPECT_GE(cut.error, series_remainder(4.0, 0.1, kFarOrders[cut.order]));
    EXPECT_GT(series_remainder(4.0, 0.1 * 1.02, kFarOrders[cut.order - 1]), most);
  }
}

}  // namespace
}  // namespace cs2mesh
