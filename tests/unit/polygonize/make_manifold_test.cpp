// Touching sheets taken apart.
#include "polygonize/make_manifold.h"

#include <gtest/gtest.h>

#include "polygonize/check.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// A tetrahedron over these vertices; outwards if d is on the positive side of (a, b, c).
void append_tetrahedron(TriangleMesh& mesh, Index a, Index b, Index c, Index d) {
  for (const auto& t : {std::array{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}}) {
    mesh.triangles.push_back(t);
  }
}

void expect_manifold(const TriangleMesh& mesh, std::size_t components) {
  const MeshReport report = check(mesh, {.self_intersections = false});
  EXPECT_TRUE(report.closed && report.manifold_edges && report.manifold_vertices);
  EXPECT_TRUE(report.oriented);
  EXPECT_EQ(report.components, components);
}

TEST(MakeManifold, LeavesAManifoldAsItIs) {
  TriangleMesh mesh = test::sphere_mesh(2);
  const TriangleMesh before = mesh;
  EXPECT_TRUE(make_manifold(mesh).empty());
  EXPECT_EQ(mesh.triangles, before.triangles);
  EXPECT_EQ(mesh.positions, before.positions);
}

TEST(MakeManifold, NothingOfNothing) {
  TriangleMesh mesh;
  EXPECT_TRUE(make_manifold(mesh).empty());
}

TEST(MakeManifold, DoublesAVertexThatTwoBodiesShare) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  append_tetrahedron(mesh, 0, 1, 2, 3);
  append_tetrahedron(mesh, 0, 5, 4, 6);
  const std::vector<Index> beside = make_manifold(mesh);
  EXPECT_EQ(beside, std::vector<Index>{0});
  expect_manifold(mesh, 2);
}

TEST(MakeManifold, SplitsAnEdgeThatTwoBodiesShare) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  append_tetrahedron(mesh, 0, 2, 3, 1);
  append_tetrahedron(mesh, 0, 4, 5, 1);
  const double before = volume(mesh);
  const std::vector<Index> beside = make_manifold(mesh);
  for (const Index v : beside) EXPECT_LT(v, 6U);
  const MeshReport report = check(mesh, {.self_intersections = false});
  EXPECT_TRUE(report.closed && report.manifold_edges && report.manifold_vertices);
  EXPECT_NEAR(volume(mesh), before, 1e-12) << "point for point the same surface";
}

}  // namespace
}  // namespace cs2mesh
