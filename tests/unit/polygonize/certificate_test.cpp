// Certificates: what is right is proven, what is wrong is not.
#include "polygonize/certificate.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "libfield/base/check.h"
#include "libfield/base/random.h"
#include "libfield/field/field.h"
#include "polygonize/adaptive_mesher.h"
#include "polygonize/check.h"
#include "polygonize/lattice_mesher.h"
#include "polygonize/metrology.h"
#include "tests/unit/polygonize/mesh_test_tools.h"
#include "tests/unit/polygonize/proof_of.h"

namespace cs2mesh {
namespace {

Term term_over(Kernel kernel, Primitive primitive) {
  Term term;
  term.kernel = kernel;
  term.primitive = primitive;
  term.frame = frame_of(term.primitive);
  return term;
}

/// A Gaussian ball: log F = b (1 - r^2 / radius^2).
Term ball(const Vec3d& center, double radius, double b) {
  return term_over(Gaussian{std::sqrt(b) / radius, b}, Point{center});
}

Field sphere() {
  return Field({ball({}, 1.0, 2.0)}, 1e-9);
}

TriangleMesh meshed(const ImplicitSurface& surface, double radius, double tolerance) {
  MesherRequest request;
  request.tolerance = tolerance;
  request.thinnest_radius = radius;
  Result<MesherResult> made = mesh_adaptive(surface, request);
  EXPECT_TRUE(made && made->reached);
  return std::move(made->mesh);
}

Certificate certified(const ImplicitSurface& surface, const TriangleMesh& mesh, double radius,
                      double tolerance) {
  CertifyOptions options;
  options.tolerance = tolerance;
  Result<Certificate> result = certify(surface, mesh, proof_of(surface, radius / 64), options);
  EXPECT_TRUE(result);
  return std::move(*result);
}

std::size_t count(const Certificate& certificate, Doubt doubt) {
  return static_cast<std::size_t>(
      std::count(certificate.doubts.begin(), certificate.doubts.end(), doubt));
}

TEST(Certificate, ProvesASphere) {
  const Field surface = sphere();
  for (const double tolerance : {0.03, 0.003}) {
    const TriangleMesh mesh = meshed(surface, 1.0, tolerance);
    const Certificate all = certified(surface, mesh, 1.0, tolerance);
    EXPECT_EQ(all.share(), 1.0);
    EXPECT_TRUE(all.places.empty());
    EXPECT_NEAR(all.area, area(mesh), 1e-12 * all.area);
  }
}

/// Whose field is cut off in its middle.
TEST(Certificate, ProvesAStiffBall) {
  const Field surface({ball({}, 1.0, 1000)}, 1e-9);
  EXPECT_EQ(certified(surface, test::sphere_mesh(3), 1.0, 0.03).share(), 1.0);
  EXPECT_EQ(certified(surface, test::bare_sphere({}, 1.05, 3), 1.0, 0.03).share(), 0.0);
}

TEST(Certificate, ProvesATorusOfAnyKernelWithoutAnEnd) {
  const Arc circle = make_arc({}, 1.0, {0, 0, 1}, 0, 360);
  for (const Kernel& kernel : {Kernel(Gaussian{6.0, 2.0}), Kernel(Cauchy{6.0, 20.0})}) {
    const Field surface({term_over(kernel, circle)}, 1e-9);
    // From 0.019 on, triangles are so large that single ones cannot be told from folds.
    for (const double tolerance : {0.018, 0.012}) {
      const TriangleMesh mesh = meshed(surface, 0.3, tolerance);
      EXPECT_EQ(certified(surface, mesh, 0.3, 1.2 * tolerance).share(), 1.0);
    }
  }
}

/// A mesh that is measured to be too far off must not be certified where it is.
TEST(Certificate, DoubtsWhatIsTooFar) {
  const Field surface = sphere();
  const TriangleMesh good = test::sphere_mesh(3);
  const double tolerance = 0.03;
  ASSERT_EQ(certified(surface, good, 1.0, tolerance).share(), 1.0);
  for (const double moved : {-2.0, 2.0}) {
    TriangleMesh mesh = good;
    const TriangleMesh::Index v = 17;
    mesh.positions[v] *= 1 + moved * tolerance;
    const Certificate certificate = certified(surface, mesh, 1.0, tolerance);
    EXPECT_LT(certificate.share(), 1.0);
    double area = 0.0;
    for (const UncertifiedPlace& place : certificate.places) area += place.area;
    EXPECT_NEAR(certificate.area - certificate.certified_area, area, 1e-12);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& corners = mesh.triangles[t];
      const bool touches = std::find(corners.begin(), corners.end(), v) != corners.end();
      EXPECT_EQ(certificate.doubts[t] == Doubt::distance, touches) << t;
    }
    ASSERT_EQ(certificate.places.size(), count(certificate, Doubt::distance));
    EXPECT_LT(norm(certificate.places.front().position - mesh.positions[v]), 0.3);
  }
}

/// A strength that drops to a half in the middle of a bone.
TEST(Certificate, NamesJumpsOfProfiles) {
  Term bone = term_over(Gaussian{4.0, 3.0}, Segment{{-1, 0, 0}, {1, 0, 0}});
  StrengthProfile half;
  half.along_u = ProfileFunction::step;
  half.lower = 0.5;
  bone.profiles = {half};
  const Field surface({bone}, 1e-9);
  LatticeOptions lattice;
  lattice.cell = 0.05;
  const Result<TriangleMesh> mesh = mesh_lattice(surface, lattice);
  ASSERT_TRUE(mesh);
  const Certificate certificate = certified(surface, *mesh, 0.3, 0.05);
  EXPECT_GT(count(certificate, Doubt::profile), 0U);
  EXPECT_EQ(count(certificate, Doubt::crease), 0U);
}

TEST(Certificate, DoubtsASmallerTolerance) {
  const Field surface = sphere();
  const TriangleMesh mesh = test::sphere_mesh(3);
  EXPECT_EQ(certified(surface, mesh, 1.0, 0.001).share(), 0.0);
}

TEST(Certificate, DoubtsWhatIsFoldedOver) {
  const Field surface = sphere();
  TriangleMesh mesh = test::sphere_mesh(3);
  // A vertex slides over the surface beyond one of its neighbours: near, but folded over.
  const auto& [v, neighbour, other] = mesh.triangles[40];
  mesh.positions[v] = normalized(2.2 * mesh.positions[neighbour] - 1.2 * mesh.positions[v]);
  const Certificate certificate = certified(surface, mesh, 1.0, 0.2);
  EXPECT_GT(count(certificate, Doubt::fold) + count(certificate, Doubt::distance), 0U);
}

/// Two balls with a gap far below the tolerance, and the mesh of one alone: right where it is.
TEST(Certificate, DoubtsAMissingComponent) {
  const Field both({ball({-1.05, 0, 0}, 1.0, 20), ball({1.05, 0, 0}, 1.0, 20)}, 1e-9);
  const TriangleMesh mesh = meshed(both, 1.0, 0.03);
  const Certificate whole = certified(both, mesh, 1.0, 0.032);
  EXPECT_GT(whole.share(), 0.99);
  EXPECT_EQ(count(whole, Doubt::topology), 0U);
  TriangleMesh half = mesh;
  std::erase_if(half.triangles, [&](const auto& t) { return mesh.positions[t[0]].x > 0; });
  const Certificate certificate = certified(both, half, 1.0, 0.032);
  ASSERT_FALSE(certificate.places.empty());
  EXPECT_EQ(certificate.places.back().doubt, Doubt::topology);
  EXPECT_LT(norm(certificate.places.back().position - Vec3d{1.05, 0, 0}), 1.0);
}

TEST(Certificate, DoubtsWhatReachesIntoOpenLeaves) {
  const Field surface = sphere();
  const TriangleMesh mesh = test::sphere_mesh(3);
  const TopologyProof proof = proof_of(surface, 10.0);
  ASSERT_FALSE(proof.open().empty());
  CertifyOptions options;
  options.tolerance = 0.03;
  const Result<Certificate> certificate = certify(surface, mesh, proof, options);
  ASSERT_TRUE(certificate);
  EXPECT_GT(count(*certificate, Doubt::topology), mesh.triangles.size() / 2);
}

/// Whatever is certified all over is near when measured, both ways.
TEST(Certificate, WhatIsCertifiedIsNear) {
  Random random(20, 1);
  std::size_t whole = 0;
  for (int round = 0; round < 6; ++round) {
    std::vector<Term> terms;
    for (int i = 0; i < 6; ++i) {
      terms.push_back(ball(random.uniform() * random.direction(), random.uniform(0.2, 0.5),
                           random.uniform(1, 12)));
    }
    const Field surface(std::move(terms), 1e-9);
    const TriangleMesh mesh = meshed(surface, 0.2, 0.02);
    const Certificate certificate = certified(surface, mesh, 0.2, 0.022);
    EXPECT_GT(certificate.share(), 0.99);
    if (certificate.share() < 1) continue;
    ++whole;
    MeasureOptions options;
    options.samples = 5000;
    EXPECT_LE(measure(surface, mesh, options).max(), 0.022);
  }
  EXPECT_GT(whole, 0U);
}

Certificate refined(const ImplicitSurface& surface, TriangleMesh& mesh, double radius,
                    double tolerance) {
  CertifyOptions options;
  options.tolerance = tolerance;
  Result<Certificate> result =
      certify_refined(surface, mesh, proof_of(surface, radius / 64), options);
  EXPECT_TRUE(result);
  return std::move(*result);
}

/// Meshes that use all of their tolerance leave no room for the shells of whole triangles, but for
/// those of their parts.
TEST(Certificate, ProvesWhatUsesAllOfItsTolerance) {
  const Field torus({term_over(Cauchy{6.0, 20.0}, make_arc({}, 1.0, {0, 0, 1}, 0, 360))}, 1e-9);
  const double tolerance = 0.03;
  const TriangleMesh mesh = meshed(torus, 0.3, tolerance);
  EXPECT_EQ(certified(torus, mesh, 0.3, tolerance).share(), 1.0);
}

TEST(Certificate, CutsWhatItCannotProve) {
  const Field torus({term_over(Cauchy{6.0, 20.0}, make_arc({}, 1.0, {0, 0, 1}, 0, 360))}, 1e-9);
  const double tolerance = 0.03;
  const TriangleMesh mesh = meshed(torus, 0.3, 1.3 * tolerance);
  ASSERT_LT(certified(torus, mesh, 0.3, tolerance).share(), 1.0);
  TriangleMesh finer = mesh;
  const Certificate certificate = refined(torus, finer, 0.3, tolerance);
  EXPECT_EQ(certificate.share(), 1.0);
  EXPECT_EQ(certificate.doubts.size(), finer.triangles.size());
  EXPECT_LE(finer.triangles.size(), 4 * mesh.triangles.size());
  EXPECT_TRUE(check(finer).ok());
  ASSERT_GE(finer.positions.size(), mesh.positions.size());
  EXPECT_TRUE(std::equal(mesh.positions.begin(), mesh.positions.end(), finer.positions.begin()));
  EXPECT_LE(measure(torus, finer, {}).max(), tolerance);
}

/// Whether the surface is within a distance of a point, along the gradient there.
bool is_near(const ImplicitSurface& surface, const Vec3d& p, double distance) {
  const Jet jet = surface.jet(p);
  const Vec3d way = (jet.value > 0 ? -distance : distance) * normalized(jet.gradient);
  return (surface.value(p + way) > 0) != (jet.value > 0);
}

/// A mesh that is moved here and there: of what is certified, each point is near and no triangle
/// shows its back.
TEST(Certificate, WhatIsCertifiedOfAMovedMeshIsRight) {
  const Field surface({ball({-0.5, 0, 0}, 1.0, 4), ball({0.6, 0, 0}, 0.7, 6)}, 1e-9);
  const double tolerance = 0.03;
  const TriangleMesh good = meshed(surface, 0.7, 0.8 * tolerance);
  Random random(6, 9);
  std::size_t proven = 0, doubted = 0;
  for (int round = 0; round < 8; ++round) {
    TriangleMesh mesh = good;
    for (Vec3d& p : mesh.positions) {
      if (random.uniform() < 0.1) p += random.uniform(0.2, 2.0) * tolerance * random.direction();
    }
    const Certificate certificate = certified(surface, mesh, 0.7, tolerance);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (certificate.doubts[t] != Doubt::none) {
        ++doubted;
        continue;
      }
      ++proven;
      const auto& [a, b, c] = mesh.triangles[t];
      EXPECT_LT(dot(area_vector(mesh, t), surface.jet(centroid(mesh, t)).gradient), 0);
      for (int k = 0; k < 8; ++k) {
        const double u = random.uniform(), v = random.uniform() * (1 - u);
        const Vec3d p = mesh.positions[a] + u * (mesh.positions[b] - mesh.positions[a]) +
                        v * (mesh.positions[c] - mesh.positions[a]);
        EXPECT_TRUE(is_near(surface, p, 1.02 * tolerance)) << t;
      }
    }
  }
  EXPECT_GT(proven, doubted / 4);
  EXPECT_GT(doubted, 100U);
}

TEST(Certificate, CutsNothingWhereAllIsProven) {
  const Field surface = sphere();
  const TriangleMesh mesh = meshed(surface, 1.0, 0.03);
  TriangleMesh finer = mesh;
  EXPECT_EQ(refined(surface, finer, 1.0, 0.03).share(), 1.0);
  EXPECT_EQ(finer.triangles, mesh.triangles);
}

/// A sheet that is not there is missed however often the other one is cut.
TEST(Certificate, CuttingDoesNotMakeUpForAMissingComponent) {
  const Field both({ball({-1.05, 0, 0}, 1.0, 20), ball({1.05, 0, 0}, 1.0, 20)}, 1e-9);
  TriangleMesh half = meshed(both, 1.0, 0.03);
  std::erase_if(half.triangles, [&](const auto& t) { return half.positions[t[0]].x > 0; });
  const Certificate certificate = refined(both, half, 1.0, 0.03);
  ASSERT_FALSE(certificate.places.empty());
  EXPECT_EQ(certificate.places.back().doubt, Doubt::topology);
}

/// Near the place where two balls touch nothing can be proven, but ever less is left.
TEST(Certificate, CutsTowardsASingularPlace) {
  // F = 1 where they touch: 2 exp(4 - 4 d^2) = 1.
  const double d = std::sqrt(1 + 0.25 * std::log(2.0));
  const Field touching({ball({-d, 0, 0}, 1.0, 4), ball({d, 0, 0}, 1.0, 4)}, 1e-9);
  TriangleMesh mesh = meshed(touching, 1.0, 0.05);
  const double before = certified(touching, mesh, 1.0, 0.05).share();
  const Certificate certificate = refined(touching, mesh, 1.0, 0.05);
  EXPECT_GT(before, 0.99);
  EXPECT_LT(before, 1.0);
  EXPECT_GT(certificate.share(), 0.999);
  EXPECT_LT(certificate.share(), 1.0);
  EXPECT_TRUE(check(mesh).ok());
}

TEST(Certificate, IsTheSameForAnyNumberOfThreads) {
  const Field surface({ball({-0.5, 0, 0}, 1.0, 4), ball({0.6, 0, 0}, 0.7, 6)}, 1e-9);
  const TriangleMesh mesh = meshed(surface, 0.7, 0.02);
  std::vector<std::vector<Doubt>> doubts;
  for (const int threads : {1, 2, 5}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    doubts.push_back(certified(surface, mesh, 0.7, 0.02).doubts);
  }
  EXPECT_EQ(doubts[0], doubts[1]);
  EXPECT_EQ(doubts[0], doubts[2]);
}

TEST(Certificate, WantsATolerance) {
  EXPECT_THROW((void)certify(sphere(), test::sphere_mesh(0), proof_of(sphere(), 0.1), {}),
               ContractViolation);
}

TEST(Certificate, AnEmptyMeshIsRightOfNothingAlone) {
  CertifyOptions options;
  options.tolerance = 1.0;
  const Field nothing({term_over(Gaussian{1.0, -1.0}, Point{})}, 1e-9);
  const Result<Certificate> right = certify(nothing, {}, proof_of(nothing, 0.1), options);
  ASSERT_TRUE(right);
  EXPECT_TRUE(right->places.empty());
  const Result<Certificate> wrong = certify(sphere(), {}, proof_of(sphere(), 0.1), options);
  ASSERT_TRUE(wrong);
  EXPECT_EQ(wrong->places.size(), 1U);
}

/// A mesh of which enough is certified stays as it is, and one that is hopeless as well.
TEST(Certificate, CutsOnlyWhereThatIsAskedFor) {
  const Field surface({ball({-0.9, 0, 0}, 1.0, 6.0), ball({0.9, 0, 0}, 1.0, 6.0)}, 1e-9);
  const double tolerance = 0.08;
  const TriangleMesh coarse = meshed(surface, 1.0, tolerance);
  const TopologyProof topology = proof_of(surface, 1.0 / 64);
  const auto cut = [&](double enough, double hopeless) {
    CertifyOptions options;
    options.tolerance = 0.3 * tolerance;  // most of it is too far
    options.enough = enough;
    options.hopeless = hopeless;
    TriangleMesh mesh = coarse;
    const Result<Certificate> certificate = certify_refined(surface, mesh, topology, options);
    EXPECT_TRUE(certificate);
    return std::pair(mesh.triangles.size(), certificate->share());
  };
  const auto [as_it_is, share] = cut(0.0, 0.0);
  EXPECT_EQ(as_it_is, coarse.triangles.size());
  ASSERT_LT(share, 0.9);
  EXPECT_EQ(cut(1.0, 0.9).first, coarse.triangles.size());
  const auto [finer, more] = cut(1.0, 0.0);
  EXPECT_GT(finer, coarse.triangles.size());
  EXPECT_LE(finer, 4 * coarse.triangles.size());
  EXPECT_GT(more, 0.99);
}

}  // namespace
}  // namespace cs2mesh
