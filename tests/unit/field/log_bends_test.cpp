// The second derivative of the logarithm of each kernel, by differences, lies within its bounds.
#include "libfield/field/log_bends.h"

#include <gtest/gtest.h>

#include "tests/property/random_primitives.h"

namespace cs2mesh {
namespace {

template <class K>
double log_profile(const K& kernel, double r) {
  return std::log(kernel.profile(r * r));
}

TEST(LogBends, HoldDifferencesOfTheLogarithm) {
  Random random(1, 1);
  int tight = 0;
  for (int round = 0; round < 4000; ++round) {
    const KernelKind kind = kAllKernels[random.bits() % kAllKernels.size()];
    const double length = testing::log_uniform(random, 0.1, 10.0);
    const Kernel any = testing::random_kernel(random, kind, length);
    std::visit(
        [&](const auto& kernel) {
          const double reach = std::min(4 * length, 0.98 * kernel.support());
          double near = reach * random.uniform(), far = reach * random.uniform();
          if (near > far) std::swap(near, far);
          near = std::max(near, 0.02 * length);
          far = std::max(far, near * (1 + 1e-3));
          const LogBends bends = log_bends(kernel, near, far);
          double most = -HUGE_VAL, least = HUGE_VAL, steepest = 0.0;
          for (int k = 0; k <= 20; ++k) {
            const double r = near + (far - near) * k / 20;
            const double step = 1e-4 * r;
            if (r - step < near || r + step > far) continue;
            const double before = log_profile(kernel, r - step), at = log_profile(kernel, r),
                         after = log_profile(kernel, r + step);
            const double slope = (after - before) / (2 * step);
            const double along = (after - 2 * at + before) / (step * step), across = slope / r;
            most = std::max({most, -along, -across});
            least = std::min({least, -along, -across});
            steepest = std::max(steepest, std::abs(slope));
          }
          const double slack =
              1e-5 * std::max(bends.most, std::abs(bends.least)) + 1e-5 / (near * near);
          EXPECT_LE(most, bends.most + slack) << "kernel " << static_cast<int>(kind);
          EXPECT_GE(least, bends.least - slack) << "kernel " << static_cast<int>(kind);
          EXPECT_LE(steepest, bends.steepest * (1 + 1e-6) + slack * near);
          if (most > 0.8 * bends.most && steepest > 0.8 * bends.steepest) ++tight;
        },
        any);
  }
  EXPECT_GT(tight, 2500);
}

TEST(LogBends, OfCauchyOverAllDistances) {
  const Cauchy kernel{3.0};
  const LogBends all = log_bends(kernel, 0.0, 100.0);
  EXPECT_NEAR(all.most, 4 * 9.0, 1e-6);
  EXPECT_NEAR(all.least, -0.5 * 9.0, 1e-6);
  EXPECT_NEAR(all.steepest, 2 * 3.0, 1e-6);
}

}  // namespace
}  // namespace cs2mesh
