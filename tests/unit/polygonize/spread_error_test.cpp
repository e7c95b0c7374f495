// Vertices moved so that triangles are equally far from a surface.
#include "polygonize/spread_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libfield/base/check.h"
#include "libfield/base/random.h"
#include "polygonize/balanced_heights.h"
#include "polygonize/check.h"
#include "polygonize/sagitta.h"
#include "polygonize/shape_operator.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// A torus of radii 1 and 0.4 by a grid whose vertices are shaken.
struct Torus {
  TriangleMesh mesh;
  std::vector<Vec3d> normals;
};
Torus shaken_torus(Index around, Index along) {
  Random random(3, 1);
  Torus torus;
  for (Index i = 0; i < along; ++i) {
    for (Index j = 0; j < around; ++j) {
      const double u = 2 * M_PI * (i + random.uniform(-0.25, 0.25)) / along;
      const double v = 2 * M_PI * (j + random.uniform(-0.25, 0.25)) / around;
      const Vec3d out{std::cos(u), std::sin(u), 0};
      torus.normals.push_back(std::cos(v) * out + Vec3d{0, 0, std::sin(v)});
      torus.mesh.positions.push_back(out + 0.4 * torus.normals.back());
      const auto at = [&](Index di, Index dj) {
        return (i + di) % along * around + (j + dj) % around;
      };
      torus.mesh.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
      torus.mesh.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
    }
  }
  return torus;
}

double rise(const Torus& torus, Index a, Index b) {
  return sagitta(torus.mesh.positions[a], torus.normals[a], torus.mesh.positions[b],
                 torus.normals[b]);
}
double farthest(const Torus& torus) {
  double most = 0.0;
  for (const auto& [a, b, c] : torus.mesh.triangles) {
    most = std::max(most, deviation(rise(torus, a, b), rise(torus, b, c), rise(torus, c, a)));
  }
  return most;
}
double distance_to_torus(const Vec3d& p) {
  return std::hypot(std::hypot(p.x, p.y) - 1, p.z) - 0.4;
}

/// What spread_error() makes of it, where triangles may be `allowed` off.
Torus spread(const Torus& torus, double allowed, int sweeps) {
  std::vector<SpreadVertex> vertices;
  for (const Symmetric3& shape : shape_operators(torus.mesh, torus.normals)) {
    vertices.push_back({shape, allowed, 0.0});
  }
  Torus spread{{}, torus.normals};
  EditableMesh mesh(torus.mesh);
  spread_error(mesh, spread.normals, vertices, sweeps);
  spread.mesh = mesh.take();
  return spread;
}

TEST(SpreadError, BringsTheFarthestTrianglesNearer) {
  const Torus before = shaken_torus(40, 80);
  const Torus after = spread(before, 0.5 * farthest(before), 4);
  EXPECT_LT(farthest(after), 0.75 * farthest(before));
  EXPECT_EQ(after.mesh.triangles.size(), before.mesh.triangles.size());
  EXPECT_EQ(after.mesh.positions.size(), before.mesh.positions.size());
}

TEST(SpreadError, KeepsVerticesNearTheSurfaceAndTheMeshSound) {
  const Torus before = shaken_torus(40, 80);
  const double far = farthest(before);
  const Torus after = spread(before, 0.5 * far, 4);
  for (std::size_t v = 0; v < after.mesh.positions.size(); ++v) {
    EXPECT_LT(std::abs(distance_to_torus(after.mesh.positions[v])), 0.3 * far);
    EXPECT_NEAR(norm(after.normals[v]), 1, 1e-12);
  }
  for (std::size_t t = 0; t < after.mesh.triangles.size(); ++t) {
    for (const Index v : after.mesh.triangles[t]) {
      EXPECT_GT(dot(area_vector(after.mesh, t), after.normals[v]), 0);
    }
  }
  const MeshReport report = check(after.mesh);
  EXPECT_TRUE(report.closed && report.oriented);
}

TEST(SpreadError, DoesNothingWhereNormalsTurnMuch) {
  const Torus before = shaken_torus(10, 12);  // 36 degrees from one vertex to the next, or more
  const Torus after = spread(before, 0.01, 2);
  EXPECT_EQ(after.mesh.triangles, before.mesh.triangles);
  EXPECT_EQ(after.mesh.positions, before.mesh.positions);
}

TEST(SmoothShare, IsThatOfEdgesAlongWhichNormalsHardlyTurn) {
  const Torus fine = shaken_torus(40, 80), coarse = shaken_torus(6, 6);
  EXPECT_EQ(smooth_share(EditableMesh(fine.mesh), fine.normals), 1);
  EXPECT_LT(smooth_share(EditableMesh(coarse.mesh), coarse.normals), 0.2);
}

TEST(SpreadError, AsksForOneVertexEach) {
  const Torus torus = shaken_torus(10, 12);
  EditableMesh mesh(torus.mesh);
  std::vector<Vec3d> normals = torus.normals;
  EXPECT_THROW(spread_error(mesh, normals, {}, 1), ContractViolation);
}

TEST(BalancedHeights, AreOutsideWhereConvexAndSmallOverSaddles) {
  const Torus torus = shaken_torus(40, 80);
  const double far = farthest(torus);
  const std::vector<double> heights = balanced_heights(torus.mesh, torus.normals, far);
  for (Index v = 0; v < heights.size(); ++v) {
    const double out = std::hypot(torus.mesh.positions[v].x, torus.mesh.positions[v].y);
    EXPECT_TRUE(out < 1.1 || heights[v] > 0) << v;
    EXPECT_LE(std::abs(heights[v]), 0.5 * far) << v;
  }
  for (const double h : balanced_heights(torus.mesh, torus.normals, 1e-4)) {
    EXPECT_LE(std::abs(h), 1e-4);
  }
}

TEST(Deviation, OfALiftedTriangleIsOnBothSides) {
  const DeviationRange bowl{0.0, 4.0}, saddle{-1.0, 1.0};
  EXPECT_EQ(distance_from(bowl, 0.0), 4);
  EXPECT_EQ(distance_from(bowl, 1.0), 2);
  EXPECT_EQ(distance_from(bowl, 0.5), 3);
  EXPECT_EQ(distance_from(saddle, 1.0), 1);
}

}  // namespace
}  // namespace cs2mesh
