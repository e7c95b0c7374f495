// What is proven to be near a surface has it on both sides wherever it is sampled.
#include "polygonize/near_proof.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libfield/base/check.h"
#include "libfield/base/random.h"
#include "libfield/field/field.h"
#include "polygonize/adaptive_mesher.h"
#include "tests/unit/polygonize/analytic_surfaces.h"
#include "tests/unit/polygonize/mesh_test_tools.h"
#include "tests/unit/polygonize/random_blobs.h"

namespace cs2mesh {
namespace {

std::vector<std::size_t> all_of(const TriangleMesh& mesh) {
  std::vector<std::size_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

/// Looks at random points of each proven triangle; returns how many are proven.
std::size_t expect_surface_around(const ImplicitSurface& surface, const TriangleMesh& mesh,
                                  double distance, Random& random) {
  const std::vector<Vec3d> ways = ways_out(mesh);
  const std::vector<std::size_t> all = all_of(mesh);
  const std::vector<bool> proven = proven_near(surface, mesh, all, ways, distance);
  EXPECT_EQ(proven.size(), all.size());
  std::size_t count = 0;
  for (const std::size_t t : all) {
    if (!proven[t]) continue;
    ++count;
    const auto& corner = mesh.triangles[t];
    for (int i = 0; i < 10; ++i) {
      const double u = random.uniform(), v = random.uniform() * (1 - u), w = 1 - u - v;
      const auto mixed = [&](const std::vector<Vec3d>& of) {
        return u * of[corner[0]] + v * of[corner[1]] + w * of[corner[2]];
      };
      const Vec3d p = mixed(mesh.positions), way = distance * mixed(ways);
      EXPECT_LE(norm(way), distance * (1 + 1e-12));
      EXPECT_LT(surface.value(p + way), 0.0) << t;
      EXPECT_GT(surface.value(p - way), 0.0) << t;
    }
  }
  return count;
}

TEST(NearProof, HoldsOfBlobsWhereverItIsSampled) {
  Random random(30, 1);
  for (int round = 0; round < 4; ++round) {
    const Field surface = test::random_blobs(random);
    MesherRequest request;
    request.tolerance = 0.02;
    request.thinnest_radius = 0.2;
    Result<MesherResult> made = mesh_adaptive(surface, request);
    ASSERT_TRUE(made && made->reached);
    TriangleMesh mesh = std::move(made->mesh);
    const std::size_t count = mesh.triangles.size();
    EXPECT_GT(expect_surface_around(surface, mesh, request.tolerance, random), count / 2);
    // Nor is anything proven that is not so of a mesh that is bad.
    for (Vec3d& p : mesh.positions)
      p += (random.uniform() * request.tolerance) * random.direction();
    for (const double share : {0.2, 0.5, 1.0, 2.0}) {
      EXPECT_LT(expect_surface_around(surface, mesh, share * request.tolerance, random), count);
    }
  }
}

TEST(NearProof, ABallIsAsTightAsItsTrianglesAre) {
  Term term;
  term.kernel = Gaussian{std::sqrt(2.0), 2.0};
  term.primitive = Point{Vec3d{}};
  term.frame = frame_of(term.primitive);
  const Field ball({term}, 1e-9);
  const TriangleMesh mesh = test::bare_sphere({}, 1, 3);
  double farthest = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d middle = (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3.0;
    farthest = std::max(farthest, 1 - norm(middle));
  }
  const std::vector<Vec3d> ways = ways_out(mesh);
  for (std::size_t v = 0; v < ways.size(); ++v) EXPECT_LT(norm(ways[v] - mesh.positions[v]), 1e-9);
  const std::vector<std::size_t> all = all_of(mesh);
  const auto proven_within = [&](double distance) {
    const std::vector<bool> proven = proven_near(ball, mesh, all, ways, distance);
    return static_cast<std::size_t>(std::count(proven.begin(), proven.end(), true));
  };
  EXPECT_EQ(proven_within(1.1 * farthest), all.size());
  EXPECT_LT(proven_within(0.95 * farthest), all.size());
  EXPECT_EQ(proven_within(0.1 * farthest), 0U);
}

TEST(NearProof, SurfacesOfWhichNothingIsKnownAreNotProven) {
  const analytic::Surface<analytic::Sphere> sphere;
  const TriangleMesh mesh = test::bare_sphere({}, 1, 2);
  const std::vector<bool> proven =
      proven_near(sphere, mesh, all_of(mesh), std::vector<Vec3d>(mesh.positions.size()), 0.1);
  EXPECT_EQ(std::count(proven.begin(), proven.end(), true), 0);
  EXPECT_THROW(proven_near(sphere, mesh, all_of(mesh), {}, 0.1), ContractViolation);
  EXPECT_THROW(proven_near(sphere, mesh, all_of(mesh), ways_out(mesh), 0.0), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
