// Tangles in meshes come undone, and what does not cross stays as it is.
#include "polygonize/collapse_crossings.h"

#include <gtest/gtest.h>

#include "polygonize/check.h"
#include "polygonize/self_intersection.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

std::size_t crossings_of(const TriangleMesh& mesh) {
  const auto found = find_self_intersections(mesh, 1000);
  return found ? found->count : 0;
}

TriangleMesh untangled(TriangleMesh mesh, std::size_t& changed) {
  EditableMesh editable(std::move(mesh));
  changed = 0;
  for (int round = 0; round < 8; ++round) {
    const std::size_t now = collapse_crossings(editable);
    if (now == 0) break;
    changed += now;
  }
  return editable.take();
}

TEST(CollapseCrossings, LeavesAMeshAloneThatHasNone) {
  const TriangleMesh sphere = test::sphere_mesh(3);
  std::size_t changed = 1;
  const TriangleMesh after = untangled(sphere, changed);
  EXPECT_EQ(changed, 0U);
  EXPECT_EQ(after.triangles, sphere.triangles);
}

TEST(CollapseCrossings, TakesApartWhatVerticesOutOfPlaceMade) {
  if (!find_self_intersections({}, 1)) return;  // a build that cannot tell what crosses
  TriangleMesh mesh = test::sphere_mesh(3);
  // Vertices pushed past a neighbour and under it.
  for (const std::size_t t : {5U, 140U, 277U, 500U}) {
    const auto& corners = mesh.triangles[t];
    const Vec3d past = 1.8 * mesh.positions[corners[1]] - 0.8 * mesh.positions[corners[0]];
    mesh.positions[corners[0]] = 0.97 * past;
  }
  const std::size_t before = crossings_of(mesh);
  ASSERT_GT(before, 0U);
  std::size_t changed = 0;
  const TriangleMesh after = untangled(mesh, changed);
  EXPECT_GT(changed, 0U);
  EXPECT_EQ(crossings_of(after), 0U);
  const MeshReport report = check(after);
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.genus, 0);
  EXPECT_GT(report.triangles, mesh.triangles.size() - 60);
}

}  // namespace
}  // namespace cs2mesh
