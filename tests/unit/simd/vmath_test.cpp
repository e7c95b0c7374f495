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

TEST(Vmath, Exp2IsWithinTwoUlp) {
  Random random(11);
  double worst = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double x = i % 2 == 0 ? random.uniform(-1020.0, 1022.0) : random.uniform(-1.0, 1.0);
    worst =
        std::max(worst, ulps(vmath::exp2(Pair(x)).lane[1], std::exp2(static_cast<long double>(x))));
  }
  EXPECT_LE(worst, 2.0);
  EXPECT_EQ(vmath::exp2(Pair(0.0)).lane[0], 1.0);
  EXPECT_EQ(vmath::exp2(Pair(-3.0)).lane[0], 0.125);
}

TEST(Vmath, LogIsWithinTwoUlp) {
  Random random(12);
  double worst = 0.0, near_one = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double x = std::pow(2.0, random.uniform(-1000.0, 1000.0));
    const long double exact = std::log(static_cast<long double>(x));
    worst = std::max(worst, ulps(vmath::log(Pair(x)).lane[0], exact));
    const double y = random.uniform(0.5, 2.0);
    near_one =
        std::max(near_one, static_cast<double>(std::abs(vmath::log(Pair(y)).lane[1] -
                                                        std::log(static_cast<long double>(y)))));
  }
  EXPECT_LE(worst, 2.0);
  EXPECT_LE(near_one, 2e-16);
  EXPECT_EQ(vmath::log(Pair(1.0)).lane[0], 0.0);
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

TEST(Vmath, UpperAngleKeepsWhatItPromises) {
  Random random(3);
  double worst = 0.0;
  for (int i = 0; i < 100000; ++i) {
    double y = random.uniform(), x = random.uniform(-1.0, 1.0);
    if (i % 3 == 1) y *= std::pow(10.0, random.uniform(-30.0, 0.0));
    if (i % 3 == 2) x *= std::pow(10.0, random.uniform(-30.0, 0.0));
    const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    const double angle = vmath::upper_angle(Pair(y), Pair(x)).lane[0];
    worst = std::max(worst, static_cast<double>(std::abs(angle - exact)));
    if (x < 0) continue;
    EXPECT_LE(ulps(angle, exact), 4.0) << y << " " << x;
  }
  EXPECT_LE(worst, 6e-16);
  EXPECT_EQ(vmath::upper_angle(Pair(0.0), Pair(2.0)).lane[0], 0.0);
  EXPECT_EQ(vmath::upper_angle(Pair(0.0), Pair(-2.0)).lane[0], std::numbers::pi);
  EXPECT_EQ(vmath::upper_angle(Pair(3.0), Pair(0.0)).lane[0], std::numbers::pi / 2);
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

TEST(Vmath, SineAndCosineOfTurnsAreWithin3e16) {
  Random random(4);
  long double worst = 0.0L;
  for (int i = 0; i < 100000; ++i) {
    const double x = i % 2 == 0 ? random.uniform(-3.0, 3.0) : random.uniform(-1e6, 1e6);
    const auto at = vmath::sin_cos_pi(Pair(x));
    // The remainder is exact; the angle in long double is not the error that counts here.
    const long double angle = std::numbers::pi_v<long double> * std::remainder(x, 2.0);
    worst = std::max(worst, std::abs(at.sine.lane[1] - std::sin(angle)));
    worst = std::max(worst, std::abs(at.cosine.lane[1] - std::cos(angle)));
  }
  EXPECT_LE(static_cast<double>(worst), 3e-16);
  for (const double x : {0.0, 0.5, 1.0, 1.5, -0.5, 2.0, 1e9, 1e9 + 1.0}) {
    const auto at = vmath::sin_cos_pi(x);
    EXPECT_EQ(std::abs(at.sine) + std::abs(at.cosine), 1.0) << x;
  }
}

TEST(Vmath, Floor) {
  for (const double x : {0.0, 0.5, -0.5, 1.0, -1.0, 1e9 + 0.25, -1e9 - 0.25, 0x1p60, -0x1p60}) {
    EXPECT_EQ(vmath::floor(Pair(x)).lane[0], std::floor(x));
  }
}

TEST(Reciprocals, AreWithinTwoUlpAndNeverNotANumber) {
  Random random(6);
  for (int i = 0; i < 10000; ++i) {
    const double a = std::exp2(random.uniform(-200, 200)), b = std::exp2(random.uniform(-200, 200));
    const Reciprocals<double> of(a, b);
    EXPECT_LE(std::abs(of.of_a * a - 1.0), 4e-16);
    EXPECT_LE(std::abs(of.of_b * b - 1.0), 4e-16);
  }
  const Reciprocals<double> far(std::numeric_limits<double>::infinity(), 2.0);
  EXPECT_TRUE(std::isfinite(far.of_a) && std::isfinite(far.of_b));
}

}  // namespace
}  // namespace cs2mesh
