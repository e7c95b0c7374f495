// Angles of triangles.
#include "polygonize/triangle_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libfield/base/random.h"
#include "polygonize/measured_triangle.h"

namespace cs2mesh {
namespace {

TEST(SmallestAngle, IsThatOfKnownTriangles) {
  EXPECT_NEAR(smallest_angle({0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}), 60, 1e-12);
  EXPECT_NEAR(smallest_angle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), 45, 1e-12);
  EXPECT_EQ(smallest_angle({0, 0, 0}, {1, 0, 0}, {2, 0, 0}), 0) << "on a line";
  EXPECT_EQ(smallest_angle({0, 0, 0}, {0, 0, 0}, {2, 0, 0}), 0) << "two corners are one";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(smallest_angle({0, 0, nan}, {1, 0, 0}, {2, 1, 0}), 0);
}

TEST(SmallestAngle, DoesNotDependOnTheOrderOfCorners) {
  Random random(1, 1);
  const auto point = [&] {
    return Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  };
  for (int round = 0; round < 100; ++round) {
    const Vec3d a = point(), b = point(), c = point();
    const double angle = smallest_angle(a, b, c);
    EXPECT_LE(angle, 60 + 1e-9);
    EXPECT_NEAR(smallest_angle(b, c, a), angle, 1e-9);
    EXPECT_NEAR(smallest_angle(b, a, c), angle, 1e-9);
  }
}

TEST(TriangleShapes, CountsThinOnesAndLeavesOutWhatNamesNoVertex) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 9}};
  const TriangleShapes shapes = triangle_shapes(mesh);
  EXPECT_EQ(shapes.thin, 1U);
  EXPECT_NEAR(shapes.min_angle_deg, 11.3, 0.1);
  EXPECT_EQ(triangle_shapes({}).min_angle_deg, 60);
}

TEST(MeasuredTriangle, IsSeenThroughItsForm) {
  // Twice as long along x: what is half an equilateral triangle there becomes one.
  const Symmetric3 form = 4.0 * squared(Vec3d{1, 0, 0}) + squared(Vec3d{0, 1, 0});
  const Vec3d u{0.5, 0, 0}, v{0.25, std::sqrt(0.75), 0};
  const MeasuredTriangle seen(form, u, v);
  EXPECT_NEAR(seen.quality(), 1, 1e-12);
  EXPECT_NEAR(seen.cotangent(), 1 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(norm(seen.to_centre() - (u + v) / 3.0), 0, 1e-12);
  const MeasuredTriangle obtuse(multiple_of_unit(1.0), {1, 0, 0}, {-1, 0.1, 0});
  EXPECT_EQ(obtuse.to_centre(), (Vec3d{0, 0.05, 0})) << "the middle of the longest side";
  EXPECT_EQ(MeasuredTriangle({}, u, v).quality(), 1) << "no form, no opinion";
}

}  // namespace
}  // namespace cs2mesh
