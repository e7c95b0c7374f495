// What is done in blocks is done once to each triangle, and the same for any number of threads.
#include "polygonize/mesh_blocks.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <set>

#include "polygonize/check.h"
#include "polygonize/editable_mesh.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

TEST(MeshBlocks, EachTriangleHasItsTurnOnce) {
  for (const int levels : {0, 3, 6}) {
    const TriangleMesh mesh = test::bare_sphere({}, 1, levels);
    const MeshBlocks blocks(mesh);
    for (const Depth depth : {Depth::inner, Depth::deep}) {
      std::vector<std::atomic<int>> turns(mesh.triangles.size());
      blocks.for_each_triangle(depth, [&](std::size_t t) { ++turns[t]; });
      for (const auto& count : turns) EXPECT_EQ(count, 1);
    }
  }
}

TEST(MeshBlocks, DepthsAreWhatTheySay) {
  const TriangleMesh mesh = test::bare_sphere({}, 1, 6);
  const MeshBlocks blocks(mesh);
  ASSERT_GT(blocks.count(), 4U);
  const std::size_t size = (mesh.triangles.size() + blocks.count() - 1) / blocks.count();
  std::vector<std::set<std::size_t>> of_vertex(mesh.positions.size());
  std::vector<std::set<Index>> neighbours(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index v : mesh.triangles[t]) {
      of_vertex[v].insert(t / size);
      neighbours[v].insert(mesh.triangles[t].begin(), mesh.triangles[t].end());
    }
  }
  std::size_t deep = 0;
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    EXPECT_EQ(blocks.depth(v) == Depth::border, of_vertex[v].size() > 1);
    const bool all = std::all_of(neighbours[v].begin(), neighbours[v].end(),
                                 [&](Index w) { return of_vertex[w].size() == 1; });
    EXPECT_EQ(blocks.depth(v) == Depth::deep, all);
    deep += all ? 1 : 0;
  }
  EXPECT_GT(deep, mesh.positions.size() / 2);
}

/// Collapses and flips edges at random, in blocks.
TriangleMesh changed(std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  EditableMesh mesh(test::bare_sphere({}, 1, 6));
  for (std::uint64_t sweep = 0; sweep < 4; ++sweep) {
    MeshBlocks(mesh.mesh()).for_each_triangle(Depth::deep, [&](std::size_t t) {
      Random random(sweep, t);
      for (std::size_t k = 0; k < 3 && mesh.alive(t); ++k) {
        const auto h = static_cast<HalfEdge>(3 * t + k);
        const double what = random.uniform();
        if (what < 0.2 && mesh.can_collapse(h)) {
          mesh.collapse_edge(h);
        } else if (what > 0.6) {
          mesh.flip_edge(h);
        }
      }
    });
  }
  return mesh.take();
}

TEST(MeshBlocks, CollapsesAndFlipsLeaveASphereWhicheverThreadsDoThem) {
  const TriangleMesh one = changed(1);
  CheckOptions options;
  options.self_intersections = false;
  const MeshReport report = check(one, options);
  EXPECT_TRUE(report.closed && report.manifold_edges && report.manifold_vertices);
  EXPECT_EQ(report.genus, 0);
  EXPECT_LT(one.triangles.size(), 20'000U);
  for (const std::size_t threads : {2U, 5U}) {
    const TriangleMesh other = changed(threads);
    EXPECT_EQ(other.triangles, one.triangles);
    EXPECT_EQ(other.positions, one.positions);
  }
}

}  // namespace
}  // namespace cs2mesh
