// Fewer triangles and no thin ones, within the tolerance.
#include "polygonize/improve.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libfield/base/check.h"
#include "polygonize/check.h"
#include "polygonize/far_triangles.h"
#include "polygonize/lattice_mesher.h"
#include "polygonize/metrology.h"
#include "polygonize/triangle_set.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

TEST(Improve, TakesOutWhatTheToleranceCanSpare) {
  const Surface<Torus> torus;
  LatticeOptions lattice;
  lattice.cell = 0.1;
  const Result<TriangleMesh> first = mesh_lattice(torus, lattice);
  const double tolerance = 0.01;
  ImproveStatistics log;
  const TriangleMesh mesh = improve(torus, *first, {tolerance}, &log);
  EXPECT_LT(mesh.triangles.size(), first->triangles.size() * 6 / 10);
  EXPECT_EQ(first->triangles.size() - mesh.triangles.size(), 2 * log.collapses);
  const MeshReport report = check(mesh);
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.genus, 1);
  MeasureOptions options;
  options.samples = 20'000;
  EXPECT_LT(measure(torus, mesh, options).max(), tolerance * 1.05);
  const MeshReport before = check(*first);
  EXPECT_GT(before.shapes.thin, 50U);
  EXPECT_LT(report.shapes.thin, before.shapes.thin / 20);
}

TEST(Improve, TellsWhichTrianglesItMeasured) {
  const Surface<Torus> torus;
  LatticeOptions lattice;
  lattice.cell = 0.1;
  const double tolerance = 0.01;
  ImproveStatistics log;
  const TriangleMesh mesh = improve(torus, *mesh_lattice(torus, lattice), {tolerance}, &log);
  std::sort(log.near.begin(), log.near.end());
  std::vector<std::size_t> known;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (std::binary_search(log.near.begin(), log.near.end(), triangle_key(mesh, t))) {
      known.push_back(t);
    }
  }
  EXPECT_GT(known.size(), mesh.triangles.size() / 4);
  // Measured once more they are near.
  FarOptions options;
  options.tolerance = tolerance;
  EXPECT_TRUE(far_triangles(torus, mesh, known, options).empty());
}

TEST(Improve, LeavesAloneWhatItCannotMeasureToBeNear) {
  const Surface<Sphere> sphere;
  LatticeOptions lattice;
  lattice.cell = 0.25;
  const Result<TriangleMesh> first = mesh_lattice(sphere, lattice);
  const TriangleMesh mesh = improve(sphere, *first, {1e-9});
  EXPECT_EQ(mesh.triangles, first->triangles);
  EXPECT_EQ(mesh.positions, first->positions);
}

TEST(Improve, WantsATolerance) {
  const Surface<Sphere> sphere;
  EXPECT_THROW(improve(sphere, {}, {}), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
