#include "libfield/ray/certificate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

/// A function with |u''| <= M made of pieces of constant second derivative, integrated exactly.
struct Bang {
  double u0, s0;
  double curvature[8];
  double h;

  /// Value and slope after the length x.
  EndJet at(double x) const {
    EndJet jet{u0, s0};
    const double piece = h / 8.0;
    for (const double c : curvature) {
      const double w = std::min(piece, x);
      if (w <= 0.0) break;
      jet.value += w * (jet.slope + 0.5 * c * w);
      jet.slope += c * w;
      x -= w;
    }
    return jet;
  }
};

TEST(Certificate, NeverClaimsMoreThanIsTrue) {
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const double M = std::exp(random.uniform(-3.0, 3.0));
    Bang u{random.uniform(-1, 1), random.uniform(-1, 1), {}, std::exp(random.uniform(-3, 1))};
    // Extreme functions are the ones that a wrong bound fails on.
    for (double& c : u.curvature) c = random.uniform() < 0.5 ? -M : M;
    const EndJet a = u.at(0.0);
    const EndJet b = u.at(u.h);
    double least = a.value;
    double least_speed = std::abs(a.slope);
    for (int k = 0; k <= 400; ++k) {
      const EndJet jet = u.at(u.h * k / 400);
      least = std::min(least, jet.value);
      least_speed = std::min(least_speed, std::abs(jet.slope));
    }
    EXPECT_LE(least_value(a, b, u.h, M), least + 1e-12);
    if (is_monotone(a.slope, b.slope, u.h, M)) {
      EXPECT_LE(least_slope(a.slope, b.slope, u.h, M), least_speed + 1e-12);
      EXPECT_GT(least_speed, 0.0);
    }
    // From each end alone.
    const double reach = certain_reach(a, 0.0, M);
    for (int k = 0; k < 50 && reach > 0.0; ++k) {
      const double x = reach * k / 50;
      if (x < u.h) {
        EXPECT_GT(u.at(x).value, -1e-12);
      }
    }
  }
}

TEST(Certificate, IsAttainedByTheExtremeFunction) {
  // Down, up, up, down: the deepest dip between two level ends.
  const double M = 3.0;
  const double h = 1.5;
  const Bang u{1.0, 0.0, {-M, -M, M, M, M, M, -M, -M}, h};
  EXPECT_NEAR(least_value(u.at(0.0), u.at(h), h, M), u.at(0.5 * h).value, 1e-14);
  EXPECT_NEAR(least_value(u.at(0.0), u.at(h), h, M), 1.0 - M * h * h / 16.0, 1e-14);
}

TEST(Certificate, SlopesAloneBoundAValley) {
  const EndJet a{1.0, 0.0};
  const EndJet b{2.0, 0.0};
  // Down with slope -2 for x, up with slope 1 for the rest of 3: 1 - 2 x + (3 - x) = 2.
  EXPECT_NEAR(least_value(a, b, 3.0, Interval(-2.0, 1.0)), 1.0 - 2.0 * 2.0 / 3.0, 1e-14);
  EXPECT_EQ(least_value(a, b, 3.0, Interval(0.0, 1.0)), 1.0);
  EXPECT_EQ(least_value(a, b, 3.0, Interval::everything()),
            -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace cs2mesh
