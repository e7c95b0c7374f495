// Prisms that are said to be apart or straight are, point by point.
#include "polygonize/offset_shell.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libfield/base/random.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

/// Along the normals of a sphere around the origin.
OffsetShell radial_shell(const TriangleMesh& mesh, double outer, double inner) {
  OffsetShell shell;
  for (const Vec3d& p : mesh.positions) shell.direction.push_back(normalized(p));
  shell.outer.assign(mesh.positions.size(), outer);
  shell.inner.assign(mesh.positions.size(), inner);
  return shell;
}

bool is_straight(const TriangleMesh& mesh, const OffsetShell& shell, std::size_t triangle) {
  const auto sides = leaves_directions_on_one_side(mesh, shell, triangle);
  return std::all_of(sides.begin(), sides.end(), [](bool side) { return side; });
}

std::array<Vec3d, 6> random_prism(Random& random, const Vec3d& center) {
  std::array<Vec3d, 6> corners;
  for (Vec3d& p : corners) p = center + random.uniform() * random.direction();
  return corners;
}

Vec3d random_point_in(Random& random, const std::array<Vec3d, 6>& corners) {
  Vec3d sum{};
  double weights = 0.0;
  for (const Vec3d& p : corners) {
    const double weight = -std::log(1 - random.uniform());
    sum += weight * p;
    weights += weight;
  }
  return sum / weights;
}

TEST(OffsetShell, PrismsThatShareAPointAreNotApart) {
  Random random(4, 1);
  for (int round = 0; round < 2000; ++round) {
    const auto a = random_prism(random, {});
    auto b = random_prism(random, 2 * random.uniform() * random.direction());
    const Vec3d shift = random_point_in(random, a) - random_point_in(random, b);
    for (Vec3d& p : b) p += shift;
    EXPECT_FALSE(are_apart(a, b));
    EXPECT_FALSE(are_apart(b, a));
  }
}

TEST(OffsetShell, PrismsWithAPlaneBetweenThemAreApart) {
  const std::array<Vec3d, 6> unit{Vec3d{0, 0, 1}, {1, 0, 1}, {0, 1, 1},
                                  {0, 0, 0},      {1, 0, 0}, {0, 1, 0}};
  for (const Vec3d& way : {Vec3d{0, 0, 1.001}, Vec3d{0.6, 0.6, 0}, Vec3d{-1.001, 0, 0.5}}) {
    auto moved = unit;
    for (Vec3d& p : moved) p += way;
    EXPECT_TRUE(are_apart(unit, moved));
    EXPECT_TRUE(are_apart(moved, unit));
  }
}

/// The normals of all layers are mixtures of those six, with weights that are not negative.
TEST(OffsetShell, LayersLieBetweenTheirNormals) {
  Random random(6, 1);
  const TriangleMesh mesh = test::sphere_mesh(1);
  OffsetShell shell = radial_shell(mesh, 0.3, 0.4);
  for (Vec3d& d : shell.direction) d = normalized(d + 0.3 * random.direction());
  for (double& length : shell.outer) length = random.uniform(0.05, 0.4);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto normals = layer_normals(mesh, shell, t);
    for (const double s : {0.0, 0.3, 0.7, 1.0}) {
      TriangleMesh layer = mesh;
      for (TriangleMesh::Index v = 0; v < mesh.positions.size(); ++v) {
        layer.positions[v] += s * (shell.outer_place(mesh, v) - mesh.positions[v]);
      }
      const auto& [a, b, c] = mesh.triangles[t];
      const Vec3d normal =
          cross(layer.positions[b] - layer.positions[a], layer.positions[c] - layer.positions[a]);
      const Vec3d mixed =
          (1 - s) * (1 - s) * normals[0] + 2 * s * (1 - s) * normals[1] + s * s * normals[2];
      EXPECT_LT(norm(normal - mixed), 1e-13);
    }
  }
}

TEST(OffsetShell, AThinShellIsStraightAndMeetsNothing) {
  const TriangleMesh mesh = test::sphere_mesh(3);
  const OffsetShell shell = radial_shell(mesh, 0.1, 0.1);
  const std::vector<char> meets = prisms_that_meet(mesh, shell);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    EXPECT_TRUE(is_straight(mesh, shell, t));
    EXPECT_EQ(meets[t], 0) << t;
  }
}

TEST(OffsetShell, BeyondTheCentrePrismsAreTurnedInsideOut) {
  const TriangleMesh mesh = test::sphere_mesh(2);
  const OffsetShell shell = radial_shell(mesh, 0.1, 1.2);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    EXPECT_FALSE(is_straight(mesh, shell, t));
  }
}

/// Two balls with a gap: shells as thick as half of it meet, and only there.
TEST(OffsetShell, ShellsMeetAcrossAGap) {
  constexpr double kGap = 0.1;
  TriangleMesh mesh = test::sphere_mesh(3);
  OffsetShell shell = radial_shell(mesh, 0.6 * kGap, 0.02);
  const auto count = static_cast<TriangleMesh::Index>(mesh.positions.size());
  const std::size_t triangles = mesh.triangles.size();
  for (TriangleMesh::Index v = 0; v < count; ++v) {
    mesh.positions.push_back(mesh.positions[v] + Vec3d{2 + kGap, 0, 0});
    shell.direction.push_back(shell.direction[v]);
    shell.outer.push_back(shell.outer[v]);
    shell.inner.push_back(shell.inner[v]);
  }
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    mesh.triangles.push_back({a + count, b + count, c + count});
  }
  const std::vector<char> meets = prisms_that_meet(mesh, shell);
  EXPECT_GT(std::count(meets.begin(), meets.end(), 1), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (meets[t] == 0) continue;
    const Vec3d& p = mesh.positions[mesh.triangles[t][0]];
    EXPECT_LT(norm(p - Vec3d{1 + 0.5 * kGap, 0, 0}), 0.6);
  }
  std::fill(shell.outer.begin(), shell.outer.end(), 0.3 * kGap);
  const std::vector<char> thin = prisms_that_meet(mesh, shell);
  EXPECT_EQ(std::count(thin.begin(), thin.end(), 1), 0);
}

}  // namespace
}  // namespace cs2mesh
