// How a surface bends, by the normals at vertices.
#include "polygonize/shape_operator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libfield/base/check.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

/// A vertex on a cylinder about z, with six neighbours around it.
struct Fan {
  TriangleMesh mesh;
  std::vector<Vec3d> normals;
};
Fan fan_on_cylinder(double radius, double step) {
  Fan fan;
  const auto add = [&](double angle, double z) {
    const Vec3d n{std::cos(angle), std::sin(angle), 0};
    fan.mesh.positions.push_back(radius * n + Vec3d{0, 0, z});
    fan.normals.push_back(n);
  };
  add(0, 0);
  for (int i = 0; i < 6; ++i) {
    const double turn = i * std::numbers::pi / 3 + 0.2;
    add(step * std::cos(turn) / radius, step * std::sin(turn));
  }
  for (TriangleMesh::Index i = 0; i < 6; ++i) {
    fan.mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % 6});
  }
  return fan;
}

TEST(ShapeOperator, OfACylinderTurnsAroundItAndNotAlong) {
  const double radius = 0.5;
  const Fan fan = fan_on_cylinder(radius, 0.01);
  const Symmetric3 shape = shape_operators(fan.mesh, fan.normals)[0];
  EXPECT_NEAR(norm(shape * Vec3d{0, 1, 0} - Vec3d{0, 1 / radius, 0}), 0, 1e-3);
  EXPECT_NEAR(norm(shape * Vec3d{0, 0, 1}), 0, 1e-3);
  EXPECT_NEAR(norm(shape * Vec3d{1, 0, 0}), 0, 1e-12) << "zero along the normal";
}

TEST(ShapeOperator, IsZeroWithoutNeighboursInTwoDirections) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}};
  const std::vector<Vec3d> normals(3, Vec3d{0, 0, 1});
  for (const Symmetric3& shape : shape_operators(mesh, normals)) EXPECT_EQ(norm(shape), 0);
  EXPECT_THROW(shape_operators(mesh, std::span(normals).first(2)), ContractViolation);
}

TEST(BendMetric, RaisesTheLesserCurvature) {
  const Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const BendMetric saddle = bend_metric(8.0 * squared(x) + -1.0 * squared(y), z, 4.0);
  EXPECT_NEAR(dot(x, saddle.form * x), 8, 1e-12);
  EXPECT_NEAR(dot(y, saddle.form * y), 2, 1e-12);
  EXPECT_NEAR(dot(z, saddle.form * z), 8, 1e-12);
  EXPECT_NEAR(saddle.ratio, -1.0 / 8, 1e-12);
  EXPECT_NEAR(saddle.density, 4, 1e-12);
  EXPECT_EQ(bend_metric({}, z, 4.0).density, 0) << "flat";
}

/// Of a sphere 4 pi R^2 / (6 R e sqrt(3) / 4), whatever the mesh is made of.
TEST(TrianglesNeeded, AreThoseOfAHexagonalMeshOfASphere) {
  const double radius = 2.0, tolerance = 1e-3;
  const double optimum = 4 * std::numbers::pi * radius / (1.5 * std::sqrt(3.0) * tolerance);
  const double needed = triangles_needed(test::sphere_mesh(5, {1, 2, 3}, radius), tolerance);
  EXPECT_NEAR(needed, optimum, 0.03 * optimum);
  EXPECT_EQ(triangles_needed({}, tolerance), 0.0);
}

TEST(TrianglesNeeded, AreNoneOfAPlane) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}, {7, 7, 7}};
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
  EXPECT_EQ(triangles_needed(mesh, 0.1), 0.0);
}

}  // namespace
}  // namespace cs2mesh
