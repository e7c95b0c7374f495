// Regions of space, counted from above.
#include "polygonize/topology_proof.h"

#include <gtest/gtest.h>

#include "libfield/base/check.h"
#include "libfield/base/random.h"
#include "libfield/field/field.h"
#include "tests/unit/polygonize/analytic_surfaces.h"
#include "tests/unit/polygonize/proof_of.h"

namespace cs2mesh {
namespace {

TEST(TopologyProof, CountsTheRegionsOfSimpleShapes) {
  const analytic::Surface<analytic::Sphere> sphere;
  const analytic::Surface<analytic::Torus> torus;
  for (const ImplicitSurface* surface : {static_cast<const ImplicitSurface*>(&sphere),
                                         static_cast<const ImplicitSurface*>(&torus)}) {
    const TopologyProof proof = proof_of(*surface, 0.01);
    const auto regions = proof.regions({});
    ASSERT_EQ(regions.size(), 2U);
    EXPECT_TRUE(proof.open().empty());
    EXPECT_TRUE(regions[0].outside);
    EXPECT_FALSE(regions[1].outside);
    EXPECT_GT(surface->value(regions[1].leaf.center()), 0);
  }
}

Field balls(std::span<const Vec3d> centers, double blobbiness) {
  std::vector<Term> terms;
  for (const Vec3d& center : centers) {
    Term term;
    term.kernel = Gaussian{std::sqrt(blobbiness), blobbiness};
    term.primitive = Point{center};
    term.frame = frame_of(term.primitive);
    terms.push_back(std::move(term));
  }
  return {std::move(terms), 1e-9};
}

/// Gaps and necks of a hundredth of the radius: never fewer regions than there are.
TEST(TopologyProof, TellsGapsFromNecks) {
  for (const double distance : {2.12, 1.9}) {
    const std::array<Vec3d, 2> centers{Vec3d{-0.5 * distance, 0, 0}, {0.5 * distance, 0, 0}};
    const Field surface = balls(centers, 20.0);
    const std::size_t real = surface.value({0, 0, 0}) < 0 ? 3 : 2;
    const TopologyProof proof = proof_of(surface, 0.001);
    EXPECT_TRUE(proof.open().empty());
    EXPECT_GE(proof.regions({}).size(), real);
    TopologyProof::KnownPoints known;
    known.points = {centers[0], centers[1], {0, 0.5, 0}, {0, 0, 0.1}};
    known.inside = {true, true, surface.value({0, 0.5, 0}) > 0, surface.value({0, 0, 0.1}) > 0};
    EXPECT_GE(proof.regions(known).size(), real);
  }
}

TEST(TopologyProof, KnownPointsJoinRegions) {
  const std::array<Vec3d, 2> centers{Vec3d{-1.5, 0, 0}, {1.5, 0, 0}};
  const TopologyProof proof = proof_of(balls(centers, 6.0), 0.01);
  ASSERT_EQ(proof.regions({}).size(), 3U);
  TopologyProof::KnownPoints known;
  known.points = {centers[0], centers[1]};
  known.inside = {true, true};
  for (const auto& region : proof.regions(known)) EXPECT_EQ(region.known, !region.outside);
  known.together = {{0, 1}};
  EXPECT_EQ(proof.regions(known).size(), 2U);
}

/// There are no more regions than found; a void is one of its own.
TEST(TopologyProof, FindsAVoid) {
  Random random(3, 1);
  std::vector<Vec3d> centers;
  for (int i = 0; i < 400; ++i) centers.push_back(3.0 * random.direction());
  const Field shell = balls(centers, 4.0);
  ASSERT_LT(shell.value({0, 0, 0}), 0);
  const auto regions = proof_of(shell, 0.01).regions({});
  ASSERT_GE(regions.size(), 3U);
  EXPECT_TRUE(std::any_of(regions.begin() + 1, regions.end(), [](const auto& region) {
    return region.leaf.contains({0, 0, 0}) || norm(region.leaf.center()) < 1.5;
  }));
}

TEST(TopologyProof, LeavesWhatItCannotShowOpen) {
  const std::array<Vec3d, 2> centers{Vec3d{-1, 0, 0}, {1, 0, 0}};
  EXPECT_FALSE(proof_of(balls(centers, 20.0), 5.0).open().empty());
}

TEST(TopologyProof, HeedsItsLimits) {
  const Field ball = balls(std::array{Vec3d{}}, 2.0);
  TopologyProof::Options options;
  EXPECT_THROW((void)TopologyProof::build(ball, options), ContractViolation);
  options.smallest = 0.01;
  options.max_cells = 4;
  const Result<TopologyProof> proof = TopologyProof::build(ball, options);
  ASSERT_FALSE(proof);
  EXPECT_EQ(proof.diagnostics().front().failure, Failure::limit);
}

}  // namespace
}  // namespace cs2mesh
