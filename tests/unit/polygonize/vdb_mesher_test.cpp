#include "polygonize/vdb_mesher.h"

#include <gtest/gtest.h>

#include <numbers>

#include "polygonize/check.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;
constexpr double kPi = std::numbers::pi;

TEST(VdbMesher, ASphere) {
  for (const double cell : {0.2, 0.1, 0.05}) {
    LatticeStatistics statistics;
    const auto mesh = mesh_vdb(Surface<Sphere>{}, {.cell = cell}, &statistics);
    ASSERT_TRUE(mesh);
    EXPECT_TRUE(check(*mesh).ok());
    for (const Vec3d& p : mesh->positions) EXPECT_NEAR(norm(p), 1.0, 1e-4 * cell);
    EXPECT_NEAR(volume(*mesh), 4 * kPi / 3, 8 * cell * cell);
    EXPECT_EQ(statistics.vertices, mesh->positions.size());
    EXPECT_EQ(statistics.triangles, mesh->triangles.size());
    EXPECT_GT(statistics.gradient_evaluations, statistics.vertices);
  }
}

TEST(VdbMesher, FlatPlacesTakeFewTriangles) {
  const double cell = 0.02;
  const auto mesh = mesh_vdb(Surface<Box>{}, {.cell = cell});
  ASSERT_TRUE(mesh);
  const double quadrilaterals = area(*mesh) / (cell * cell);
  EXPECT_LT(static_cast<double>(mesh->triangles.size()), quadrilaterals);
}

TEST(VdbMesher, WhatItCannotMeshIsRefused) {
  int whole = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const LatticeNoise noise(12, 0.2 + 0.015 * static_cast<double>(seed), 0.5, seed);
    const auto mesh = mesh_vdb(noise, {.cell = 1.0});
    if (mesh) {
      EXPECT_TRUE(check(*mesh).ok());
      ++whole;
    } else {
      EXPECT_EQ(mesh.diagnostics().front().failure, Failure::check_failed);
    }
  }
  EXPECT_GT(whole, 0);
}

}  // namespace
}  // namespace cs2mesh
