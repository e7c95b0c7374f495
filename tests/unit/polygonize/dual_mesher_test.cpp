#include "polygonize/dual_mesher.h"

#include <gtest/gtest.h>

#include <numbers>

#include "polygonize/check.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;
constexpr double kPi = std::numbers::pi;

TEST(DualMesher, ASphereToSecondOrder) {
  double last_error = 0;
  for (const double cell : {0.2, 0.1, 0.05}) {
    const auto mesh = mesh_dual(Surface<Sphere>{}, {.cell = cell});
    ASSERT_TRUE(mesh);
    EXPECT_TRUE(check(*mesh).ok());
    for (const Vec3d& p : mesh->positions) EXPECT_NEAR(norm(p), 1.0, 1e-4 * cell);
    const double error = std::abs(volume(*mesh) - 4 * kPi / 3);
    if (last_error > 0) {
      EXPECT_NEAR(last_error / error, 4.0, 1.0);
    }
    last_error = error;
  }
}

TEST(DualMesher, EdgesAndCornersAreExact) {
  for (const double cell : {0.17, 0.11, 0.09}) {
    const Box box;
    const auto mesh = mesh_dual(Surface<Box>{}, {.cell = cell, .origin = {0.01, 0.02, 0.03}});
    ASSERT_TRUE(mesh);
    EXPECT_TRUE(check(*mesh).ok());
    const Vec3d& h = box.half_sides;
    EXPECT_NEAR(volume(*mesh), 8 * h.x * h.y * h.z, 1e-3 * h.x * h.y * h.z);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d p = box.bounds().corner(corner);
      double nearest = 1;
      for (const Vec3d& q : mesh->positions) nearest = std::min(nearest, norm(q - p));
      EXPECT_LT(nearest, 1e-3 * cell);
    }
  }
}

TEST(DualMesher, ACurvedCreaseIsFollowed) {
  // Where the saddle z = x^2 - y^2 meets the sphere.
  const double cell = 0.1;
  const auto mesh = mesh_dual(Surface<ClippedSaddle>{}, {.cell = cell});
  ASSERT_TRUE(mesh) << mesh.diagnostics().front().message;
  EXPECT_TRUE(check(*mesh).ok());
  int on_crease = 0;
  for (const Vec3d& p : mesh->positions) {
    const double from_saddle = std::abs(p.x * p.x - p.y * p.y - p.z);
    const double from_sphere = std::abs(norm(p) - 1);
    EXPECT_LE(std::min(from_saddle, from_sphere), 2e-3 * cell);
    if (std::max(from_saddle, from_sphere) < 2e-3 * cell) ++on_crease;
  }
  EXPECT_GT(on_crease, 50);
}

TEST(DualMesher, EveryPatternOfSignsGivesAClosedManifold) {
  int crossed = 0, whole = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const LatticeNoise noise(6, 0.2 + 0.015 * static_cast<double>(seed), 0.5, seed);
    const auto mesh = mesh_dual(noise, {.cell = 1.0});
    if (mesh) {
      EXPECT_TRUE(check(*mesh).ok());
      ++whole;
      continue;
    }
    // The lattice is far too coarse for noise; but that is all that is wrong.
    EXPECT_EQ(mesh.diagnostics().front().failure, Failure::check_failed);
    EXPECT_NE(mesh.diagnostics().front().message.find("cross"), std::string::npos);
    ++crossed;
  }
  EXPECT_EQ(crossed + whole, 40);
  EXPECT_GT(whole, 0);
}

TEST(DualMesher, CountsWhatItEvaluates) {
  LatticeStatistics statistics;
  const auto mesh = mesh_dual(Surface<Torus>{}, {.cell = 0.1}, &statistics);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(statistics.vertices, mesh->positions.size());
  EXPECT_EQ(statistics.triangles, mesh->triangles.size());
  EXPECT_EQ(statistics.off_surface, 0.0);
  EXPECT_GT(statistics.gradient_evaluations, statistics.vertices);
  EXPECT_EQ(check(*mesh).genus, 1);
}

}  // namespace
}  // namespace cs2mesh
