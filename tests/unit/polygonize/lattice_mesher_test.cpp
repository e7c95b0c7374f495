#include "polygonize/lattice_mesher.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numbers>

#include "polygonize/check.h"
#include "polygonize/lattice_nodes.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;
constexpr double kPi = std::numbers::pi;

/// Exactly 0 in a slab: inside, with no gradient to go by.
struct Plateau {
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return smaller(smaller(T(0.0), T(0.25) - square(p.x)), ball(p, {}, 1.0));
  }
  Aabb bounds() const { return cube(1); }
};

/// A wall along a diagonal of the lattice, less thick than a cell, or a slit, in a ball.
struct Diagonal {
  bool slit = false;
  template <class T>
  T operator()(const Vec3<T>& p) const {
    const T wall = T(0.0004) - square(p.x + p.y);
    return smaller(slit ? T(-1.0) * wall : wall, ball(p, {}, 1.0));
  }
  Aabb bounds() const { return cube(1); }
};

/// Two rods along a diagonal of the lattice's faces, and a thin one between that touches neither.
struct ThreeRods {
  template <class T>
  static T rod(const Vec3<T>& p, double at, double radius) {
    return T(radius * radius) - square(p.x - T(at)) - square(p.y - T(at));
  }
  template <class T>
  T operator()(const Vec3<T>& p) const {
    const T two = larger(rod(p, 0.0, 0.03), rod(p, 0.1, 0.03));
    return smaller(larger(two, rod(p, 0.05, 0.01)), ball(p, {}, 1.0));
  }
  Aabb bounds() const { return cube(1); }
};

double smallest_angle(const TriangleMesh& mesh) {
  double smallest = 180;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d u = mesh.positions[t[(i + 1) % 3]] - mesh.positions[t[i]];
      const Vec3d v = mesh.positions[t[(i + 2) % 3]] - mesh.positions[t[i]];
      smallest = std::min(smallest, std::atan2(norm(cross(u, v)), dot(u, v)) * 180 / kPi);
    }
  }
  return smallest;
}

/// Meshes and checks every promise; vertices are on the surface, triangles face away from F > 0.
template <class S>
TriangleMesh mesh_and_check(const S& surface, double cell, const Vec3d& origin = {}) {
  LatticeStatistics statistics;
  const auto result = mesh_lattice(surface, {.cell = cell, .origin = origin}, &statistics);
  EXPECT_TRUE(result);
  const TriangleMesh& mesh = *result;
  const MeshReport report = check(mesh);
  EXPECT_TRUE(report.ok());
  for (const Defect& d : report.defects) {
    ADD_FAILURE() << name(d.kind) << " at " << d.where.x << ' ' << d.where.y << ' ' << d.where.z;
    break;
  }
  EXPECT_EQ(statistics.triangles, mesh.triangles.size());
  const double scale = surface.bounds().diagonal();
  if (statistics.clamped_roots == 0) {
    for (const Vec3d& p : mesh.positions) {
      const Jet jet = surface.jet(p);
      EXPECT_LE(std::abs(jet.value), 1e-12 * scale * norm(jet.gradient));
    }
  }
  return mesh;
}

TEST(LatticeMesher, Sphere) {
  double last_error = 0;
  for (const double cell : {0.2, 0.1, 0.05}) {
    const TriangleMesh mesh = mesh_and_check(Surface<Sphere>{}, cell);
    const double error = std::abs(volume(mesh) - 4 * kPi / 3);
    if (last_error > 0) {
      EXPECT_NEAR(last_error / error, 4.0, 1.0) << "the order is 2";
    }
    last_error = error;
    EXPECT_GT(smallest_angle(mesh), 8.0);
  }
  EXPECT_LT(last_error, 6e-3);
}

TEST(LatticeMesher, TorusHasGenusOne) {
  const TriangleMesh mesh = mesh_and_check(Surface<Torus>{}, 0.05);
  EXPECT_EQ(check(mesh).genus, 1);
  EXPECT_NEAR(volume(mesh), 2 * kPi * kPi * 0.09, 0.02);
}

TEST(LatticeMesher, WallsAndSlitsAlongDiagonalsHaveNoHoles) {
  // Every other edge of every face across z is in the wall; the middle of the face tells that they
  // are of one.
  for (const Vec3d& origin : {Vec3d{}, Vec3d{0.003, -0.002, 0.01}}) {
    const MeshReport wall = check(mesh_and_check(Surface<Diagonal>{}, 0.05, origin));
    EXPECT_EQ(wall.components, 1U);
    EXPECT_EQ(wall.genus, 0);
    const MeshReport slit = check(mesh_and_check(Surface<Diagonal>{Diagonal{true}}, 0.05, origin));
    EXPECT_EQ(slit.components, 2U);
    EXPECT_EQ(slit.genus, 0);
  }
}

TEST(LatticeMesher, WhatLiesBetweenRodsDoesNotJoinThem) {
  const MeshReport rods = check(mesh_and_check(Surface<ThreeRods>{}, 0.1));
  EXPECT_EQ(rods.components, 2U);
  EXPECT_EQ(rods.genus, 0);
}

TEST(LatticeMesher, OtherShapes) {
  mesh_and_check(Surface<Ellipsoid>{}, 0.07);
  mesh_and_check(Surface<ClippedSaddle>{}, 0.08);
  mesh_and_check(Surface<GyroidInBall>{}, 0.06);
  mesh_and_check(Surface<TouchingSpheres>{}, 0.05);
  mesh_and_check(Surface<TouchingSpheres>{}, 0.07, {0.01, 0.02, 0.03});
  mesh_and_check(Surface<ThinPlate>{}, 0.05);
  mesh_and_check(Surface<ThinPlate>{ThinPlate{0.05, 1.0}}, 0.04);
}

TEST(LatticeMesher, SurfaceThroughNodes) {
  // Nodes on the sphere: the six poles, and Pythagorean ones such as (0.6, 0.8, 0).
  for (const double cell : {0.25, 0.125, 0.1, 0.2}) {
    const TriangleMesh mesh = mesh_and_check(Surface<Sphere>{}, cell);
    EXPECT_GT(smallest_angle(mesh), 5.0);
  }
  // Whole sheets of nodes on the surface: the faces of a plate.
  mesh_and_check(Surface<ThinPlate>{ThinPlate{0.125, 1.0}}, 0.0625);
  // And nearly so.
  for (const double off : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15, -1e-15, -1e-12, -1e-6}) {
    mesh_and_check(Surface<Sphere>{Sphere{{off, 0, 0}, 0.5}}, 0.125);
  }
}

TEST(LatticeMesher, ASetOfZeros) {
  const auto mesh = mesh_lattice(Surface<Plateau>{}, {.cell = 0.125});
  ASSERT_TRUE(mesh);
  const MeshReport report = check(*mesh);
  EXPECT_TRUE(report.closed && report.manifold_edges && report.manifold_vertices);
  EXPECT_TRUE(report.oriented && report.outward);
  EXPECT_GT(report.triangles, 100U);
}

TEST(LatticeMesher, NothingInside) {
  const auto mesh = mesh_lattice(Surface<Sphere>{Sphere{{0.5, 0.5, 0.5}, 1e-3}}, {.cell = 1.0});
  ASSERT_TRUE(mesh);
  EXPECT_TRUE(mesh->empty());
}

TEST(LatticeMesher, SameBytesForAnyNumberOfThreads) {
  const LatticeNoise noise(20, 0.5, 0.0, 5);
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return *mesh_lattice(noise, {.cell = 0.7});
  };
  const TriangleMesh one = with_threads(1);
  const TriangleMesh four = with_threads(4);
  EXPECT_EQ(one.positions, four.positions);
  EXPECT_EQ(one.triangles, four.triangles);
}

TEST(LatticeMesher, FarFromTheOrigin) {
  const Vec3d far{1e6, -2e6, 3e6};
  const TriangleMesh mesh = *mesh_lattice(Surface<Sphere>{Sphere{far, 1}}, {.cell = 0.1});
  EXPECT_TRUE(check(mesh).ok());
  for (const Vec3d& p : mesh.positions) EXPECT_NEAR(norm(p - far), 1.0, 1e-3);
}

TEST(LatticeMesher, LimitsAndCancellation) {
  const Surface<Sphere> sphere;
  const auto limited = mesh_lattice(sphere, {.cell = 0.05, .max_triangles = 100});
  ASSERT_FALSE(limited);
  EXPECT_EQ(limited.diagnostics().front().failure, Failure::limit);
  struct Cancelled final : Progress {
    bool cancelled() const override { return true; }
  } progress;
  const auto cancelled = mesh_lattice(sphere, {.cell = 0.05, .progress = &progress});
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.diagnostics().front().failure, Failure::interrupted);
}

TEST(LatticeNodes, KnownNodesAreClearOfTheSurface) {
  const Surface<Sphere> sphere;
  const auto band = NarrowBand::build(sphere, {.cell = 0.1});
  LatticeNodes nodes(*band);
  ASSERT_TRUE(nodes.settle(nullptr));
  EXPECT_GT(nodes.counts().moved, 10U);
  EXPECT_EQ(nodes.counts().stuck, 0U);
  for (std::size_t b = 0; b < band->active_count(); ++b) {
    const PaddedNodes inside = nodes.padded_inside(b);
    for (int offset = 0; offset < 512; ++offset) {
      const Int3 n = local_node(offset);
      const bool in = inside.contains(n.x, n.y, n.z);
      if (in == inside.contains(n.x + 1, n.y, n.z)) continue;
      const Jet& jet = nodes.jet(b, offset);
      EXPECT_EQ(jet.value >= 0, in);
      EXPECT_GE(clearance(jet), NodeMover::kNear * 0.1);
      EXPECT_EQ(jet, sphere.jet(nodes.position(b, offset)));
      EXPECT_LE(norm(nodes.position(b, offset) - band->node_position(b, offset)),
                NodeMover::kFarthest * 0.1 * (1 + 1e-12));
    }
  }
}

}  // namespace
}  // namespace cs2mesh
