// Edges that make triangles far from the surface are flipped back.
#include "polygonize/flip_far.h"

#include <gtest/gtest.h>

#include <numeric>

#include "polygonize/check.h"
#include "polygonize/editable_mesh.h"
#include "tests/unit/polygonize/analytic_surfaces.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace analytic;

struct Needle {
  Surface<Ellipsoid> surface{{{1.0, 0.1, 0.1}}};
  TriangleMesh mesh = test::bare_sphere({}, 1, 2);
  FarOptions options;
  Needle() {
    for (Vec3d& p : mesh.positions) p = {p.x, 0.1 * p.y, 0.1 * p.z};
    options.tolerance = 0.001;  // what the mesh keeps, and little more
    while (!far_in(mesh).empty()) options.tolerance *= 1.05;
  }
  std::vector<LostPoint> far_in(const TriangleMesh& m) const {
    std::vector<std::size_t> all(m.triangles.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return far_triangles(surface, m, all, options);
  }
};

TEST(FlipFar, UndoesAFlipThatSpansTheInside) {
  const Needle needle;
  ASSERT_TRUE(needle.far_in(needle.mesh).empty());
  int spoilt = 0;
  for (HalfEdge h = 0; h < 3 * needle.mesh.triangles.size(); ++h) {
    EditableMesh editable(needle.mesh);
    if (!editable.flip_edge(h)) continue;
    TriangleMesh mesh = editable.take();
    const std::vector<LostPoint> far = needle.far_in(mesh);
    if (far.empty()) continue;
    ++spoilt;
    EXPECT_GT(flip_far(needle.surface, mesh, far, needle.options), 0U);
    EXPECT_TRUE(needle.far_in(mesh).empty());
    const MeshReport report = check(mesh);
    EXPECT_TRUE(report.ok());
    EXPECT_EQ(mesh.triangles.size(), needle.mesh.triangles.size());
  }
  EXPECT_GT(spoilt, 10);
}

TEST(FlipFar, LeavesWhatFlipsDoNotHelp) {
  const Needle needle;
  TriangleMesh coarse = test::bare_sphere({}, 1, 1);
  for (Vec3d& p : coarse.positions) p = {p.x, 0.1 * p.y, 0.1 * p.z};
  const TriangleMesh before = coarse;
  const std::vector<LostPoint> far = needle.far_in(coarse);
  ASSERT_FALSE(far.empty());
  flip_far(needle.surface, coarse, far, needle.options);
  EXPECT_TRUE(check(coarse).ok());
  EXPECT_LE(needle.far_in(coarse).size(), far.size());
  EXPECT_EQ(flip_far(needle.surface, coarse, {}, needle.options), 0U);
  EXPECT_EQ(coarse.positions, before.positions);
}

}  // namespace
}  // namespace cs2mesh
