// Fewer and better triangles, by normals.
#include "polygonize/remesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/base/check.h"
#include "libfield/base/random.h"
#include "polygonize/check.h"
#include "polygonize/metrology.h"
#include "polygonize/octree_mesh.h"
#include "polygonize/sagitta.h"
#include "polygonize/triangle_shape.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

TEST(Sagitta, IsThatOfACircle) {
  const double angle = 0.01;
  const Vec3d a{std::cos(angle), std::sin(angle), 0}, b{std::cos(angle), -std::sin(angle), 0};
  EXPECT_NEAR(sagitta(a, a, b, b), 1 - std::cos(angle), 1e-3 * (1 - std::cos(angle)));
  EXPECT_LT(sagitta(a, -1.0 * a, b, -1.0 * b), 0) << "hollow";
}

TEST(Deviation, HasASideForTheHollowAndOneForTheConvex) {
  const DeviationRange bowl = deviation_range(-3, -3, -3), saddle = deviation_range(1, -1, 0);
  EXPECT_NEAR(bowl.low, -4, 1e-12);
  EXPECT_EQ(bowl.high, 0);
  EXPECT_EQ(saddle.low, -1);
  EXPECT_EQ(saddle.high, 1);
}

TEST(Deviation, IsTheGreatestOfTheFormOverTheTriangle) {
  Random random(1, 1);
  for (int round = 0; round < 200; ++round) {
    const double s01 = random.uniform(-1, 1), s12 = random.uniform(-1, 1),
                 s20 = random.uniform(-1, 1);
    double most = 0;
    constexpr int kSteps = 60;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const double l0 = double(i) / kSteps, l1 = double(j) / kSteps, l2 = 1 - l0 - l1;
        most = std::max(most, std::abs(4 * (s01 * l0 * l1 + s12 * l1 * l2 + s20 * l2 * l0)));
      }
    }
    EXPECT_NEAR(deviation(s01, s12, s20), most, 2e-3);
    EXPECT_GE(deviation(s01, s12, s20), most - 1e-12);
  }
}

TriangleMesh remeshed(const ImplicitSurface& surface, double tolerance, RemeshStatistics& log,
                      bool balance = false) {
  SurfaceOctreeOptions options;
  options.tolerance = tolerance;
  options.smallest = 0.1 * tolerance;
  const Result<SurfaceOctree> tree = SurfaceOctree::build(surface, options);
  const OctreeMesh first = mesh_octree(surface, *tree);
  RemeshOptions remeshing;
  remeshing.tolerance = tolerance;
  remeshing.balance = balance;
  return remesh(surface, *tree, first.mesh, first.leaf_of, remeshing, &log);
}

TEST(Remesh, KeepsTheTopologyAndAllButTheTolerance) {
  const Surface<Torus> torus;
  RemeshStatistics log;
  const TriangleMesh mesh = remeshed(torus, 0.002, log);
  const MeshReport report = check(mesh);
  EXPECT_TRUE(report.closed && report.manifold_edges && report.manifold_vertices);
  EXPECT_EQ(report.genus, 1);
  EXPECT_GT(log.collapses, 100U);
  MeasureOptions options;
  options.samples = 20'000;
  EXPECT_LT(measure(torus, mesh, options).max(), 0.002 * 1.3) << "the rest is for refine()";
}

TEST(Remesh, ASphereTakesLittleMoreThanTheOptimum) {
  const Surface<Sphere> sphere;
  RemeshStatistics log;
  const double tolerance = 1e-3;
  const TriangleMesh mesh = remeshed(sphere, tolerance, log);
  const double optimum = 0.385 * 4 * std::numbers::pi / tolerance;  // hexagonal, on the surface
  EXPECT_LT(static_cast<double>(mesh.triangles.size()), 1.45 * optimum);
  for (const Vec3d& p : mesh.positions) EXPECT_NEAR(norm(p), 1.0, 1e-9);
}

TEST(Remesh, BalancedASphereTakesHalfOfThatAndIsNearOnBothSides) {
  const Surface<Sphere> sphere;
  RemeshStatistics log;
  const double tolerance = 1e-3;
  const TriangleMesh mesh = remeshed(sphere, tolerance, log, true);
  const double optimum = 0.5 * 0.385 * 4 * std::numbers::pi / tolerance;
  EXPECT_LT(static_cast<double>(mesh.triangles.size()), 1.5 * optimum);
  for (const Vec3d& p : mesh.positions)
    EXPECT_NEAR(norm(p), 1.0 + 0.5 * tolerance, 0.5 * tolerance);
}

/// A ball of the radius sqrt(0.999) whose F has a kink just outside: 200 times as steep within.
struct Walled {
  template <class T>
  T operator()(const Vec3<T>& p) const {
    const T depth = ball(p, {}, 1.0);
    return larger(depth - T(0.1), (depth - T(0.001)) * T(200.0));
  }
  Aabb bounds() const { return cube(1.0); }
};

TEST(Remesh, VerticesEndOnTheSurfaceBesideAKink) {
  const Surface<Walled> ball;
  RemeshStatistics log;
  const TriangleMesh mesh = remeshed(ball, 0.02, log);
  EXPECT_GT(mesh.triangles.size(), 100U);
  for (const Vec3d& p : mesh.positions) EXPECT_NEAR(norm(p), std::sqrt(0.999), 1e-9);
}

TEST(Remesh, TrianglesOfATorusFollowItsCurvatureWithoutGettingThin) {
  const Surface<Torus> torus;
  RemeshStatistics log;
  const TriangleMesh mesh = remeshed(torus, 1e-3, log);
  const TriangleShapes shapes = triangle_shapes(mesh);
  EXPECT_LT(static_cast<double>(shapes.thin), 0.002 * static_cast<double>(mesh.triangles.size()));
}

TEST(Remesh, WantsATolerance) {
  const Surface<Sphere> sphere;
  SurfaceOctreeOptions options;
  options.tolerance = options.smallest = 0.1;
  const Result<SurfaceOctree> tree = SurfaceOctree::build(sphere, options);
  EXPECT_THROW(remesh(sphere, *tree, {}, {}, {}), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
