#include "libfield/profile/cone_weight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/base/random.h"
#include "libfield/profile/profile_hessian.h"
#include "libfield/profile/profile_slopes.h"

namespace cs2mesh {
namespace {

constexpr KernelKind kKinds[] = {KernelKind::cauchy,   KernelKind::gaussian, KernelKind::squared,
                                 KernelKind::metaball, KernelKind::soft,     KernelKind::quartic};

TEST(ConeWeight, IsOneAtTheThickEndAndFallsToTheThinOne) {
  for (const KernelKind kind : kKinds) {
    const StrengthProfile profile = cone_weight(kind, 0.9, 0.2);
    EXPECT_NEAR(evaluate(profile, 0, 0.3).w, 1, 1e-14) << name_of(kind);
    double before = 1;
    for (double u = 0.1; u < 1.05; u += 0.1) {
      const double w = evaluate(profile, u, 0.3).w;
      EXPECT_LT(w, before) << name_of(kind) << " " << u;
      EXPECT_GT(w, 0);
      EXPECT_NEAR(w, evaluate(cone_weight(kind, 0.2, 0.9), 1 - u, 0).w, 1e-14);
      before = w;
    }
    EXPECT_FALSE(has_corners(profile));
  }
  EXPECT_NEAR(evaluate(cone_weight(KernelKind::cauchy, 2, 1), 1, 0).w, std::pow(2.0 / 5, 1.5),
              1e-15);
  EXPECT_NEAR(evaluate(cone_weight(KernelKind::gaussian, 0, 2), 0, 0).w, std::exp(-4), 1e-16);
  EXPECT_NEAR(evaluate(cone_weight(KernelKind::squared, 2, 0), 0.25, 0).w, 0.75, 1e-15);
}

TEST(ConeWeight, DerivativesAreThoseOfDifferences) {
  constexpr double kStep = 1e-5;
  for (const KernelKind kind : kKinds) {
    const StrengthProfile profile = cone_weight(kind, 0.85, 0.1);
    for (double u = 0.05; u < 1; u += 0.1) {
      const ProfileValue before = evaluate(profile, u - kStep, 0);
      const ProfileValue after = evaluate(profile, u + kStep, 0);
      EXPECT_NEAR(evaluate(profile, u, 0).du, (after.w - before.w) / (2 * kStep), 1e-7);
      const ProfileHessian bend = profile_hessian(profile, u, 0);
      EXPECT_NEAR(bend.uu, (after.du - before.du) / (2 * kStep), 1e-5) << name_of(kind) << " " << u;
      EXPECT_EQ(bend.uv, 0);
    }
  }
}

TEST(ConeWeight, EnclosuresContain) {
  Random random(9);
  for (int trial = 0; trial < 2000; ++trial) {
    const KernelKind kind = kKinds[static_cast<std::size_t>(trial) % std::size(kKinds)];
    const StrengthProfile profile = cone_weight(
        kind, trial % 5 == 0 ? 0.0 : random.uniform(0, 0.98), random.uniform(0.01, 0.98));
    const double lo = random.uniform(), hi = lo + (1 - lo) * random.uniform();
    const Interval w = enclose(profile, {lo, hi}, 0.0);
    const Interval slope = enclose_slopes(profile, {lo, hi}, 0.0).du;
    for (int sample = 0; sample <= 10; ++sample) {
      const ProfileValue at = evaluate(profile, lo + 0.1 * sample * (hi - lo), 0);
      EXPECT_TRUE(w.contains(at.w)) << name_of(kind);
      EXPECT_TRUE(slope.contains(at.du)) << name_of(kind);
    }
    EXPECT_LT(w.width(), std::abs(evaluate(profile, lo, 0).w - evaluate(profile, hi, 0).w) + 1e-10);
  }
}

}  // namespace
}  // namespace cs2mesh
