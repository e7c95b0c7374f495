// A mesh in the order of places is the same mesh, and runs of its triangles are patches.
#include "polygonize/place_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using Corners = std::array<std::array<double, 3>, 3>;

/// The places of each triangle's corners, from the least on, in one order for all meshes.
std::vector<Corners> places(const TriangleMesh& mesh) {
  std::vector<Corners> all;
  for (const auto& t : mesh.triangles) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& p = mesh.positions[t[k]];
      corners[k] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.push_back(corners);
  }
  std::sort(all.begin(), all.end());
  return all;
}

TEST(PlaceOrder, TheMeshStaysTheSame) {
  const TriangleMesh mesh = test::bare_sphere({1, 2, 3}, 2, 4);
  TriangleMesh sorted = mesh;
  sorted.positions.push_back({7, 8, 9});  // of no triangle
  const std::vector<TriangleMesh::Index> former = sort_by_place(sorted);
  EXPECT_EQ(places(sorted), places(mesh));
  ASSERT_EQ(former.size(), sorted.positions.size());
  EXPECT_EQ(sorted.positions.back(), (Vec3d{7, 8, 9}));
  for (std::size_t v = 0; v + 1 < former.size(); ++v) {
    EXPECT_EQ(sorted.positions[v], mesh.positions[former[v]]);
  }
}

TEST(PlaceOrder, VerticesComeAsTrianglesUseThem) {
  TriangleMesh mesh = test::bare_sphere({}, 1, 4);
  sort_by_place(mesh);
  TriangleMesh::Index next = 0;
  for (const auto& t : mesh.triangles) {
    for (const TriangleMesh::Index v : t) {
      EXPECT_LE(v, next);
      next = std::max(next, v + 1);
    }
  }
  EXPECT_EQ(next, mesh.positions.size());
}

TEST(PlaceOrder, RunsOfTrianglesArePatches) {
  TriangleMesh mesh = test::bare_sphere({}, 1, 5);
  sort_by_place(mesh);
  // Each of 64 runs would be 0.44 wide were it a square; a few pieces lie apart.
  const std::size_t run = mesh.triangles.size() / 64;
  double sum = 0.0;
  for (std::size_t first = 0; first + run <= mesh.triangles.size(); first += run) {
    Aabb box;
    for (std::size_t t = first; t < first + run; ++t) box.include(centroid(mesh, t));
    sum += box.diagonal();
  }
  EXPECT_LT(sum / 64, 1.0);
}

TEST(PlaceOrder, AnEmptyMeshStaysEmpty) {
  TriangleMesh mesh;
  EXPECT_TRUE(sort_by_place(mesh).empty());
  EXPECT_TRUE(mesh.empty());
}

}  // namespace
}  // namespace cs2mesh
