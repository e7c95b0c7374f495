// Triangles that face the wrong way are mended, and the mesh stays what it was.
#include "polygonize/mend_folds.h"

#include <gtest/gtest.h>

#include "polygonize/check.h"
#include "polygonize/fold.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

constexpr double kLeast = 0.2;

std::size_t folds(const EditableMesh& mesh, std::span<const Vec3d> normals) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.mesh().triangles.size(); ++t) {
    if (!mesh.alive(t)) continue;
    const auto& triangle = mesh.mesh().triangles[t];
    count += faces_normals(mesh.mesh().positions, normals, triangle, kLeast) ? 0 : 1;
  }
  return count;
}

TEST(MendFolds, VerticesMovedBeyondTheirNeighboursLeaveNoFold) {
  const TriangleMesh sphere = test::bare_sphere({}, 1, 4);
  const std::vector<Vec3d> normals = sphere.positions;
  EditableMesh mesh(sphere);
  ASSERT_EQ(folds(mesh, normals), 0U);
  EXPECT_EQ(mend_folds(mesh, normals, kLeast).collapses, 0U);
  Random random(4);
  for (TriangleMesh::Index v = 0; v < normals.size(); v += 40) {
    mesh.move_vertex(v, normalized(normals[v] + 0.25 * random.direction()));
  }
  const std::size_t before = folds(mesh, normals);
  ASSERT_GT(before, 20U);
  const FoldsMended mended = mend_folds(mesh, normals, kLeast);
  EXPECT_GT(mended.collapses + mended.flips, 0U);
  EXPECT_LT(folds(mesh, normals), before / 10 + 1);
  CheckOptions options;
  options.self_intersections = false;
  const MeshReport report = check(mesh.take(), options);
  EXPECT_TRUE(report.closed && report.manifold_edges && report.manifold_vertices);
  EXPECT_EQ(report.genus, 0);
}

}  // namespace
}  // namespace cs2mesh
