// Triangles are known again by where they are, whatever their numbers.
#include "polygonize/triangle_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

TEST(TriangleSet, KeysTellCornersAndTurnAlone) {
  const TriangleMesh mesh = test::bare_sphere({0.3, -0.2, 7}, 2, 4);
  std::set<std::uint64_t> keys;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) keys.insert(triangle_key(mesh, t));
  EXPECT_EQ(keys.size(), mesh.triangles.size());

  // Numbered anew, from other corners on.
  TriangleMesh other;
  for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
    const auto first = static_cast<TriangleMesh::Index>(other.positions.size());
    for (std::size_t k = 0; k < 3; ++k) {
      other.positions.push_back(mesh.positions[mesh.triangles[t][(k + t) % 3]]);
    }
    other.triangles.push_back({first, first + 1, first + 2});
    EXPECT_EQ(triangle_key(other, other.triangles.size() - 1), triangle_key(mesh, t));
  }
  EXPECT_TRUE(TriangleSet(mesh).others(other).empty());
  std::swap(other.triangles[5][0], other.triangles[5][1]);
  EXPECT_FALSE(keys.contains(triangle_key(other, 5))) << "turned over";
}

TEST(TriangleSet, OthersAreThoseThatChanged) {
  const TriangleMesh mesh = test::bare_sphere({}, 1, 3);
  TriangleSet set(mesh);
  TriangleMesh moved = mesh;
  moved.positions[11].x += 1e-15;
  std::vector<std::uint32_t> expected;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corners = mesh.triangles[t];
    if (std::count(corners.begin(), corners.end(), 11U) > 0) expected.push_back(t);
  }
  EXPECT_EQ(set.others(moved), expected);
  set.remove({triangle_key(mesh, 7), triangle_key(mesh, 3), 12345, triangle_key(mesh, 7)});
  set.remove({triangle_key(mesh, 3)});
  EXPECT_EQ(set.others(mesh), (std::vector<std::uint32_t>{3, 7}));
  set.add({triangle_key(mesh, 7), triangle_key(mesh, 9), 54321, 54321});
  EXPECT_EQ(set.others(mesh), (std::vector<std::uint32_t>{3}));
  EXPECT_TRUE(set.contains(54321));
  EXPECT_FALSE(set.empty());
  EXPECT_TRUE(TriangleSet().empty());
  EXPECT_EQ(TriangleSet().others(mesh).size(), mesh.triangles.size());
}

}  // namespace
}  // namespace cs2mesh
