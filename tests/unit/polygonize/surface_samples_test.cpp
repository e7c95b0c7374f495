// Samples lie on the surface, all over it.
#include "polygonize/surface_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libfield/field/field.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using analytic::Torus;
template <class Shape>
using Surface = analytic::Surface<Shape>;

TEST(SurfaceSamples, BlocksHoldAllOfTheSurface) {
  const Surface<Torus> torus;
  const std::vector<SurfaceBlock> blocks = surface_blocks(torus, torus.bounds(), 20000, 3);
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const double a = random.uniform(0, 2 * std::numbers::pi);
    const double b = random.uniform(0, 2 * std::numbers::pi);
    const double r = 1 + 0.3 * std::cos(b);
    const Vec3d p{r * std::cos(a), r * std::sin(a), 0.3 * std::sin(b)};
    const bool covered = std::any_of(blocks.begin(), blocks.end(), [&](const SurfaceBlock& block) {
      return block.box.distance(p) < 1e-12;
    });
    EXPECT_TRUE(covered);
  }
  std::vector<Vec3d> points;
  const int cells = cells_per_block(blocks.size(), 20000);
  for (const SurfaceBlock& block : blocks) append_crossings(block, cells, points);
  EXPECT_GT(points.size(), 10000u);
  EXPECT_LT(points.size(), 40000u);
  for (const Vec3d& p : points) {
    EXPECT_NEAR(std::hypot(std::hypot(p.x, p.y) - 1, p.z), 0.3, 1e-8);
  }
}

TEST(SurfaceSamples, LieOnTheSurfaceOfAStiffField) {
  // Inside, F is exp(-2000 t) at a depth t, and every Newton step as short as the one before.
  std::vector<Term> terms(1);
  terms[0].kernel = Gaussian{std::sqrt(1000.0), 1000.0};
  terms[0].primitive = Point{{0.2, -0.1, 0.3}};
  terms[0].frame = frame_of(terms[0].primitive);
  const Field ball(std::move(terms), 1e-9);
  const std::vector<SurfaceBlock> blocks = surface_blocks(ball, ball.bounds(), 20000, 3);
  std::vector<Vec3d> points;
  const int cells = cells_per_block(blocks.size(), 20000);
  for (const SurfaceBlock& block : blocks) append_crossings(block, cells, points);
  ASSERT_GT(points.size(), 5000u);
  for (const Vec3d& p : points) EXPECT_NEAR(norm(p - Vec3d{0.2, -0.1, 0.3}), 1.0, 1e-10);
}

}  // namespace
}  // namespace cs2mesh
