// Elementary functions of packs against the 64 bits of long double.

#include "libfield/simd/vmath.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libfield/base/random.h"
#include "libfield/simd/pack.h"

namespace cs2mesh {
namespace {

// Every N gives the same bits (tests/unit/simd/bulk_test.cpp); only this one may be used here.
using Pair = Pack<2>;

/// In units of the last place that `exact` has as a double.
double ulps(double x, long double exact) {
  const double size = std::abs(static_cast<double>(exact));
  const double unit = std::nextafter(size, HUGE_VAL) - size;
  return static_cast<double>(std::abs(x - exact) / unit);
}

TEST(Vmath, ExpIsWithinOneUlp) {
  Random random(1);
  double worst = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double x = i % 2 == 0 ? random.uniform(-708.0, 709.7) : random.uniform(-1.0, 1.0);
    worst =
        std::max(worst, ulps(vmath::exp(Pair(x)).lane[1], std::exp(static_cast<long double>(x))));
  }
  EXPECT_LE(worst, 1.0);
}

TEST(Vmath, ExpMeetsTheEndsOfItsRange) {
  EXPECT_EQ(vmath::exp(Pair(0.0)).lane[0], 1.0);
  EXPECT_EQ(vmath::exp(Pair(710.0)).lane[0], HUGE_VAL);
  EXPECT_EQ(vmath::exp(Pair(HUGE_VAL)).lane[0], HUGE_VAL);
  EXPECT_EQ(vmath::exp(Pair(-746.0)).lane[0], 0.0);
  EXPECT_EQ(vmath::exp(Pair(-HUGE_VAL)).lane[0], 0.0);
  EXPECT_NEAR(vmath::exp(Pair(-740.0)).lane[0], std::exp(-740.0), 1e-323);
}

TEST(Vmath, Expm1IsWithinTwoUlp) {
  Random random(2);
  double worst = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double x = i % 2 == 0 ? random.uniform(-100.0, 600.0)
                                : std::copysign(std::pow(10.0, random.uniform(-20.0, 0.3)),
                                                random.uniform(-1.0, 1.0));
    worst = std::max(worst,
                     ulps(vmath::expm1(Pair(x)).lane[0], std::expm1(static_cast<long double>(x))));
  }
  EXPECT_LE(worst, 2.0);
  EXPECT_EQ(vmath::expm1(Pair(0.0)).lane[0], 0.0);
  EXPECT_EQ(vmath::expm1(Pair(-HUGE_VAL)).lane[0], -1.0);
}

TEST(Vmath, Atan2IsWithinTwoUlpOverThePlane) {
  Random random(3);
  double worst = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const double angle = random.uniform(-std::numbers::pi, std::numbers::pi);
    const double size = std::pow(10.0, random.uniform(-100.0, 100.0));
    double x = size * std::cos(angle), y = size * std::sin(angle);
    // Close to the axes too.
    if (i % 3 == 1) y *= std::pow(10.0, random.uniform(-30.0, 0.0));
    if (i % 3 == 2) x *= std::pow(10.0, random.uniform(-30.0, 0.0));
    const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    worst = std::max(worst, ulps(vmath::atan2(Pair(y), Pair(x)).lane[0], exact));
  }
  EXPECT_LE(worst, 2.0);
}

TEST(Vmath, Atan2OnTheAxes) {
  const double pi = std::numbers::pi;
  EXPECT_EQ(vmath::atan2(Pair(0.0), Pair(2.0)).lane[0], 0.0);
  EXPECT_EQ(vmath::atan2(Pair(0.0), Pair(-2.0)).lane[0], pi);
  EXPECT_EQ(vmath::atan2(Pair(-0.0), Pair(-2.0)).lane[0], -pi);
  EXPECT_EQ(vmath::atan2(Pair(3.0), Pair(0.0)).lane[0], pi / 2);
  EXPECT_EQ(vmath::atan2(Pair(-3.0), Pair(0.0)).lane[0], -pi / 2);
}

TEST(Vmath, SmallErfIsWithinTwoUlp) {
  double worst = 0.0;
  for (int i = 0; i <= 20000; ++i) {
    const double x = i < 10000 ? 1e-4 * i : std::pow(10.0, -2e-3 * (i - 10000));
    if (x == 0.0) continue;
    worst = std::max(worst, ulps(small_erf(x), std::erf(static_cast<long double>(x))));
    EXPECT_EQ(small_erf(x), small_erf(Pair(x)).lane[1]) << x;
  }
  EXPECT_LE(worst, 2.0);
}

TEST(Pack, ChoosesLaneByLane) {
  const Pair a(Pair::Doubles{1.0, -2.0}), b(Pair::Doubles{-3.0, 4.0});
  const auto less = a < b;
  EXPECT_TRUE(any(less));
  EXPECT_FALSE(all(less));
  EXPECT_FALSE(any(less ^ less));
  EXPECT_TRUE(all(less | !less));
  EXPECT_EQ(select(less, a, b).lane[0], -3.0);
  EXPECT_EQ(select(less, a, b).lane[1], -2.0);
  EXPECT_EQ(abs(a).lane[1], 2.0);
  EXPECT_EQ(copysign(a, b).lane[0], -1.0);
  EXPECT_EQ(max(a, b).lane[1], 4.0);
  EXPECT_EQ(min(a, b).lane[0], -3.0);
}

TEST(FirstOf, GivesEachLaneTheFirstFormulaOfferedAndSkipsThoseThatNoLaneTakes) {
  const Pair x(Pair::Doubles{1.0, 5.0});
  FirstOf<Pair, Pair> first;
  int calls = 0;
  const auto constant = [&calls](double value) {
    return [&calls, value] {
      ++calls;
      return Pair(value);
    };
  };
  EXPECT_FALSE(first.take(x > Pair(7.0), constant(1.0)));
  EXPECT_EQ(calls, 0);
  EXPECT_FALSE(first.take(x > Pair(3.0), constant(2.0)));
  EXPECT_FALSE(first.take(x > Pair(3.0), constant(3.0)));
  EXPECT_EQ(calls, 1);
  const Pair all_lanes = first.otherwise(constant(4.0));
  EXPECT_EQ(all_lanes.lane[0], 4.0);
  EXPECT_EQ(all_lanes.lane[1], 2.0);
}

}  // namespace
}  // namespace cs2mesh
