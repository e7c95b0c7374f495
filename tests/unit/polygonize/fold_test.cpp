// Folded triangles are told from those in a sharp groove.
#include "polygonize/fold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

/// Two balls of radius 1/2 that overlap by so little that the groove between them is sharp.
struct Groove {
  static constexpr double kX = 0.499;
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return larger(ball(p, {-kX, 0, 0}, 0.5), ball(p, {kX, 0, 0}, 0.5));
  }
  Aabb bounds() const { return {{-1, -0.5, -0.5}, {1, 0.5, 0.5}}; }
  /// On the left ball, at that distance from the axis.
  static Vec3d left(double radius, double angle) {
    return {-kX + std::sqrt(0.25 - radius * radius), radius * std::cos(angle),
            radius * std::sin(angle)};
  }
  static Vec3d right(double radius, double angle) {
    const Vec3d p = left(radius, angle);
    return {-p.x, p.y, p.z};
  }
};

TEST(Fold, SidesOfAGrooveAreNotFolded) {
  const Surface<Groove> surface;
  const double bottom = std::sqrt(0.25 - Groove::kX * Groove::kX);
  const Vec3d a = Groove::left(bottom, 0.2), b = Groove::left(bottom, -0.2);
  ASSERT_NEAR(a.x, 0, 1e-12);
  const TriangleCorners left{a, b, Groove::left(2 * bottom, 0)};
  const TriangleCorners right{b, a, Groove::right(2 * bottom, 0)};
  EXPECT_TRUE(faces_outward(surface, left));
  EXPECT_TRUE(faces_outward(surface, right));
  EXPECT_FALSE(folded(surface, left, right, -0.95));
  // The other way around both are inside out.
  const TriangleCorners left_back{left[1], left[0], left[2]};
  const TriangleCorners right_back{right[1], right[0], right[2]};
  EXPECT_FALSE(faces_outward(surface, left_back));
  EXPECT_TRUE(folded(surface, left_back, right_back, -0.95));
}

TEST(Fold, TwoTrianglesOnTheSameSideOfAnEdgeAreFolded) {
  const Surface<Sphere> surface;
  const auto on = [](double x, double y) { return Vec3d{x, y, std::sqrt(1 - x * x - y * y)}; };
  const TriangleCorners one{on(0, 0), on(0.1, 0), on(0, 0.1)};
  const TriangleCorners beside{on(0.1, 0), on(0, 0), on(0, -0.1)};
  const TriangleCorners above{on(0.1, 0), on(0, 0), on(0.05, 0.1)};
  EXPECT_TRUE(faces_outward(surface, one));
  EXPECT_FALSE(folded(surface, one, beside, -0.95));
  EXPECT_FALSE(faces_outward(surface, above));
  EXPECT_TRUE(folded(surface, one, above, -0.95));
  const TriangleCorners flat{on(0.1, 0), on(0, 0), on(0, 0)};
  EXPECT_TRUE(folded(surface, one, flat, -0.95)) << "no area";
}

}  // namespace
}  // namespace cs2mesh
