#include "polygonize/polygon_mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "polygonize/check.h"
#include "polygonize/half_edges.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

/// The faces of a cube about the origin, `parts` quadrilaterals along each edge.
PolygonMesh cube_of_quadrilaterals(double half_side, int parts) {
  PolygonMesh mesh;
  std::map<std::array<int, 3>, PolygonMesh::Index> number;
  const auto vertex = [&](const std::array<int, 3>& place) {
    const auto [at, fresh] =
        number.try_emplace(place, static_cast<PolygonMesh::Index>(mesh.positions.size()));
    const auto coordinate = [&](std::size_t k) { return half_side * (2.0 * place[k] / parts - 1); };
    if (fresh) mesh.positions.push_back({coordinate(0), coordinate(1), coordinate(2)});
    return at->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int side : {0, parts}) {
      for (int i = 0; i < parts; ++i) {
        for (int j = 0; j < parts; ++j) {
          const auto corner = [&](int a, int b) {
            std::array<int, 3> place{};
            place[axis] = side;
            place[(axis + 1) % 3] = side == 0 ? j + b : i + a;
            place[(axis + 2) % 3] = side == 0 ? i + a : j + b;
            return vertex(place);
          };
          for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
            mesh.corners.push_back(corner(a, b));
          }
          mesh.ends.push_back(static_cast<PolygonMesh::Index>(mesh.corners.size()));
        }
      }
    }
  }
  return mesh;
}

TEST(PolygonMesh, SettlesOnASphere) {
  SettleCounts counts;
  const auto mesh =
      settle(Surface<Sphere>{}, cube_of_quadrilaterals(0.8, 6), {.reach = 1.0}, counts);
  ASSERT_TRUE(mesh);
  EXPECT_TRUE(check(*mesh).ok());
  EXPECT_EQ(mesh->triangles.size(), 2U * 6 * 36);
  EXPECT_GT(counts.jets, mesh->positions.size());
  EXPECT_EQ(counts.off_surface, 0.0);
  for (const Vec3d& p : mesh->positions) EXPECT_NEAR(norm(p), 1.0, 1e-4);
}

TEST(PolygonMesh, FixedVerticesStay) {
  PolygonMesh polygons = cube_of_quadrilaterals(0.8, 6);
  polygons.fixed.assign(polygons.positions.size(), 0);
  polygons.fixed[7] = 1;
  SettleCounts counts;
  const auto mesh = settle(Surface<Sphere>{}, polygons, {.reach = 1.0}, counts);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->positions[7], polygons.positions[7]);
  EXPECT_NEAR(counts.off_surface, std::abs(norm(polygons.positions[7]) - 1), 1e-3);
  EXPECT_NEAR(norm(mesh->positions[8]), 1.0, 1e-4);
}

TEST(PolygonMesh, DiagonalsFollowTheSurface) {
  // A roof over the first bisector of x and y: along the ridge the diagonal is on it.
  PolygonMesh polygons = cube_of_quadrilaterals(0.3, 1);
  polygons.fixed.assign(8, 1);
  const Surface<Sphere> sphere(Sphere{{}, 0.3 * std::sqrt(3.0)});
  for (Vec3d& p : polygons.positions) {
    if (p.x * p.y > 0) p = 1.2 * p;
  }
  SettleCounts counts;
  const auto mesh = settle(sphere, polygons, {.reach = 0.1}, counts);
  ASSERT_TRUE(mesh);
  // The top is convex where it is cut from far corner to far corner.
  for (const auto& t : mesh->triangles) {
    const auto far = [&](int k) { return norm(mesh->positions[t[k]]) > 0.55; };
    const bool top =
        mesh->positions[t[0]].z > 0 && mesh->positions[t[1]].z > 0 && mesh->positions[t[2]].z > 0;
    if (top) {
      EXPECT_EQ(far(0) + far(1) + far(2), 2);
    }
  }
}

TEST(PolygonMesh, WhatIsNotAClosedManifoldIsRefused) {
  SettleCounts counts;
  PolygonMesh open = cube_of_quadrilaterals(0.8, 3);
  open.ends.pop_back();
  open.corners.resize(open.ends.back());
  auto mesh = settle(Surface<Sphere>{}, open, {.reach = 1.0}, counts);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.diagnostics().front().failure, Failure::check_failed);

  // Two cubes that share a corner by index.
  PolygonMesh pinched = cube_of_quadrilaterals(0.3, 1);
  const PolygonMesh other = pinched;
  std::vector<PolygonMesh::Index> renamed;
  for (const Vec3d& p : other.positions) {
    const bool shared = p.x > 0 && p.y > 0 && p.z > 0;
    renamed.push_back(static_cast<PolygonMesh::Index>(pinched.positions.size()));
    if (!shared) pinched.positions.push_back(p + Vec3d{0.6, 0.6, 0.6});
    const bool meets = p.x < 0 && p.y < 0 && p.z < 0;
    if (meets) renamed.back() = PolygonMesh::Index{0};
    if (shared) pinched.positions.push_back(p + Vec3d{0.6, 0.6, 0.6});
  }
  for (PolygonMesh::Index i = 0; i < 8; ++i) {
    const Vec3d& p = other.positions[i];
    if (p.x < 0 && p.y < 0 && p.z < 0) {
      for (PolygonMesh::Index k = 0; k < 8; ++k) {
        const Vec3d& q = other.positions[k];
        if (q.x > 0 && q.y > 0 && q.z > 0) renamed[i] = k;
      }
    }
  }
  for (const auto v : other.corners) pinched.corners.push_back(renamed[v]);
  for (const auto end : other.ends) pinched.ends.push_back(24 + end);
  pinched.fixed.assign(pinched.positions.size(), 1);
  mesh = settle(Surface<Sphere>{}, pinched, {.reach = 1.0}, counts);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.diagnostics().front().failure, Failure::check_failed);
}

}  // namespace
}  // namespace cs2mesh
