#include "polygonize/power_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "libfield/base/check.h"
#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(PowerFit, FindsThePowerThatThePointsFollow) {
  const std::vector<double> x = {100, 400, 3000, 20000, 5};
  std::vector<double> y;
  for (const double value : x) y.push_back(3.5 * std::pow(value, -1.25));
  const std::optional<PowerFit> fit = fit_power(x, y);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->exponent, -1.25, 1e-12);
  EXPECT_NEAR(fit->factor, 3.5, 1e-11);
  EXPECT_NEAR(fit->deviation, 0, 1e-6);
  EXPECT_EQ(fit->points, 5u);
}

TEST(PowerFit, TheDeviationIsThatOfTheExponentOverManyDraws) {
  std::vector<double> x;
  for (int i = 0; i < 12; ++i) x.push_back(std::pow(2.0, i));
  double sum = 0, squares = 0, told = 0;
  constexpr int kDraws = 400;
  for (int draw = 0; draw < kDraws; ++draw) {
    Random random(7, static_cast<std::uint64_t>(draw));
    std::vector<double> y;
    for (const double value : x) {
      // Twelve uniform numbers are all but normal, of variance 1.
      double normal = -6;
      for (int k = 0; k < 12; ++k) normal += random.uniform();
      y.push_back(value * std::exp(0.3 * normal));
    }
    const std::optional<PowerFit> fit = fit_power(x, y);
    ASSERT_TRUE(fit);
    sum += fit->exponent;
    squares += fit->exponent * fit->exponent;
    told += fit->deviation;
  }
  const double mean = sum / kDraws, deviation = std::sqrt(squares / kDraws - mean * mean);
  EXPECT_NEAR(mean, 1, 0.01);
  EXPECT_NEAR(told / kDraws / deviation, 1, 0.1);
}

TEST(PowerFit, LeavesOutWhatHasNoLogarithm) {
  const std::vector<double> x = {1, 2, 4, 8, 0, 16};
  const std::vector<double> y = {1, 0, 16, kInfinity, 3, std::nan("")};
  const std::optional<PowerFit> fit = fit_power(x, y);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->points, 2u);
  EXPECT_NEAR(fit->exponent, 2, 1e-12);
  EXPECT_EQ(fit->deviation, 0);
}

TEST(PowerFit, NoneWhereThePointsDoNotTell) {
  const std::vector<double> none, one = {3}, alike = {80000, 80010, 80020}, errors = {3, 2, 1};
  EXPECT_FALSE(fit_power(none, none));
  EXPECT_FALSE(fit_power(one, one));
  EXPECT_FALSE(fit_power(alike, errors));
  EXPECT_THROW((void)fit_power(one, none), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
