#include "polygonize/narrow_band.h"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <tuple>

#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

template <class S>
NarrowBand band_of(const S& surface, double cell, Vec3d origin = {}) {
  auto band = NarrowBand::build(surface, {.cell = cell, .origin = origin});
  return *std::move(band);
}

/// Every zero on random lines lies in an active block.
template <class S>
void expect_no_surface_outside(const S& surface, double cell) {
  const NarrowBand band = band_of(surface, cell, {0.013, -0.007, 0.003});
  std::set<std::tuple<int, int, int>> active;
  for (std::size_t b = 0; b < band.active_count(); ++b) {
    active.insert({band.coord(b).x, band.coord(b).y, band.coord(b).z});
  }
  Random random(3);
  const Aabb box = surface.bounds();
  int found = 0;
  for (int i = 0; i < 2000; ++i) {
    Vec3d a = box.center() + 0.5 * box.diagonal() * random.direction();
    Vec3d b = box.center() + random.uniform(0, 0.4) * box.diagonal() * random.direction();
    if ((surface.value(a) >= 0) == (surface.value(b) >= 0)) continue;
    for (int k = 0; k < 60; ++k) {
      const Vec3d m = 0.5 * (a + b);
      ((surface.value(m) >= 0) == (surface.value(a) >= 0) ? a : b) = m;
    }
    const Vec3d in_blocks = (a - band.lattice().origin) / (8 * cell);
    ++found;
    EXPECT_TRUE(active.contains({static_cast<int>(std::floor(in_blocks.x)),
                                 static_cast<int>(std::floor(in_blocks.y)),
                                 static_cast<int>(std::floor(in_blocks.z))}));
  }
  EXPECT_GT(found, 50);
}

TEST(NarrowBand, NoBlockWithSurfaceIsSkipped) {
  expect_no_surface_outside(Surface<Sphere>{}, 0.03);
  expect_no_surface_outside(Surface<Torus>{}, 0.02);
  expect_no_surface_outside(Surface<GyroidInBall>{}, 0.04);
  expect_no_surface_outside(Surface<ThinPlate>{}, 0.05);
}

TEST(NarrowBand, KnowsFOrItsSignAtEveryNodeOfActiveBlocks) {
  const Surface<Ellipsoid> surface;
  const NarrowBand band = band_of(surface, 0.03);
  std::set<std::tuple<int, int, int>> needed;
  for (std::size_t b = 0; b < band.active_count(); ++b) {
    const Int3 low = 8 * band.coord(b);
    for (int x = 0; x <= 8; ++x) {
      for (int y = 0; y <= 8; ++y) {
        for (int z = 0; z <= 8; ++z) needed.insert({low.x + x, low.y + y, low.z + z});
      }
    }
  }
  std::size_t sampled = 0;
  std::size_t evaluated = 0;
  for (std::size_t b = 0; b < band.block_count(); ++b) {
    band.sampled(b).for_each([&](int offset) {
      const Int3 n = 8 * band.coord(b) + local_node(offset);
      EXPECT_TRUE(needed.contains({n.x, n.y, n.z}));
      const double known = band.values(b)[static_cast<std::size_t>(offset)];
      const double f = surface.value(band.node_position(b, offset));
      if (std::isinf(known)) {
        EXPECT_EQ(known > 0, f >= 0);
      } else {
        EXPECT_EQ(known, f);
        ++evaluated;
      }
      ++sampled;
    });
  }
  EXPECT_EQ(sampled, needed.size());
  EXPECT_EQ(evaluated, band.counts().nodes_evaluated);
  EXPECT_LT(evaluated, needed.size() / 2);
}

TEST(NarrowBand, ActiveBlocksGrowWithTheAreaNotTheVolume) {
  const std::size_t coarse = band_of(Surface<Sphere>{}, 0.02).active_count();
  const std::size_t fine = band_of(Surface<Sphere>{}, 0.01).active_count();
  EXPECT_LT(fine, 5 * coarse);
  EXPECT_GT(fine, 3 * coarse);
}

TEST(NarrowBand, LimitsAreErrorsAndContractsAreChecked) {
  const Surface<Sphere> sphere;
  const auto too_fine = NarrowBand::build(sphere, {.cell = 1e-4, .max_nodes = 100000});
  ASSERT_FALSE(too_fine);
  EXPECT_EQ(too_fine.diagnostics().front().failure, Failure::limit);
  const auto absurd = NarrowBand::build(sphere, {.cell = 1e-300});
  ASSERT_FALSE(absurd);
  EXPECT_EQ(absurd.diagnostics().front().failure, Failure::limit);
  EXPECT_THROW(NarrowBand::build(sphere, {.cell = 0}), ContractViolation);
  EXPECT_THROW(NarrowBand::build(sphere, {.cell = std::nan("")}), ContractViolation);
}

TEST(NarrowBand, StopsWhenCancelled) {
  struct Cancelled final : Progress {
    bool cancelled() const override { return true; }
  } progress;
  const Surface<Sphere> sphere;
  const auto band = NarrowBand::build(sphere, {.cell = 0.1, .progress = &progress});
  ASSERT_FALSE(band);
  EXPECT_EQ(band.diagnostics().front().failure, Failure::interrupted);
}

}  // namespace
}  // namespace cs2mesh
