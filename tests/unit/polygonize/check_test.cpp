#include "polygonize/check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "polygonize/lattice_mesher.h"
#include "polygonize/self_intersection.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

TriangleMesh tetrahedron(const Vec3d& at = {}, double size = 1.0) {
  TriangleMesh mesh;
  mesh.positions = {at, at + Vec3d{size, 0, 0}, at + Vec3d{0, size, 0}, at + Vec3d{0, 0, size}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<TriangleMesh::Index>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& t : other.triangles) {
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
}

void flip(TriangleMesh& mesh) {
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
}

bool can_check_self_intersections() {
  return find_self_intersections(tetrahedron(), 1).has_value();
}

TEST(Check, ATetrahedronIsFine) {
  const MeshReport report = check(tetrahedron());
  EXPECT_TRUE(report.ok());
  EXPECT_TRUE(report.closed && report.manifold_edges && report.manifold_vertices);
  EXPECT_TRUE(report.oriented && report.outward);
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.genus, 0);
  EXPECT_NEAR(report.volume, 1.0 / 6, 1e-15);
  EXPECT_NEAR(report.area, 1.5 + std::sqrt(3.0) / 2, 1e-15);
}

TEST(Check, GenusOfATorus) {
  const auto mesh = mesh_lattice(Surface<Torus>{}, {.cell = 0.1});
  const MeshReport report = check(*mesh);
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.genus, 1);
}

TEST(Check, OpenEdges) {
  TriangleMesh mesh = tetrahedron();
  mesh.triangles.pop_back();
  const MeshReport report = check(mesh);
  EXPECT_FALSE(report.ok());
  EXPECT_FALSE(report.closed);
  EXPECT_TRUE(report.manifold_vertices);
  EXPECT_EQ(report.count(DefectKind::open_edge), 3U);
  EXPECT_EQ(report.defects.front().where, (Vec3d{0.5, 0.5, 0}));
}

TEST(Check, AFlippedTriangle) {
  TriangleMesh mesh = tetrahedron();
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  const MeshReport report = check(mesh);
  EXPECT_EQ(report.count(DefectKind::inconsistent_orientation), 3U);
  EXPECT_TRUE(report.closed && report.manifold_vertices);
  EXPECT_FALSE(report.oriented || report.outward);
}

TEST(Check, NonmanifoldEdgesAndVertices) {
  TriangleMesh fin = tetrahedron();
  fin.positions.push_back({-1, -1, 0.5});
  fin.triangles.push_back({0, 3, 4});
  const MeshReport report = check(fin);
  EXPECT_EQ(report.count(DefectKind::nonmanifold_edge), 1U);
  EXPECT_EQ(report.count(DefectKind::open_edge), 2U);

  TriangleMesh bow_tie = tetrahedron();
  append(bow_tie, tetrahedron({-1, -1, -1}, 0.3));
  for (auto& t : bow_tie.triangles) {
    for (auto& v : t) v = v == 4 ? 0 : v;
  }
  bow_tie.positions[4] = {9, 9, 9};
  const MeshReport two = check(bow_tie);
  EXPECT_EQ(two.count(DefectKind::nonmanifold_vertex), 1U);
  EXPECT_EQ(two.components, 2U);
  EXPECT_EQ(two.genus, 0);
  EXPECT_TRUE(two.closed && two.manifold_edges);
}

TEST(Check, DuplicatesAndDegenerates) {
  TriangleMesh mesh = tetrahedron();
  mesh.positions.push_back({-0.0, 1, 0.0});
  EXPECT_EQ(check(mesh).count(DefectKind::duplicate_vertex), 1U);
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_EQ(check(mesh).count(DefectKind::degenerate_triangle), 1U);
}

TEST(Check, BrokenIndicesAndCoordinatesAreDefectsNotCrashes) {
  TriangleMesh mesh = tetrahedron();
  mesh.triangles.push_back({0, 1, 4});
  mesh.triangles.push_back({0xffffffffU, 1, 2});
  MeshReport report = check(mesh);
  EXPECT_EQ(report.count(DefectKind::index_out_of_range), 2U);
  EXPECT_FALSE(report.closed);
  EXPECT_FALSE(report.self_intersections.has_value());
  mesh = tetrahedron();
  mesh.positions[2].y = std::numeric_limits<double>::quiet_NaN();
  report = check(mesh);
  EXPECT_EQ(report.count(DefectKind::not_finite), 1U);
  EXPECT_FALSE(report.ok());
  EXPECT_TRUE(check(TriangleMesh{}).ok());
}

TEST(Check, RandomTriangleSoupIsSurvived) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    TriangleMesh mesh;
    for (int i = 0; i < 12; ++i) mesh.positions.push_back(random.direction());
    for (int i = 0; i < 60; ++i) {
      const auto any = [&] { return static_cast<TriangleMesh::Index>(random.uniform(0, 12.2)); };
      mesh.triangles.push_back({any(), any(), any()});
    }
    EXPECT_FALSE(check(mesh).ok());
  }
}

TEST(Check, VoidsAreLegalInwardSolidsAreNot) {
  TriangleMesh cavity = tetrahedron({0.1, 0.1, 0.1}, 0.2);
  flip(cavity);
  TriangleMesh mesh = tetrahedron();
  append(mesh, cavity);
  MeshReport report = check(mesh);
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.voids, 1U);
  EXPECT_EQ(report.components, 2U);
  EXPECT_NEAR(report.volume, (1 - 0.008) / 6, 1e-15);
  flip(mesh);
  report = check(mesh);
  EXPECT_FALSE(report.outward);
  EXPECT_EQ(report.count(DefectKind::inward_component), 1U);
}

TEST(Check, DefectsAreCappedButCounted) {
  auto mesh = *mesh_lattice(Surface<Sphere>{}, {.cell = 0.1});
  mesh.triangles.resize(mesh.triangles.size() / 2);
  const MeshReport report = check(mesh, {.max_defects = 5});
  const auto listed = std::count_if(report.defects.begin(), report.defects.end(),
                                    [](const auto& d) { return d.kind == DefectKind::open_edge; });
  EXPECT_EQ(listed, 5);
  EXPECT_GT(report.count(DefectKind::open_edge), 5U);
}

TEST(Check, EachPartByItself) {
  Model model;
  model.parts = {{"a", tetrahedron()}, {"b", tetrahedron({0.1, 0.1, 0.1})}};
  const auto reports = check(model);
  ASSERT_EQ(reports.size(), 2U);
  EXPECT_EQ(reports[1].name, "b");
  EXPECT_TRUE(reports[0].report.ok() && reports[1].report.ok());
}

TEST(IsDegenerate, ExactWhereRoundingLies) {
  // On the line x = y = z, at coordinates whose differences and products round.
  const double tenth = 0.1;
  const Vec3d a{tenth, tenth, tenth};
  const Vec3d b{1e10 / 3, 1e10 / 3, 1e10 / 3};
  const Vec3d c{-7.7e-9, -7.7e-9, -7.7e-9};
  EXPECT_TRUE(is_degenerate(a, b, c));
  EXPECT_FALSE(is_degenerate(a, b, {c.x, c.y, next_up(c.z)}));
  EXPECT_FALSE(is_degenerate({0, 0, 0}, {1, 1, 1}, {2, 2, next_up(2.0)}));
  EXPECT_TRUE(is_degenerate(a, a, b));
}

TEST(SelfIntersections, KindsOfContact) {
  if (!can_check_self_intersections()) return;
  const auto count = [](std::vector<Vec3d> p, std::vector<std::array<TriangleMesh::Index, 3>> t) {
    TriangleMesh mesh;
    mesh.positions = std::move(p);
    mesh.triangles = std::move(t);
    return find_self_intersections(mesh, 10)->count;
  };
  const Vec3d o{0, 0, 0};
  const Vec3d x{1, 0, 0};
  const Vec3d y{0, 1, 0};
  // No vertex in common: through the middle, apart, touching with a tip.
  const Vec3d up{0.2, 0.2, 1};
  const Vec3d up2{0.3, 0.2, 1};
  EXPECT_EQ(count({o, x, y, up, up2, {0.2, 0.2, -1}}, {{0, 1, 2}, {3, 4, 5}}), 1U);
  EXPECT_EQ(count({o, x, y, up, up2, {0.2, 0.2, 0.1}}, {{0, 1, 2}, {3, 4, 5}}), 0U);
  EXPECT_EQ(count({o, x, y, up, up2, {0.25, 0.25, 0}}, {{0, 1, 2}, {3, 4, 5}}), 1U);
  // One vertex in common.
  EXPECT_EQ(count({o, x, y, {1, 1, 1}, {1, 1, -1}}, {{0, 1, 2}, {0, 3, 4}}), 1U);
  EXPECT_EQ(count({o, x, y, {-1, -1, 1}, {-1, -1, -1}}, {{0, 1, 2}, {0, 3, 4}}), 0U);
  // An edge in common: unfolded, folded flat, upright; and all three vertices.
  EXPECT_EQ(count({o, x, y, {1, 1, 0}}, {{0, 1, 2}, {2, 1, 3}}), 0U);
  EXPECT_EQ(count({o, x, y, {0.2, 0.2, 0}}, {{0, 1, 2}, {2, 1, 3}}), 1U);
  EXPECT_EQ(count({o, x, y, {0.2, 0.2, 1}}, {{0, 1, 2}, {2, 1, 3}}), 0U);
  EXPECT_EQ(count({o, x, y}, {{0, 1, 2}, {2, 1, 0}}), 1U);
}

TEST(SelfIntersections, TwoSpheresThatCross) {
  if (!can_check_self_intersections()) return;
  auto mesh = *mesh_lattice(Surface<Sphere>{}, {.cell = 0.2});
  append(mesh, *mesh_lattice(Surface<Sphere>{Sphere{{1, 0.1, 0.2}, 1}}, {.cell = 0.2}));
  const MeshReport report = check(mesh);
  EXPECT_GT(*report.self_intersections, 10U);
  EXPECT_FALSE(report.ok());
  for (const Defect& d : report.defects) {
    ASSERT_EQ(d.triangles.size(), 2U);
    EXPECT_NEAR(d.where.x, 0.5, 0.3);
  }
}

}  // namespace
}  // namespace cs2mesh
