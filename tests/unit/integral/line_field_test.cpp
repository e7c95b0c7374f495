#include "libfield/integral/line_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/base/check.h"
#include "libfield/integral/integral.h"

namespace cs2mesh {
namespace {

constexpr KernelKind kKinds[] = {KernelKind::cauchy,   KernelKind::gaussian, KernelKind::squared,
                                 KernelKind::metaball, KernelKind::soft,     KernelKind::quartic};

TEST(LineField, IsThatOfALongSegment) {
  const Segment line{{-1e6, 0, 0}, {1e6, 0, 0}};
  for (const KernelKind kind : kKinds) {
    for (const double x : {0.02, 0.3, 0.5, 0.97}) {
      const Kernel kernel = make_kernel(kind, 1.0, 1.0, 0.0, 0.0);
      const Jet jet = std::visit(
          [&](const auto& k) {
            return integral(k, line, Vec3d{0, x, 0});
          },
          kernel);
      const LineField found = line_field(kind, x);
      // What the squared kernel's segment misses beyond its ends is 2e-6.
      const double limit = kind == KernelKind::squared ? 3e-6 : 1e-11 * found.value;
      EXPECT_NEAR(found.value, jet.value, limit) << name_of(kind) << " " << x;
      EXPECT_NEAR(found.slope, jet.gradient.y, 1e-10 * std::abs(found.slope)) << name_of(kind);
      EXPECT_NEAR(log_line_field(kind, x), std::log(found.value), 1e-14);
    }
  }
}

TEST(LineField, DerivativesAreThoseOfDifferences) {
  constexpr double kStep = 1e-5;
  for (const KernelKind kind : kKinds) {
    for (const double x : {0.1, 0.45, 0.9}) {
      const LineField before = line_field(kind, x - kStep), after = line_field(kind, x + kStep);
      const LineField here = line_field(kind, x);
      EXPECT_NEAR(here.slope, (after.value - before.value) / (2 * kStep),
                  1e-6 * (1 + std::abs(here.slope)))
          << name_of(kind);
      EXPECT_NEAR(here.curvature, (after.slope - before.slope) / (2 * kStep),
                  1e-6 * (1 + std::abs(here.curvature)))
          << name_of(kind);
    }
  }
}

TEST(LineField, EndsWhereTheKernelDoes) {
  EXPECT_EQ(line_field(KernelKind::soft, 1.0).value, 0);
  EXPECT_EQ(line_field(KernelKind::quartic, 1.5).value, 0);
  EXPECT_EQ(line_field(KernelKind::gaussian, 40).value, 0);
  EXPECT_NEAR(log_line_field(KernelKind::gaussian, 40), -1600 + 0.5 * std::log(std::acos(-1)),
              1e-10);
  EXPECT_THROW(line_field(KernelKind::inverse, 1.0), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
