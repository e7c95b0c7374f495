#include "libfield/profile/profile.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/base/random.h"
#include "libfield/profile/cone_weight.h"
#include "libfield/profile/profile_bends.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double along(ProfileFunction function, double x) {
  StrengthProfile profile;
  profile.along_u = function;
  return evaluate(profile, x, 0.0).w;
}

StrengthProfile random_profile(Random& random) {
  const auto function = [&] {
    return static_cast<ProfileFunction>(random.bits() % kProfileNames.size());
  };
  StrengthProfile profile;
  profile.along_u = function();
  profile.along_v = function();
  profile.scale_u = random.uniform(-5.0, 5.0);
  profile.scale_v = random.uniform(-5.0, 5.0);
  profile.translate_u = random.uniform(-2.0, 2.0);
  profile.translate_v = random.uniform(-2.0, 2.0);
  profile.times = random.uniform(-3.0, 3.0);
  if (random.uniform() < 0.5) profile.lower = random.uniform(-1.0, 0.5);
  if (random.uniform() < 0.5) profile.upper = random.uniform(0.5, 1.5);
  return profile;
}

TEST(Profile, NamesRoundTrip) {
  for (std::size_t i = 0; i < kProfileNames.size(); ++i) {
    EXPECT_EQ(profile_function_of(kProfileNames[i]), static_cast<ProfileFunction>(i));
  }
  EXPECT_EQ(profile_function_of("tan"), std::nullopt);
}

TEST(Profile, FunctionsAreMeantLiterally) {
  using enum ProfileFunction;
  EXPECT_EQ(along(one, 0.7), 1.0);
  EXPECT_EQ(along(x, -2.5), -2.5);
  EXPECT_EQ(along(saw, 1.25), 0.25);
  EXPECT_EQ(along(saw, -0.25), 0.75);
  EXPECT_EQ(along(saw, 1.0), 0.0);
  EXPECT_EQ(along(hat, 0.5), 1.0);
  EXPECT_EQ(along(hat, 0.25), 0.5);
  EXPECT_EQ(along(hat, 1.0), 0.0);
  EXPECT_EQ(along(step, 0.49), 0.0);
  EXPECT_EQ(along(step, 0.5), 1.0);
  EXPECT_EQ(along(step, 1.0), 0.0);
  EXPECT_NEAR(along(sin, 0.5), 1.0, 1e-16);
  EXPECT_NEAR(along(sin, 1.5), -1.0, 1e-16);
  EXPECT_NEAR(along(cos, 1.0), -1.0, 1e-16);
  EXPECT_NEAR(along(sin_squared, 0.25), 0.5, 1e-15);
  EXPECT_NEAR(along(cos_squared, 0.5), 0.0, 1e-16);
}

TEST(Profile, BoundsClampAndFlatten) {
  StrengthProfile profile;
  profile.along_u = ProfileFunction::x;
  profile.times = 2.0;
  profile.lower = 0.5;
  profile.upper = 1.5;
  EXPECT_EQ(evaluate(profile, 0.1, 0.0).w, 0.5);
  EXPECT_EQ(evaluate(profile, 0.1, 0.0).du, 0.0);
  EXPECT_EQ(evaluate(profile, 0.9, 0.0).w, 1.5);
  EXPECT_EQ(evaluate(profile, 0.5, 0.0).w, 1.0);
  EXPECT_EQ(evaluate(profile, 0.5, 0.0).du, 2.0);
}

TEST(Profile, DerivativesAreThoseOfDifferences) {
  Random random(7);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 2000; ++i) {
    const StrengthProfile profile = random_profile(random);
    const double u = random.uniform(), v = random.uniform();
    const auto w = [&](double du, double dv) { return evaluate(profile, u + du, v + dv).w; };
    const ProfileValue at = evaluate(profile, u, v);
    const double left = (w(0, 0) - w(-kStep, 0)) / kStep;
    const double right = (w(kStep, 0) - w(0, 0)) / kStep;
    if (std::abs(left - right) < 1e-2) {  // no corner, no jump
      EXPECT_NEAR(at.du, 0.5 * (left + right), 1e-4);
    }
    const double below = (w(0, 0) - w(0, -kStep)) / kStep;
    const double above = (w(0, kStep) - w(0, 0)) / kStep;
    if (std::abs(below - above) < 1e-2) {
      EXPECT_NEAR(at.dv, 0.5 * (below + above), 1e-4);
    }
  }
}

TEST(Profile, EnclosureContainsEverySample) {
  Random random(11);
  for (int i = 0; i < 3000; ++i) {
    const StrengthProfile profile = random_profile(random);
    const auto interval = [&] {
      const double lo = random.uniform(-1.0, 1.0);
      return Interval{lo, lo + std::pow(10.0, random.uniform(-4.0, 0.3))};
    };
    const Interval u = interval(), v = interval();
    const Interval range = enclose(profile, u, v);
    ASSERT_LE(range.lo, range.hi);
    for (int j = 0; j <= 20; ++j) {
      const double fu = j % 5 == 0 ? 0.0 : j % 5 == 1 ? 1.0 : random.uniform();
      const double fv = j % 3 == 0 ? 0.0 : j % 3 == 1 ? 1.0 : random.uniform();
      const double at_u = j % 5 == 1 ? u.hi : u.lo + fu * (u.hi - u.lo);
      const double at_v = j % 3 == 1 ? v.hi : v.lo + fv * (v.hi - v.lo);
      const double w = evaluate(profile, at_u, at_v).w;
      EXPECT_TRUE(range.contains(w)) << w << " not in " << range.lo << ", " << range.hi;
    }
  }
}

TEST(Profile, BendsHoldForDifferencesOfSlopes) {
  Random random(12);
  int bounded = 0;
  for (int i = 0; i < 6000; ++i) {
    StrengthProfile profile = random_profile(random);
    if (i % 6 == 0) {
      const KernelKind kind = i % 12 == 0 ? KernelKind::cauchy : KernelKind::gaussian;
      profile = cone_weight(kind, random.uniform(-2.0, 3.0), random.uniform(0.0, 3.0));
    }
    const auto interval = [&] {
      const double lo = random.uniform(-1.0, 1.0);
      return Interval{lo, lo + std::pow(10.0, random.uniform(-4.0, 0.0))};
    };
    const Interval u = interval(), v = interval();
    const ProfileBends bends = bound_bends(profile, u, v);
    bounded += std::isfinite(bends.uu + bends.uv + bends.vv) ? 1 : 0;
    for (int j = 0; j < 20; ++j) {
      const double u0 = random.uniform(u.lo, u.hi), u1 = random.uniform(u.lo, u.hi);
      const double v0 = random.uniform(v.lo, v.hi), v1 = random.uniform(v.lo, v.hi);
      const ProfileValue a = evaluate(profile, u0, v0), b = evaluate(profile, u1, v1);
      const double noise = 1e-9 * (1 + std::abs(a.du) + std::abs(a.dv));
      const double du = std::abs(u1 - u0), dv = std::abs(v1 - v0);
      EXPECT_LE(std::abs(a.du - b.du), bends.uu * du + bends.uv * dv + noise);
      EXPECT_LE(std::abs(a.dv - b.dv), bends.uv * du + bends.vv * dv + noise);
    }
  }
  EXPECT_GT(bounded, 2000);
}

TEST(Profile, EnclosureIsTightOnSmallBoxes) {
  StrengthProfile profile;
  profile.along_u = ProfileFunction::sin;
  profile.along_v = ProfileFunction::hat;
  const Interval range = enclose(profile, {0.3, 0.3001}, {0.2, 0.2001});
  EXPECT_LT(range.width(), 1e-3);
}

TEST(Profile, EnclosureOverAllSpaceIsFiniteForBoundedFunctions) {
  for (std::size_t i = 0; i < kProfileNames.size(); ++i) {
    StrengthProfile profile;
    profile.along_u = static_cast<ProfileFunction>(i);
    const Interval range = enclose(profile, {-kInfinity, kInfinity}, {0.0, 1.0});
    EXPECT_LE(range.lo, range.hi);
    EXPECT_EQ(std::isinf(range.hi), profile.along_u == ProfileFunction::x);
  }
}

}  // namespace
}  // namespace cs2mesh
