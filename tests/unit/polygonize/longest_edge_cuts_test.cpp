// Cut meshes stay closed, and flat parts lie in what they are parts of.
#include "polygonize/longest_edge_cuts.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libfield/base/check.h"
#include "libfield/base/random.h"
#include "polygonize/check.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

double smallest_angle(const TriangleMesh& mesh) {
  double least = 4.0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d u = mesh.positions[t[(k + 1) % 3]] - mesh.positions[t[k]];
      const Vec3d v = mesh.positions[t[(k + 2) % 3]] - mesh.positions[t[k]];
      least = std::min(least, std::acos(dot(u, v) / (norm(u) * norm(v))));
    }
  }
  return least;
}

TEST(LongestEdgeCuts, FlatPartsAreTheSameSurface) {
  const TriangleMesh mesh = test::sphere_mesh(2);
  Random random(4, 1);
  FlatParts cut{mesh, {}};
  for (int round = 0; round < 6; ++round) {
    std::vector<std::uint32_t> some;
    for (std::uint32_t t = 0; t < cut.mesh.triangles.size(); ++t) {
      if (random.uniform() < 0.1) some.push_back(t);
    }
    const TriangleMesh before = cut.mesh;
    cut = cut_flat(before, some);
    EXPECT_TRUE(check(cut.mesh).ok());
    EXPECT_NEAR(area(cut.mesh), area(mesh), 1e-12);
    EXPECT_TRUE(
        std::equal(before.positions.begin(), before.positions.end(), cut.mesh.positions.begin()));
    ASSERT_EQ(cut.whole.size(), cut.mesh.triangles.size());
    EXPECT_TRUE(std::is_sorted(cut.whole.begin(), cut.whole.end()));
    std::vector<std::size_t> parts(before.triangles.size(), 0);
    for (std::size_t i = 0; i < cut.whole.size(); ++i) {
      ++parts[cut.whole[i]];
      const Vec3d whole = area_vector(before, cut.whole[i]), part = area_vector(cut.mesh, i);
      EXPECT_NEAR(norm(whole / norm(whole) - part / norm(part)), 0.0, 1e-7);
      EXPECT_TRUE(bounds(before, cut.whole[i]).grown(1e-12).contains(centroid(cut.mesh, i)));
    }
    for (const std::uint32_t t : some) EXPECT_EQ(parts[t], 4U);
  }
  // Rivara: no less than half of what it was.
  EXPECT_GE(smallest_angle(cut.mesh), 0.5 * smallest_angle(mesh));
}

TEST(LongestEdgeCuts, WithoutTrianglesNothingIsCut) {
  const TriangleMesh mesh = test::sphere_mesh(1);
  EXPECT_EQ(cut_flat(mesh, {}).mesh.triangles, mesh.triangles);
}

TEST(LongestEdgeCuts, WantsAClosedMesh) {
  TriangleMesh mesh = test::sphere_mesh(0);
  mesh.triangles.pop_back();
  EXPECT_THROW((void)cut_flat(mesh, {0}), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
