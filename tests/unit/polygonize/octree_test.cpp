// The octree's geometry and its dual grid.
#include "polygonize/octree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <set>

#include "libfield/base/check.h"
#include "libfield/base/random.h"
#include "polygonize/check.h"
#include "polygonize/dual_surface.h"
#include "polygonize/make_manifold.h"

namespace cs2mesh {
namespace {

/// A tree in which a third of the cells down to `levels` are cut; leaves at the boundary are
/// outside and the others on random sides.
Octree random_octree(Random& random, int levels) {
  Octree octree({-1, 0.5, 2}, 4.0);
  for (Octree::Index cell = 0; cell < octree.size(); ++cell) {
    if (octree[cell].level < 2 || (octree[cell].level < levels && random.bits() % 3 == 0)) {
      octree.split(cell);
    }
  }
  const Aabb root = octree.box(0);
  for (Octree::Index cell = 0; cell < octree.size(); ++cell) {
    if (!octree.is_leaf(cell)) continue;
    const Aabb box = octree.box(cell);
    const bool outer = box.min.x == root.min.x || box.min.y == root.min.y ||
                       box.min.z == root.min.z || box.max.x == root.max.x ||
                       box.max.y == root.max.y || box.max.z == root.max.z;
    octree.set_inside(cell, !outer && random.bits() % 2 == 0);
  }
  octree.settle_sides();
  return octree;
}

/// All of the dual grid, in any order.
DualGrid dual_grid_of(const Octree& octree) {
  DualGrid grid;
  std::mutex mutex;
  for_dual_grid_around(octree, std::vector<bool>(octree.size(), true), [&](const DualGrid& part) {
    const std::lock_guard lock(mutex);
    grid.cells.insert(grid.cells.end(), part.cells.begin(), part.cells.end());
    grid.edges.insert(grid.edges.end(), part.edges.begin(), part.edges.end());
  });
  return grid;
}

TEST(Octree, ChildrenFillTheirParent) {
  Octree octree({1, 2, 3}, 8.0);
  const Octree::Index first = octree.split(0);
  const Octree::Index deeper = octree.split(first + 5);
  EXPECT_EQ(octree.box(0), (Aabb{{1, 2, 3}, {9, 10, 11}}));
  EXPECT_EQ(octree.box(first + 5), (Aabb{{5, 2, 7}, {9, 6, 11}}));
  EXPECT_EQ(octree.box(deeper), (Aabb{{5, 2, 7}, {7, 4, 9}}));
  EXPECT_EQ(octree.child(first, 3), first) << "of a leaf, itself";
  EXPECT_THROW(octree.split(0), ContractViolation);
}

TEST(Octree, FindsTheLeafOfAPoint) {
  Random random(5, 2);
  const Octree octree = random_octree(random, 5);
  const Aabb root = octree.box(0);
  for (int i = 0; i < 200; ++i) {
    const Vec3d p = root.min + random.uniform() * root.extent();
    const Octree::Index leaf = octree.leaf_at(p);
    EXPECT_TRUE(octree.is_leaf(leaf));
    EXPECT_TRUE(octree.box(leaf).contains(p));
  }
  EXPECT_TRUE(octree.is_leaf(octree.leaf_at(root.max + Vec3d{1, 1, 1})));
}

TEST(Octree, LeavesCutTogetherAreCutAsOneByOne) {
  Octree one_by_one({1, 2, 3}, 8.0), together = one_by_one;
  const Octree::Index first = one_by_one.split(0);
  together.split(0);
  const std::vector<Octree::Index> leaves{first + 6, first, first + 3};
  for (const Octree::Index leaf : leaves) one_by_one.split(leaf);
  EXPECT_EQ(together.split(leaves), first + 8);
  ASSERT_EQ(together.size(), one_by_one.size());
  for (Octree::Index cell = 0; cell < together.size(); ++cell) {
    EXPECT_EQ(together.box(cell), one_by_one.box(cell));
    EXPECT_EQ(together.child(cell, 5), one_by_one.child(cell, 5));
  }
  EXPECT_THROW(together.split(leaves), ContractViolation);
}

TEST(Octree, SidesSettleUpwards) {
  Octree octree({0, 0, 0}, 1.0);
  const Octree::Index first = octree.split(0);
  octree.settle_sides();
  EXPECT_TRUE(octree[0].uniform);
  octree.set_inside(first + 2, true);
  octree.settle_sides();
  EXPECT_FALSE(octree[0].uniform);
  EXPECT_TRUE(octree[first + 2].uniform);
}

TEST(Octree, AnEvenTreeHasTheDualCellsOfALattice) {
  Octree octree({0, 0, 0}, 1.0);
  for (Octree::Index cell = 0; cell < octree.size(); ++cell) {
    if (octree[cell].level < 3) octree.split(cell);
  }
  const std::vector<DualCell> cells = dual_grid_of(octree).cells;
  EXPECT_EQ(cells.size(), 343U);  // the inner nodes of 8^3 cells
  for (const DualCell& cell : cells) {
    const Vec3d middle = octree.point(meeting_point(octree, cell));
    for (int i = 0; i < 8; ++i) {
      const Int3 step = corner_step(i);
      const Vec3d way{step.x - 0.5, step.y - 0.5, step.z - 0.5};
      const Vec3d expected = middle + 0.125 * way;
      EXPECT_LT(norm(octree.center(cell[static_cast<std::size_t>(i)]) - expected), 1e-12);
    }
  }
}

TEST(Octree, MixedDualCellsAroundMarkedLeavesAreThoseOfAll) {
  Random random(3, 2);
  for (int round = 0; round < 20; ++round) {
    const Octree octree = random_octree(random, 5);
    std::vector<bool> marked(octree.size(), false);
    for (Octree::Index cell = octree.size(); cell-- > 0;) {
      marked[cell] = octree.is_leaf(cell) && random.bits() % 10 == 0;
      for (int i = 0; i < 8 && !octree.is_leaf(cell); ++i) {
        marked[cell] = marked[cell] || marked[octree.child(cell, i)];
      }
    }
    std::vector<DualCell> expected;
    for (const DualCell& cell : mixed_dual_cells(octree)) {
      if (std::any_of(cell.begin(), cell.end(), [&](auto leaf) { return marked[leaf]; })) {
        expected.push_back(cell);
      }
    }
    EXPECT_EQ(mixed_dual_cells(octree, marked), expected);
  }
}

TEST(Octree, EveryCornerOfLeavesHasOneDualCell) {
  Random random(3, 1);
  for (int round = 0; round < 20; ++round) {
    const Octree octree = random_octree(random, 4);
    std::set<std::array<std::int32_t, 3>> corners;
    const std::int32_t end = std::int32_t{1} << Octree::kMostLevels;
    for (Octree::Index cell = 0; cell < octree.size(); ++cell) {
      if (!octree.is_leaf(cell)) continue;
      const std::int32_t width = end >> octree[cell].level;
      for (int i = 0; i < 8; ++i) {
        const Int3 at = octree[cell].corner + width * corner_step(i);
        const bool inner =
            at.x > 0 && at.y > 0 && at.z > 0 && at.x < end && at.y < end && at.z < end;
        if (inner) corners.insert({at.x, at.y, at.z});
      }
    }
    const std::vector<DualCell> cells = dual_grid_of(octree).cells;
    EXPECT_EQ(cells.size(), corners.size());
    for (const DualCell& cell : cells) {
      const Int3 at = meeting_point(octree, cell);
      EXPECT_EQ(corners.erase({at.x, at.y, at.z}), 1U);
    }
  }
}

TEST(Octree, LeavesThatShareAPartOfAFaceHaveOneDualEdge) {
  Random random(5, 1);
  const Octree octree = random_octree(random, 4);
  const auto share_a_face = [&](Octree::Index a, Octree::Index b) {
    const Aabb p = octree.box(a), q = octree.box(b);
    const Aabb common{max(p.min, q.min), min(p.max, q.max)};
    const Vec3d extent = common.extent();
    return !common.empty() && (extent.x > 0) + (extent.y > 0) + (extent.z > 0) == 2;
  };
  std::size_t expected = 0;
  for (Octree::Index a = 0; a < octree.size(); ++a) {
    for (Octree::Index b = 0; b < a && octree.is_leaf(a); ++b) {
      if (octree.is_leaf(b) && share_a_face(a, b)) ++expected;
    }
  }
  const DualGrid grid = dual_grid_of(octree);
  std::set<DualEdge> found;
  for (const auto& [a, b] : grid.edges) {
    EXPECT_TRUE(share_a_face(a, b));
    EXPECT_TRUE(found.insert({std::min(a, b), std::max(a, b)}).second);
  }
  EXPECT_EQ(found.size(), expected);
}

TEST(Octree, MixedDualCellsAreThoseWithBothSides) {
  Random random(4, 1);
  const Octree octree = random_octree(random, 4);
  std::size_t mixed = 0;
  const DualGrid grid = dual_grid_of(octree);
  for (const DualCell& cell : grid.cells) {
    const unsigned inside = inside_corners(octree, cell);
    if (inside != 0 && inside != 0xff) ++mixed;
  }
  EXPECT_EQ(mixed_dual_cells(octree).size(), mixed);
}

/// The surface of an octree, its vertices anywhere.
TriangleMesh separating_mesh(const Octree& octree, Random& random) {
  DualSurface dual(octree);
  std::vector<bool> inside(dual.middles().size());
  for (std::size_t i = 0; i < inside.size(); ++i) inside[i] = random.bits() % 2 == 0;
  dual.cross(inside);
  TriangleMesh mesh;
  for (std::size_t i = 0; i < dual.crossings().size(); ++i) {
    mesh.positions.push_back({random.uniform(), random.uniform(), random.uniform()});
  }
  std::vector<TriangleMesh::Index> beside;
  mesh.triangles = dual.triangulate(mesh.positions, beside);
  return mesh;
}

TEST(DualSurface, EdgesHaveAsManyTrianglesOnEitherSide) {
  Random random(5, 1);
  for (int round = 0; round < 50; ++round) {
    const TriangleMesh mesh = separating_mesh(random_octree(random, 2 + round % 3), random);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
    for (const auto& t : mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto a = t[k], b = t[(k + 1) % 3];
        balance[std::minmax(a, b)] += a < b ? 1 : -1;
      }
    }
    for (const auto& [edge, sum] : balance) ASSERT_EQ(sum, 0);
  }
}

TEST(DualSurface, RandomSidesGiveAManifold) {
  Random random(6, 1);
  for (int round = 0; round < 100; ++round) {
    TriangleMesh mesh = separating_mesh(random_octree(random, 2 + round % 3), random);
    make_manifold(mesh);
    const MeshReport report = check(mesh, {.self_intersections = false});
    ASSERT_TRUE(report.closed && report.manifold_edges && report.manifold_vertices) << round;
    ASSERT_TRUE(report.oriented) << round;
  }
}

}  // namespace
}  // namespace cs2mesh
