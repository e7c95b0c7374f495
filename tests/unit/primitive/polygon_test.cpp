#include "libfield/primitive/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libfield/base/random.h"
#include "libfield/primitive/nearest_point.h"

namespace cs2mesh {
namespace {

Polygon polygon(std::vector<Vec3d> vertices) {
  return std::get<Polygon>(make_polygon(std::move(vertices)));
}

std::string_view fault(std::vector<Vec3d> vertices) {
  const auto made = make_polygon(std::move(vertices));
  const auto* found = std::get_if<PolygonFault>(&made);
  return found ? found->what : "";
}

/// A star-shaped polygon, with corners of either kind, in a turned plane.
Polygon random_star(Random& random, std::size_t corners) {
  const Affine placement =
      Affine::translate({1, 2, 3}) * Affine::rotate(random.direction(), random.uniform(0, 360));
  std::vector<Vec3d> vertices;
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle =
        2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(corners);
    const double radius = random.uniform(0.3, 2);
    vertices.push_back(placement({radius * std::cos(angle), radius * std::sin(angle), 0}));
  }
  if (random.uniform() < 0.5) std::reverse(vertices.begin(), vertices.end());
  return polygon(vertices);
}

/// A comb whose teeth leave no ear but at their tips.
std::vector<Vec3d> comb(int teeth) {
  std::vector<Vec3d> vertices{{0, -1, 0}, {double(2 * teeth), -1, 0}};
  for (int i = 2 * teeth; i >= 0; --i) vertices.push_back({double(i), i % 2 == 0 ? 5.0 : 0.0, 0});
  return vertices;
}

TEST(Polygon, PiecesCoverItWithoutOverlap) {
  Random random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const std::size_t corners = 3 + random.bits() % 60;
    const Polygon star = random_star(random, corners);
    double area = 0;
    for (const Triangle& piece : star.pieces) {
      area += measure(piece);
      EXPECT_GT(dot(area_vector(piece), star.normal), 0);
    }
    EXPECT_LE(star.pieces.size(), corners - 2);
    EXPECT_NEAR(area, measure(star), 1e-12 * measure(star));
    // Signed areas of an overlap would cancel; points of it would count twice.
    for (int sample = 0; sample < 20; ++sample) {
      const Vec3d p = star.vertex[0] + random.uniform(-2, 2) * (star.vertex[1] - star.vertex[0]) +
                      random.uniform(-2, 2) * (star.vertex[2] - star.vertex[0]);
      int covering = 0;
      for (const Triangle& piece : star.pieces) covering += is_above(piece, p);
      EXPECT_EQ(covering, is_above(star, p) ? 1 : 0);
    }
  }
}

TEST(Polygon, CombsAndCollinearVerticesAreCutUp) {
  for (const int teeth : {1, 2, 20, 61}) {
    const Polygon made = polygon(comb(teeth));
    double area = 0;
    for (const Triangle& piece : made.pieces) area += measure(piece);
    EXPECT_NEAR(area, measure(made), 1e-11 * area) << teeth;
    EXPECT_FALSE(is_convex(made));
  }
  const Polygon square =
      polygon({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}});
  EXPECT_TRUE(is_convex(square));
  EXPECT_NEAR(measure(square), 4, 1e-15);
  EXPECT_LT(norm(middle(square) - Vec3d{1, 1, 0}), 1e-15);
  EXPECT_EQ(square.normal, (Vec3d{0, 0, 1}));
}

TEST(Polygon, WhatIsNoPolygonIsNamed) {
  EXPECT_EQ(fault({{0, 0, 0}, {1, 0, 0}}), "fewer than three vertices");
  EXPECT_EQ(fault({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}}), "a vertex like the one before it");
  EXPECT_EQ(fault({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}), "a vertex like the one before it");
  EXPECT_EQ(fault({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}), "a polygon without area");
  EXPECT_EQ(fault({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.01}, {0, 1, 0}}),
            "a vertex off the plane of the others");
  EXPECT_EQ(fault({{0, 0, 0}, {1, 0.1, 0}, {1, 0, 0}, {0, 1.5, 0}}), "edges that meet");
  // A spike there and back, and a corner that touches an edge.
  EXPECT_EQ(fault({{0, 0, 0}, {3, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}), "edges that meet");
  EXPECT_EQ(fault({{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {2, 0, 0}, {0, 2, 0}}), "edges that meet");
  EXPECT_EQ(fault({{0, 0, 0}, {1e200, 0, 0}, {0, 1e200, 0}}), "a polygon without area");
}

TEST(Polygon, NearestPointIsThatOfTheNearestPiece) {
  Random random(3);
  for (int trial = 0; trial < 40; ++trial) {
    const Polygon star = random_star(random, 3 + random.bits() % 20);
    for (int sample = 0; sample < 50; ++sample) {
      const Vec3d p = star.vertex[0] + 3 * random.uniform() * random.direction();
      double least = HUGE_VAL;
      for (const Triangle& piece : star.pieces) least = std::min(least, distance(piece, p));
      EXPECT_NEAR(norm(nearest_point(star, p) - p), least, 1e-13);
    }
  }
}

}  // namespace
}  // namespace cs2mesh
