// Bounds over triangles hold what is sampled, and are exact where a function bends all alike.
#include "polygonize/bent_triangle.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libfield/base/jet.h"
#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

/// log sum exp(-a^2 |p - c|^2), which bends down by 2 a^2 at most.
struct Blobs {
  std::vector<Vec3d> centers;
  double a = 1.0;

  double bend() const { return 2 * a * a; }
  Jet at(const Vec3d& p) const {
    double sum = 0.0;
    Vec3d gradient{};
    for (const Vec3d& c : centers) {
      const double f = std::exp(-a * a * squared_norm(p - c));
      sum += f;
      gradient += -2 * a * a * f * (p - c);
    }
    return {std::log(sum), gradient / sum};
  }
};

Vec3d random_point(Random& random, double size) {
  return size * random.uniform() * random.direction();
}

struct Bounds {
  double low = 0.0, high = 0.0;
};
Bounds bounds_over(const Blobs& blobs, const Corners& corners) {
  std::array<double, 3> values{};
  std::array<Tangent, 3> tangents;
  for (std::size_t k = 0; k < 3; ++k) {
    const Jet jet = blobs.at(corners[k]);
    values[k] = jet.value;
    tangents[k] = {corners[k], jet.value, jet.gradient};
  }
  return {lowest_over(tangents, blobs.bend()), highest_over(corners, values, blobs.bend())};
}

TEST(BentTriangle, BoundsHoldWhatIsSampled) {
  Random random(3, 1);
  for (int round = 0; round < 4000; ++round) {
    Blobs blobs;
    blobs.a = random.uniform(0.3, 6);
    blobs.centers.resize(1 + random.bits() % 5);
    for (Vec3d& c : blobs.centers) c = random_point(random, 2);
    const Vec3d center = random_point(random, 2);
    Corners corners;
    for (Vec3d& p : corners) p = center + random_point(random, 0.5);
    const Bounds bounds = bounds_over(blobs, corners);
    for (int k = 0; k < 20; ++k) {
      const double u = random.uniform(), v = random.uniform() * (1 - u);
      const Vec3d p = u * corners[0] + v * corners[1] + (1 - u - v) * corners[2];
      const double value = blobs.at(p).value;
      ASSERT_LE(bounds.low, value + 1e-12 * (1 + std::abs(value)));
      ASSERT_GE(bounds.high, value - 1e-12 * (1 + std::abs(value)));
    }
  }
}

/// The least of some linear functions, and one that bends: kinks all over.
TEST(BentTriangle, SlopesBoundWhatHasKinks) {
  Random random(4, 1);
  for (int round = 0; round < 4000; ++round) {
    std::vector<Vec3d> slope(1 + random.bits() % 4);
    for (Vec3d& g : slope) g = random_point(random, 3);
    const double wave = random.uniform(0, 2);
    const auto value = [&](const Vec3d& p) {
      double least = 1e300;
      for (const Vec3d& g : slope) least = std::min(least, dot(g, p));
      return least + wave * std::sin(p.x);
    };
    const Vec3d center = random_point(random, 2);
    Corners corners;
    for (Vec3d& p : corners) p = center + random_point(random, 0.5);
    std::array<Interval, 3> slopes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      slopes[axis] = slope[0][axis];
      for (const Vec3d& g : slope) slopes[axis] = hull(slopes[axis], g[axis]);
    }
    slopes[0] = widened(slopes[0], wave);
    std::array<double, 3> at{};
    for (std::size_t k = 0; k < 3; ++k) at[k] = value(corners[k]);
    const double low = lowest_over(corners, at, slopes);
    const double high = highest_over(corners, at, slopes);
    for (int k = 0; k < 20; ++k) {
      const double u = random.uniform(), v = random.uniform() * (1 - u);
      const Vec3d p = u * corners[0] + v * corners[1] + (1 - u - v) * corners[2];
      ASSERT_LE(low, value(p) + 1e-12);
      ASSERT_GE(high, value(p) - 1e-12);
    }
    // A linear function alone is bounded by its corners.
    if (slope.size() == 1 && wave < 1e-3) {
      EXPECT_NEAR(high, *std::max_element(at.begin(), at.end()), 0.01);
    }
  }
}

TEST(BentTriangle, HighestIsThatOfTheQuadratic) {
  // -|p|^2 over a triangle around the origin: 0 in the middle, -1 at the corners.
  const Blobs one{{{0, 0, 0}}, 1.0};
  const double s = std::sqrt(0.75);
  const Corners corners{Vec3d{1, 0, 0}, {-0.5, s, 0}, {-0.5, -s, 0}};
  const Bounds bounds = bounds_over(one, corners);
  EXPECT_GE(bounds.high, 0.0);
  EXPECT_LE(bounds.high, 0.05);  // after two cuts
  EXPECT_NEAR(bounds.low, -1.0, 1e-6);
}

TEST(BentTriangle, FlatFunctionsAreBoundedByTheirCorners) {
  const Corners corners{Vec3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(highest_over(corners, {1, 2, 3}, 0.0), 3.0);
  const Vec3d g{1, 2, 0};
  const std::array<Tangent, 3> tangents{
      Tangent{corners[0], 1, g}, {corners[1], 2, g}, {corners[2], 3, g}};
  EXPECT_NEAR(lowest_over(tangents, 0.0), 1.0, 1e-6);
}

TEST(BentTriangle, QuartersAgreeWithTheWhole) {
  Random random(9, 1);
  QuadraticNet net;
  for (std::size_t i = 0; i < 3; ++i) {
    net.corner[i] = random.uniform(-1, 1);
    net.opposite[i] = random.uniform(-1, 1);
  }
  const auto value = [](const QuadraticNet& n, double u, double v) {
    const double w = 1 - u - v;
    return u * u * n.corner[0] + v * v * n.corner[1] + w * w * n.corner[2] +
           2 * (v * w * n.opposite[0] + u * w * n.opposite[1] + u * v * n.opposite[2]);
  };
  const double third = 1.0 / 3;
  EXPECT_NEAR(value(net.quarter(3), third, third), value(net, third, third), 1e-14);
  EXPECT_NEAR(value(net.quarter(0), third, third), value(net, 2 * third, third / 2), 1e-14);
  EXPECT_NEAR(value(net.quarter(1), 0.2, 0.5), value(net, 0.1, 0.75), 1e-14);
  EXPECT_NEAR(value(net.quarter(2), 0.2, 0.5), value(net, 0.1, 0.25), 1e-14);
}

}  // namespace
}  // namespace cs2mesh
