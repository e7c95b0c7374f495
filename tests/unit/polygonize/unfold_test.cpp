#include "polygonize/unfold.h"

#include <gtest/gtest.h>

#include <vector>

#include "polygonize/check.h"
#include "polygonize/lattice_mesher.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

std::vector<Vec3d> sphere_normals(const TriangleMesh& mesh) {
  std::vector<Vec3d> normals;
  for (const Vec3d& p : mesh.positions) normals.push_back(normalized(p));
  return normals;
}

std::size_t inward(const TriangleMesh& mesh) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (dot(area_vector(mesh, t), mesh.positions[mesh.triangles[t][0]]) < 0) ++count;
  }
  return count;
}

TEST(Unfold, LeavesAGoodMeshAlone) {
  TriangleMesh mesh = *mesh_lattice(Surface<Sphere>{}, {.cell = 0.2});
  const TriangleMesh before = mesh;
  EXPECT_EQ(unfold(mesh, sphere_normals(mesh)), 0U);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

TEST(Unfold, TurnsFoldedSlivers) {
  // A vertex slid along the sphere over an edge opposite to it folds the triangle between.
  TriangleMesh mesh = *mesh_lattice(Surface<Sphere>{}, {.cell = 0.2});
  std::size_t folded = 0;
  for (std::size_t t = 0; t < mesh.triangles.size() && folded < 5; t += 97) {
    TriangleMesh moved = mesh;
    const auto& [a, b, c] = moved.triangles[t];
    const Vec3d middle = 0.5 * (moved.positions[b] + moved.positions[c]);
    moved.positions[a] = normalized(moved.positions[a] + 1.1 * (middle - moved.positions[a]));
    if (inward(moved) != 1) continue;
    ++folded;
    EXPECT_GT(unfold(moved, sphere_normals(moved)), 0U);
    EXPECT_EQ(inward(moved), 0U);
    const MeshReport report = check(moved, {.self_intersections = false});
    EXPECT_TRUE(report.ok());
    EXPECT_EQ(report.genus, 0);
  }
  EXPECT_GT(folded, 0U);
}

TEST(Unfold, ANormalThatIsNotKnownBlamesNobody) {
  TriangleMesh mesh = *mesh_lattice(Surface<Sphere>{}, {.cell = 0.3});
  EXPECT_EQ(unfold(mesh, std::vector<Vec3d>(mesh.positions.size())), 0U);
}

}  // namespace
}  // namespace cs2mesh
