// What is done in blocks is done once to each triangle, and the same for any number of threads.
#include "polygonize/mesh_blocks.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <set>

#include "polygonize/check.h"
#include "polygonize/editable_mesh.h"
#include "polygonize/place_order.h"
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

TEST(MeshBlocks, ReachesAreWhatTheySay) {
  TriangleMesh mesh = test::bare_sphere({}, 1, 7);
  sort_by_place(mesh);
  const MeshBlocks blocks(mesh);
  ASSERT_GT(blocks.count(), MeshBlocks::kGroup);
  std::vector<std::set<std::size_t>> of_vertex(mesh.positions.size());
  std::vector<std::set<Index>> neighbours(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index v : mesh.triangles[t]) {
      of_vertex[v].insert(t / blocks.size());
      neighbours[v].insert(mesh.triangles[t].begin(), mesh.triangles[t].end());
    }
  }
  const auto hull = [](const std::set<std::size_t>& some) {
    return MeshBlocks::Reach{static_cast<std::uint8_t>(*some.begin()),
                             static_cast<std::uint8_t>(*some.rbegin())};
  };
  std::size_t deep = 0, deep_in_group = 0;
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    EXPECT_EQ(blocks.reach(Depth::inner, v), hull(of_vertex[v]));
    std::set<std::size_t> around;
    for (const Index w : neighbours[v]) around.insert(of_vertex[w].begin(), of_vertex[w].end());
    const MeshBlocks::Reach reach = hull(around);
    EXPECT_EQ(blocks.reach(Depth::deep, v), reach);
    deep += around.size() == 1 ? 1 : 0;
    deep_in_group += reach.first / MeshBlocks::kGroup == reach.last / MeshBlocks::kGroup ? 1 : 0;
  }
  const auto share = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(mesh.positions.size());
  };
  EXPECT_GT(share(deep), 0.8);
  EXPECT_GT(share(deep_in_group), 0.9);
}

/// Collapses and flips edges at random, in blocks.
TriangleMesh changed(std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  TriangleMesh sphere = test::bare_sphere({}, 1, 6);
  sort_by_place(sphere);
  EditableMesh mesh(std::move(sphere));
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
