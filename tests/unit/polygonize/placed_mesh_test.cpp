// Meshes of lattices, and octrees beside them.
#include "polygonize/placed_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "polygonize/lattice_mesher.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

TEST(PlacedMesh, HasItsVerticesInLeavesOfItsCells) {
  const Surface<Torus> torus;
  LatticeOptions lattice;
  lattice.cell = 0.06;
  const Result<TriangleMesh> dense = mesh_lattice(torus, lattice);
  ASSERT_TRUE(dense);
  const Result<PlacedMesh> placed = place_mesh(torus, *dense, lattice.cell, 1'000'000);
  ASSERT_TRUE(placed);
  EXPECT_EQ(placed->mesh.triangles.size(), dense->triangles.size());
  ASSERT_EQ(placed->leaf_of.size(), placed->mesh.positions.size());
  const Octree& octree = placed->tree.octree();
  for (std::size_t v = 0; v < placed->leaf_of.size(); ++v) {
    const Octree::Index leaf = placed->leaf_of[v];
    EXPECT_TRUE(octree.box(leaf).contains(placed->mesh.positions[v]));
    const double side = octree.side(octree[leaf].level);
    EXPECT_LE(side, 2 * lattice.cell);
    EXPECT_GE(side, lattice.cell / 4);
  }
  const auto by_place = [](const Vec3d& a, const Vec3d& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  std::vector<Vec3d> before = dense->positions, after = placed->mesh.positions;
  std::sort(before.begin(), before.end(), by_place);
  std::sort(after.begin(), after.end(), by_place);
  EXPECT_EQ(before, after);
}

TEST(PlacedMesh, HeedsItsLimit) {
  const Surface<Torus> torus;
  const Result<PlacedMesh> placed = place_mesh(torus, {}, 0.01, 1000);
  ASSERT_FALSE(placed);
  EXPECT_EQ(placed.diagnostics().front().failure, Failure::limit);
}

}  // namespace
}  // namespace cs2mesh
