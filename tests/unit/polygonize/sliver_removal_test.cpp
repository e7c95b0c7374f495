#include "polygonize/sliver_removal.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libfield/base/random.h"
#include "polygonize/check.h"
#include "polygonize/editable_mesh.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

TaggedMesh tagged(TriangleMesh mesh) {
  mesh.normals.clear();
  mesh.colors.clear();
  std::vector<std::uint32_t> tags(mesh.triangles.size(), 0);
  return {std::move(mesh), std::move(tags)};
}

double flattest(const TriangleMesh& mesh) {
  double least = 1e300;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corner = mesh.triangles[t];
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      longest =
          std::max(longest, norm(mesh.positions[corner[(k + 1) % 3]] - mesh.positions[corner[k]]));
    }
    least = std::min(least, 2 * norm(area_vector(mesh, t)) / longest);
  }
  return least;
}

/// A sphere with points put in near its vertices and edges, which makes needles and caps.
TaggedMesh slivered(double distance, std::uint64_t seed) {
  EditableMesh editable(tagged(test::sphere_mesh(3)).mesh);
  const std::size_t old = editable.mesh().positions.size();
  Random random(seed);
  for (int i = 0; i < 150; ++i) {
    const auto count = static_cast<double>(editable.mesh().triangles.size());
    const auto pick = static_cast<std::size_t>(random.uniform() * count);
    const auto corner = editable.mesh().triangles[pick];
    if (std::max({corner[0], corner[1], corner[2]}) >= old) continue;
    const auto place = [&](std::size_t k) { return editable.mesh().positions[corner[k]]; };
    const double along = i % 2 == 0 ? distance : 0.4;  // near a vertex, or an edge
    const Vec3d on_edge = place(0) + along * (place(1) - place(0));
    editable.split_triangle(pick, on_edge + distance * (place(2) - on_edge));
  }
  return tagged(editable.take());
}

TEST(SliverRemoval, LeavesASoundMeshWithoutSlivers) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    TaggedMesh mesh = slivered(1e-7, seed);
    const TriangleMesh before = mesh.mesh;
    EXPECT_LT(flattest(mesh.mesh), 1e-6);
    std::vector<char> is_open(mesh.mesh.positions.size(), 1);
    EXPECT_EQ(remove_slivers(mesh, is_open, 1e-5), 0U);
    EXPECT_GE(flattest(mesh.mesh), 1e-5);
    EXPECT_EQ(mesh.tags.size(), mesh.mesh.triangles.size());
    EXPECT_EQ(is_open.size(), mesh.mesh.positions.size());
    const MeshReport report = check(mesh.mesh);
    EXPECT_TRUE(report.ok());
    EXPECT_EQ(report.genus, 0);
    EXPECT_NEAR(report.volume, volume(before), 1e-4);
    // No vertex moves.
    for (const Vec3d& p : mesh.mesh.positions) {
      EXPECT_NE(std::find(before.positions.begin(), before.positions.end(), p),
                before.positions.end());
    }
  }
}

TEST(SliverRemoval, LooksOnlyWhereItIsTold) {
  TaggedMesh mesh = slivered(1e-7, 1);
  const TriangleMesh before = mesh.mesh;
  std::vector<char> is_open(mesh.mesh.positions.size(), 0);
  EXPECT_EQ(remove_slivers(mesh, is_open, 1e-5), 0U);
  EXPECT_EQ(mesh.mesh.positions, before.positions);
  EXPECT_EQ(mesh.mesh.triangles, before.triangles);
}

TEST(SliverRemoval, KeepsATetrahedron) {
  TaggedMesh mesh;
  mesh.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e-9, 1e-9, 1e-9}};
  mesh.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  mesh.tags = {0, 0, 0, 0};
  std::vector<char> is_open(4, 1);
  EXPECT_GT(remove_slivers(mesh, is_open, 1e-5), 0U);
  EXPECT_EQ(mesh.mesh.triangles.size(), 4U);
}

}  // namespace
}  // namespace cs2mesh
