// What is proven of a shell holds wherever it is sampled, also of meshes that have been cut.
#include "polygonize/shell_certifier.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libfield/base/random.h"
#include "libfield/field/field.h"
#include "libfield/profile/cone_weight.h"
#include "polygonize/adaptive_mesher.h"
#include "polygonize/lattice_mesher.h"
#include "polygonize/refine.h"
#include "tests/unit/polygonize/mesh_test_tools.h"
#include "tests/unit/polygonize/random_blobs.h"

namespace cs2mesh {
namespace {

TriangleMesh meshed(const ImplicitSurface& surface, double tolerance) {
  MesherRequest request;
  request.tolerance = tolerance;
  request.thinnest_radius = 0.2;
  Result<MesherResult> made = mesh_adaptive(surface, request);
  EXPECT_TRUE(made && made->reached);
  return std::move(made->mesh);
}

/// Along segments of certified triangles: outside, once through the surface, inside.
void expect_one_crossing(const ImplicitSurface& surface, const TriangleMesh& mesh,
                         const ShellCertifier& certifier, double tolerance) {
  Random random(31, 1);
  const std::vector<Doubt> doubts = certifier.doubts();
  ASSERT_EQ(doubts.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (doubts[t] != Doubt::none) continue;
    const auto corners = prism_corners(mesh, certifier.shell(), t);
    const double u = random.uniform(), v = random.uniform() * (1 - u);
    const auto at = [&](std::size_t first) {
      return u * corners[first] + v * corners[first + 1] + (1 - u - v) * corners[first + 2];
    };
    const Vec3d outer = at(0), inner = at(3);
    EXPECT_LE(norm(outer - inner), 2 * tolerance);
    EXPECT_LT(surface.value(outer), 0.0);
    EXPECT_GT(surface.value(inner), 0.0);
    int changes = 0;
    bool inside = false;
    constexpr int kSteps = 20;
    for (int k = 1; k <= kSteps; ++k) {
      const bool now = surface.value(outer + (double(k) / kSteps) * (inner - outer)) > 0;
      changes += now != inside ? 1 : 0;
      inside = now;
    }
    EXPECT_EQ(changes, 1) << t;
  }
}

TEST(ShellCertifier, SegmentsOfWhatIsProvenCrossTheSurfaceOnce) {
  Random random(30, 1);
  constexpr double kTolerance = 0.02;
  for (int round = 0; round < 4; ++round) {
    const Field surface = test::random_blobs(random);
    const TriangleMesh mesh = meshed(surface, kTolerance);
    ShellCertifier certifier(surface, kTolerance, nullptr);
    ASSERT_TRUE(certifier.run(mesh));
    expect_one_crossing(surface, mesh, certifier, kTolerance);
    // Some triangles are cut, whatever is known of them.
    std::vector<std::uint32_t> some;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); t += 7) some.push_back(t);
    const std::vector<bool> all(mesh.positions.size(), true);
    RefineOptions refinement;
    refinement.tolerance = kTolerance;
    refinement.most_rounds = 1;
    refinement.first_looked_at = &some;
    refinement.close = &all;
    refinement.closer = 1e-9 * kTolerance;
    const TriangleMesh finer = refine(surface, mesh, refinement);
    ASSERT_GT(finer.triangles.size(), mesh.triangles.size());
    const std::size_t before = certifier.counts().values;
    ASSERT_TRUE(certifier.run(finer));
    expect_one_crossing(surface, finer, certifier, kTolerance);
    EXPECT_GT(certifier.counts().values, before);
  }
}

/// A bone whose strength has corners, as those of a hat, or bends.
Field bone_with(const StrengthProfile& profile) {
  Term bone;
  bone.kernel = Gaussian{4.0, 3.0};
  bone.primitive = Segment{{-1, 0, 0}, {1, 0.2, 0.1}};
  bone.frame = frame_of(bone.primitive);
  bone.profiles = {profile};
  return Field({bone}, 1e-9);
}

TEST(ShellCertifier, ProvesKinksOnceTheTrianglesAreSmallEnough) {
  StrengthProfile hat;
  hat.along_u = ProfileFunction::hat;
  hat.translate_u = 0.25;
  hat.scale_u = 0.5;
  hat.lower = 0.6;
  for (const auto& profile : {hat, cone_weight(KernelKind::gaussian, 1.2, 0.7)}) {
    const Field surface = bone_with(profile);
    constexpr double kTolerance = 0.01;
    LatticeOptions lattice;
    lattice.cell = 0.06;
    const Result<TriangleMesh> mesh = mesh_lattice(surface, lattice);
    ASSERT_TRUE(mesh);
    ShellCertifier certifier(surface, kTolerance, nullptr);
    ASSERT_TRUE(certifier.run(*mesh));
    expect_one_crossing(surface, *mesh, certifier, kTolerance);
    const std::vector<Doubt> doubts = certifier.doubts();
    const auto proven = std::count(doubts.begin(), doubts.end(), Doubt::none);
    EXPECT_GT(static_cast<double>(proven), 0.97 * static_cast<double>(doubts.size()));
  }
}

TEST(ShellCertifier, AsksNoMoreOfAMeshThatIsTheSame) {
  Random random(32, 1);
  const Field surface = test::random_blobs(random);
  const TriangleMesh mesh = meshed(surface, 0.02);
  ShellCertifier certifier(surface, 0.02, nullptr);
  ASSERT_TRUE(certifier.run(mesh));
  const std::vector<Doubt> doubts = certifier.doubts();
  const std::size_t values = certifier.counts().values, bounds = certifier.counts().bounds;
  ASSERT_TRUE(certifier.run(mesh));
  EXPECT_EQ(certifier.doubts(), doubts);
  EXPECT_EQ(certifier.counts().values, values);
  EXPECT_EQ(certifier.counts().bounds, bounds);
}

/// All that is worth cutting is in doubt or beside what is.
TEST(ShellCertifier, NothingIsWorthCuttingWhereAllIsProven) {
  const Field surface = [] {
    Random random(33, 1);
    return test::random_blobs(random);
  }();
  const TriangleMesh mesh = meshed(surface, 0.01);
  ShellCertifier certifier(surface, 0.03, nullptr);
  ASSERT_TRUE(certifier.run(mesh));
  const std::vector<Doubt> doubts = certifier.doubts();
  const bool all =
      std::all_of(doubts.begin(), doubts.end(), [](Doubt doubt) { return doubt == Doubt::none; });
  EXPECT_EQ(certifier.worth_cutting().empty(), all);
}

}  // namespace
}  // namespace cs2mesh
