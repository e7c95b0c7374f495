#include "polygonize/closest_point.h"

#include <numeric>

#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace test;

/// Triangles of all shapes: fat, needles, and without area.
TriangleMesh soup(int count, std::uint64_t seed) {
  TriangleMesh mesh;
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    const Vec3d a = 2.0 * random.direction();
    const Vec3d b = a + random.uniform(0, 0.3) * random.direction();
    Vec3d c = a + random.uniform(0, 0.3) * random.direction();
    if (i % 5 == 0) c = a + 0.5 * (b - a) + 1e-9 * random.direction();
    if (i % 7 == 0) c = b;
    if (i % 11 == 0) c = a;
    const auto first = static_cast<TriangleMesh::Index>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// The nearest point by minimising over a triangle in steps that know no geometry: the distance is
/// convex in the barycentric coordinates, so alternate ternary searches find it.
double distance_by_search(const TriangleMesh& mesh, std::size_t t, const Vec3d& p) {
  const auto& [ia, ib, ic] = mesh.triangles[t];
  const Vec3d a = mesh.positions[ia], b = mesh.positions[ib], c = mesh.positions[ic];
  const auto along = [&](double u) {  // nearest on the line from a + u (b - a) to a + u (c - a)
    double low = 0, high = 1;
    const auto at = [&](double v) { return norm(a + u * ((1 - v) * (b - a) + v * (c - a)) - p); };
    for (int i = 0; i < 80; ++i) {
      const double l = low + (high - low) / 3, h = high - (high - low) / 3;
      (at(l) < at(h) ? high : low) = at(l) < at(h) ? h : l;
    }
    return at(low);
  };
  double low = 0, high = 1;
  for (int i = 0; i < 80; ++i) {
    const double l = low + (high - low) / 3, h = high - (high - low) / 3;
    (along(l) < along(h) ? high : low) = along(l) < along(h) ? h : l;
  }
  return std::min(along(low), along(high));
}

TEST(ClosestPoint, TriangleDistanceAgreesWithSearch) {
  const TriangleMesh all = soup(40, 3);
  Random random(4);
  for (std::size_t t = 0; t < all.triangles.size(); ++t) {
    TriangleMesh one = all;
    one.triangles = {all.triangles[t]};
    const ClosestPoint tree(one);
    for (int i = 0; i < 5; ++i) {
      const Vec3d p =
          all.positions[all.triangles[t][0]] + random.uniform(0, 0.5) * random.direction();
      EXPECT_NEAR(tree.nearest(p).distance, distance_by_search(all, t, p), 1e-7);
    }
  }
}

TEST(ClosestPoint, TreeAgreesWithAllTriangles) {
  const TriangleMesh mesh = soup(500, 1);
  const ClosestPoint tree(mesh);
  std::vector<ClosestPoint> singles;
  for (const auto& triangle : mesh.triangles) {
    singles.emplace_back(TriangleMesh{mesh.positions, {triangle}, {}, {}});
  }
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Vec3d p = random.uniform(0, 4) * random.direction();
    double best = std::numeric_limits<double>::infinity();
    for (const ClosestPoint& single : singles) best = std::min(best, single.nearest(p).distance);
    const ClosestPoint::Hit hit = tree.nearest(p);
    EXPECT_EQ(hit.distance, best);
    EXPECT_EQ(singles[hit.triangle].nearest(p).distance, best);
    EXPECT_NEAR(norm(hit.point - p), best, 1e-15);
    // The bound is exclusive: just above it finds the same, at it nothing.
    EXPECT_EQ(tree.nearest(p, best * (1 + 1e-12)).distance, best);
    EXPECT_EQ(tree.nearest(p, best * (1 - 1e-12)).triangle, ClosestPoint::kNone);
  }
}

TEST(ClosestPoint, RaysCrossAClosedMeshAnEvenNumberOfTimes) {
  const TriangleMesh mesh = sphere_mesh(4, {0.3, -0.2, 0.1}, 1.5);
  const ClosestPoint tree(mesh);
  Random random(9);
  int met = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d direction = random.direction();
    const Vec3d side = random.uniform(0, 1.6) * normalized(cross(direction, random.direction()));
    const Vec3d origin = Vec3d{0.3, -0.2, 0.1} + side - 5.0 * direction;
    const std::vector<double> hits = tree.all_hits(origin, direction, 0, 10);
    EXPECT_EQ(hits.size() % 2, 0u);
    EXPECT_EQ(tree.first_hit(origin, direction, 0, 10),
              hits.empty() ? std::numeric_limits<double>::infinity() : hits.front());
    if (norm(side) < 1.49) {
      ASSERT_EQ(hits.size(), 2u);
      const double half = std::sqrt(1.5 * 1.5 - squared_norm(side));
      EXPECT_NEAR(hits[0], 5 - half, 0.06);
      EXPECT_NEAR(hits[1], 5 + half, 0.06);
      EXPECT_EQ(tree.all_hits(origin, direction, 5, 10).size(), 1u);
      ++met;
    }
  }
  EXPECT_GT(met, 1000);
}

TEST(ClosestPoint, RaysThroughVerticesDoNotSlipThrough) {
  const TriangleMesh mesh = sphere_mesh(3);
  const ClosestPoint tree(mesh);
  for (const Vec3d& vertex : mesh.positions) {
    EXPECT_LT(tree.first_hit(4.0 * vertex, -vertex, 0, 4), 4.0);
    EXPECT_NEAR(tree.first_hit({0, 0, 0}, vertex, 0, 4), 1, 1e-14);
  }
  // Axis-parallel rays in the faces of boxes.
  EXPECT_NEAR(tree.first_hit({0, 0, 3}, {0, 0, -1}, 0, 9), 2, 1e-14);
}

TEST(ClosestPoint, EmptyAndRepeated) {
  const ClosestPoint none{TriangleMesh{}};
  EXPECT_EQ(none.nearest({1, 2, 3}).triangle, ClosestPoint::kNone);
  EXPECT_TRUE(none.all_hits({0, 0, 0}, {0, 0, 1}, 0, 9).empty());
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles.assign(5000, {0, 1, 2});
  const ClosestPoint same(mesh);
  EXPECT_EQ(same.nearest({0.2, 0.2, 2}).distance, 2);
  EXPECT_EQ(same.all_hits({0.2, 0.2, 2}, {0, 0, -1}, 0, 9).size(), 5000u);
}

TEST(ClosestPoint, SpatialOrderIsAPermutation) {
  const TriangleMesh mesh = sphere_mesh(3);
  const ClosestPoint tree(mesh);
  std::vector<std::uint32_t> order(tree.spatial_order().begin(), tree.spatial_order().end());
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> expected(mesh.triangles.size());
  std::iota(expected.begin(), expected.end(), 0u);
  EXPECT_EQ(order, expected);
}

}  // namespace
}  // namespace cs2mesh
