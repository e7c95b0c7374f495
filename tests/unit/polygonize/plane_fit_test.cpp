#include "polygonize/plane_fit.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-12) {
  EXPECT_LE(norm(a - b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

Vec3d random_direction(Random& random) {
  for (;;) {
    const Vec3d v{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (norm(v) > 0.1 && norm(v) < 1) return normalized(v);
  }
}

TEST(PlaneFit, ThreePlanesMeetInAPoint) {
  Random random(1, 1);
  for (int i = 0; i < 100; ++i) {
    const Vec3d corner{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    std::vector<Plane> planes;
    for (int k = 0; k < 5; ++k) {
      const Vec3d n = random_direction(random);
      planes.push_back({n, dot(n, corner)});
    }
    expect_near(point_near_planes(planes, {0.5, -0.5, 0.2}, 1e-6), corner, 1e-9);
  }
}

TEST(PlaneFit, StaysAsNearToTheStartAsThePlanesLeaveIt) {
  const Vec3d start{1, 2, 3};
  const std::array<Plane, 2> edge{{{{1, 0, 0}, 5.0}, {{0, 0.6, 0.8}, 0.0}}};
  expect_near(point_near_planes({}, start, 0.1), start);
  expect_near(point_near_planes(std::span(edge).first(1), start, 0.1), {5, 2, 3});
  const Vec3d on_edge = point_near_planes(edge, start, 0.1);
  EXPECT_NEAR(on_edge.x, 5, 1e-12);
  expect_near(on_edge, Vec3d{5, 2, 3} - dot(edge[1].normal, start) * edge[1].normal);
}

TEST(PlaneFit, LeavesOutWhatIsBelowTheCutoff) {
  // Two planes 0.02 apart in direction meet far away.
  const double c = std::cos(0.01), s = std::sin(0.01);
  const std::array<Plane, 2> nearly{{{{c, s, 0}, 1.0}, {{c, -s, 0}, -1.0}}};
  expect_near(point_near_planes(nearly, {}, 0.01), {0, 0, 0});
  expect_near(point_near_planes(nearly, {}, 1e-6), {0, 1 / s, 0}, 1e-9);
}

}  // namespace
}  // namespace cs2mesh
