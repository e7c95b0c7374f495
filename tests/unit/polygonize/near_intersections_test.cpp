// Triangles that cross, looked for in parts of a mesh: what the search of the whole finds there.
#include "polygonize/near_intersections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using Pairs = std::set<std::array<TriangleMesh::Index, 2>>;

Pairs sorted(const SelfIntersections& found) {
  Pairs pairs;
  for (auto pair : found.pairs) {
    std::sort(pair.begin(), pair.end());
    pairs.insert(pair);
  }
  return pairs;
}

/// Three balls in a row, of which the first two and the last two overlap.
struct Row {
  Row() {
    Model model;
    for (const double x : {0.0, 1.5, 3.0}) {
      model.parts.push_back({"", test::bare_sphere({x, 0.01 * x, 0}, 1)});
    }
    mesh = joined(model);
    triangles_a_ball = static_cast<TriangleMesh::Index>(mesh.triangles.size() / 3);
    const auto found = find_self_intersections(mesh, 10'000);
    can_check = found.has_value();
    if (found) all = sorted(*found);
  }
  TriangleMesh mesh;
  TriangleMesh::Index triangles_a_ball = 0;
  bool can_check = false;
  Pairs all;
};

TEST(NearIntersections, OfNewTrianglesAreThoseOfTheWholeMeshThatHaveOne) {
  const Row row;
  if (!row.can_check) return;  // built without CGAL
  ASSERT_GT(row.all.size(), 10U);
  TriangleMesh known = row.mesh;
  for (const TriangleMesh::Index balls : {3U, 2U, 1U, 0U}) {
    known.triangles.resize(balls * row.triangles_a_ball);
    Pairs expected;
    for (const auto& pair : row.all) {
      if (pair[1] >= known.triangles.size()) expected.insert(pair);
    }
    EXPECT_EQ(sorted(find_new_intersections(row.mesh, TriangleSet(known), 10'000)), expected)
        << balls;
  }
}

TEST(NearIntersections, InBoxesAreThoseOfTrianglesInThem) {
  const Row row;
  if (!row.can_check) return;  // built without CGAL
  const Aabb left{{0.6, -1, -1}, {0.9, 1, 1}}, right{{2.1, -1, -1}, {2.4, 1, 1}};
  const Pairs one = sorted(find_intersections_near(row.mesh, {left}, 10'000));
  const Pairs both = sorted(find_intersections_near(row.mesh, {left, right}, 10'000));
  EXPECT_EQ(both, row.all);
  for (const auto& pair : one) EXPECT_LT(pair[1], 2 * row.triangles_a_ball);
  EXPECT_GT(one.size(), 0U);
  EXPECT_LT(one.size(), both.size());
  const Aabb away{{0, 0, 5}, {1, 1, 6}};
  EXPECT_TRUE(find_intersections_near(row.mesh, {away}, 10'000).pairs.empty());
  EXPECT_TRUE(find_intersections_near(row.mesh, {}, 10'000).pairs.empty());
}

TEST(NearIntersections, PlacesAreOnTheTriangles) {
  const Row row;
  const SelfIntersections found = find_new_intersections(row.mesh, {}, 5);
  const std::vector<Vec3d> places = places_of(found, row.mesh);
  ASSERT_EQ(places.size(), 2 * found.pairs.size());
  for (const Vec3d& place : places) {
    EXPECT_EQ(std::count(row.mesh.positions.begin(), row.mesh.positions.end(), place), 1);
  }
}

}  // namespace
}  // namespace cs2mesh
