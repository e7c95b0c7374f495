#include "polygonize/tolerance.h"

#include <gtest/gtest.h>

#include "polygonize/check.h"
#include "polygonize/metrology.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

TEST(GradientEstimate, KnowsTheErrorOfASphere) {
  // An octahedron in the unit sphere: its faces are 1 - 1 / sqrt(3) off, its edges 1 - 1 / sqrt(2).
  TriangleMesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const double distance = GradientEstimate().largest_distance(Surface<Sphere>{}, mesh);
  EXPECT_NEAR(distance, 1 - 1 / std::sqrt(3.0), 1e-3);
  EXPECT_EQ(GradientEstimate().largest_distance(Surface<Sphere>{}, TriangleMesh{}), 0.0);
}

TEST(MeshToTolerance, SmoothSurfacesAreReachedWithoutWaste) {
  for (const double tolerance : {1e-2, 1e-3, 2e-4}) {
    const auto sphere = mesh_to_tolerance(Surface<Sphere>{}, 1.0, false, tolerance);
    ASSERT_TRUE(sphere);
    EXPECT_TRUE(sphere->reached);
    EXPECT_LE(sphere->attempts.size(), 2U);
    EXPECT_LE(sphere->error, tolerance);
    EXPECT_GE(sphere->error, 0.4 * tolerance);
    EXPECT_TRUE(sphere.diagnostics().empty());
    EXPECT_TRUE(check(sphere->mesh).ok());
    const auto torus = mesh_to_tolerance(Surface<Torus>{}, 0.3, false, tolerance);
    EXPECT_TRUE(torus->reached);
    EXPECT_LE(torus->attempts.size(), 3U);
  }
}

TEST(MeshToTolerance, AWrongRadiusIsMadeUpFor) {
  // The smallest radius of curvature of this ellipsoid is 0.09.
  const auto mesh = mesh_to_tolerance(Surface<Ellipsoid>{}, 1.0, false, 1e-3);
  EXPECT_TRUE(mesh->reached);
  MeasureOptions options;
  options.samples = 200'000;
  EXPECT_LE(measure(Surface<Ellipsoid>{}, mesh->mesh, options).max(), 1e-3);
}

TEST(MeshToTolerance, Creases) {
  const auto mesh = mesh_to_tolerance(Surface<ClippedSaddle>{}, 1.0, true, 0.02);
  EXPECT_TRUE(mesh->reached);
  EXPECT_TRUE(check(mesh->mesh).ok());
}

TEST(MeshToTolerance, CanBeStopped) {
  struct Stop final : Progress {
    void report(std::string_view, double) override {}
    bool cancelled() const override { return true; }
  } stop;
  const auto mesh = mesh_to_tolerance(Surface<Sphere>{}, 1.0, false, 1e-3, {.progress = &stop});
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.diagnostics().front().failure, Failure::interrupted);
}

TEST(MeshToTolerance, SaysWhenItFails) {
  struct Pessimist final : DistanceEstimate {
    double largest_distance(const ImplicitSurface&, const TriangleMesh& mesh) const override {
      return 1.0 + 1.0 / static_cast<double>(mesh.triangles.size());
    }
  } pessimist;
  const auto mesh = mesh_to_tolerance(Surface<Sphere>{}, 1.0, false, 0.5,
                                      {.most_attempts = 3, .estimate = &pessimist});
  ASSERT_TRUE(mesh);
  EXPECT_FALSE(mesh->reached);
  EXPECT_EQ(mesh->attempts.size(), 3U);
  EXPECT_EQ(mesh->cell, mesh->attempts.back().cell) << "the best of them";
  ASSERT_EQ(mesh.diagnostics().size(), 1U);
  EXPECT_EQ(mesh.diagnostics().front().failure, Failure::tolerance);
}

TEST(MeshToTolerance, ALimitKeepsTheBestMesh) {
  // The first cell is far too large for an ellipsoid of this radius of curvature.
  const auto mesh =
      mesh_to_tolerance(Surface<Ellipsoid>{}, 4.0, false, 1e-3, {.max_triangles = 2000});
  ASSERT_TRUE(mesh);
  EXPECT_FALSE(mesh->reached);
  EXPECT_FALSE(mesh->mesh.empty());
  EXPECT_EQ(mesh.diagnostics().front().failure, Failure::limit);
  EXPECT_EQ(mesh.diagnostics().back().failure, Failure::tolerance);
}

}  // namespace
}  // namespace cs2mesh
