// Unions of parts; compiled where there is CGAL.
#include "polygonize/unite.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libfield/base/random.h"
#include "polygonize/check.h"
#include "polygonize/lattice_mesher.h"
#include "tests/unit/polygonize/analytic_surfaces.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace test;
using std::numbers::pi;

MeshPart ball(const std::string& name, const Vec3d& center, double radius = 1.0, int levels = 4) {
  return {name, bare_sphere(center, radius, levels)};
}

/// Axis-parallel, two triangles a face.
MeshPart box(const std::string& name, const Vec3d& low, const Vec3d& high) {
  MeshPart part{name, {}};
  const Aabb around{low, high};
  for (int corner = 0; corner < 8; ++corner) part.mesh.positions.push_back(around.corner(corner));
  part.mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                         {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return part;
}

Result<Model> united(std::vector<MeshPart> parts, double tolerance = 0.01) {
  UniteOptions options;
  options.tolerance = tolerance;
  return unite({std::move(parts)}, options);
}

/// What every union promises; the report is of its only part.
MeshReport sound(const Result<Model>& result) {
  EXPECT_TRUE(result) << to_string(result.diagnostics().front());
  if (!result) return {};
  EXPECT_EQ(result->parts.size(), 1U);
  const MeshPart& part = result->parts.front();
  EXPECT_EQ(part.source_of.size(), part.mesh.triangles.size());
  EXPECT_TRUE(std::is_sorted(part.source_of.begin(), part.source_of.end()));
  EXPECT_TRUE(check(rounded_to_float(part.mesh)).ok());
  MeshReport report = check(part.mesh);
  EXPECT_TRUE(report.ok());
  return report;
}

double lens(double distance) {  // of two unit balls
  return pi * (4 + distance) * (2 - distance) * (2 - distance) / 12;
}

TEST(Unite, TwoBalls) {
  for (const double distance : {0.5, 1.0, 1.7}) {
    const auto result = united({ball("a", {}, 1, 5), ball("b", {distance, 0.01, 0.02}, 1, 5)});
    const MeshReport report = sound(result);
    EXPECT_EQ(report.components, 1U);
    EXPECT_EQ(report.genus, 0);
    EXPECT_NEAR(report.volume, 8 * pi / 3 - lens(distance), 0.02);
    EXPECT_EQ(result->parts[0].name, "a + b");
    EXPECT_EQ(result->parts[0].sources, (std::vector<std::string>{"a", "b"}));
  }
}

TEST(Unite, TrianglesKeepTheirSources) {
  const auto result = united({ball("a", {}), ball("b", {1, 0, 0})});
  sound(result);
  const MeshPart& part = result->parts[0];
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
    Vec3d middle{};
    for (const auto v : part.mesh.triangles[t]) middle += part.mesh.positions[v] / 3.0;
    const double to_own = norm(middle - Vec3d{part.source_of[t] == 0 ? 0.0 : 1.0, 0, 0});
    EXPECT_NEAR(to_own, 1, 0.01);
    // Not inside of the other.
    EXPECT_GT(norm(middle - Vec3d{part.source_of[t] == 0 ? 1.0 : 0.0, 0, 0}), 0.985);
  }
}

TEST(Unite, MirrorImagesAndSharedLattices) {
  // Vertices and edges of the one lie exactly on the other.
  sound(united({ball("a", {-0.5, 0, 0}), ball("b", {0.5, 0, 0})}));
  sound(united({ball("a", {0, 0, 0}), ball("b", {0.25, 0.25, 0.25})}));
  sound(united({ball("a", {0, 0, 0}, 1), ball("b", {0, 0, 0.5}, 0.5)}));
}

TEST(Unite, ABallInABallDisappears) {
  const MeshPart outer = ball("outer", {}, 2);
  const auto result = united({ball("inner", {0.1, 0, 0}, 0.5), outer});
  ASSERT_TRUE(result);
  ASSERT_EQ(result->parts.size(), 1U);
  EXPECT_EQ(result->parts[0].name, "outer");
  EXPECT_EQ(result->parts[0].mesh.positions, outer.mesh.positions);
  ASSERT_EQ(result.diagnostics().size(), 1U);
  EXPECT_EQ(result.diagnostics()[0].severity, Severity::note);
}

TEST(Unite, WhatIsInAHollowStays) {
  MeshPart shell = ball("shell", {}, 2);
  MeshPart inside = ball("hollow", {}, 1.5);
  for (auto& t : inside.mesh.triangles) {
    std::swap(t[0], t[1]);
    for (auto& v : t) v += static_cast<TriangleMesh::Index>(shell.mesh.positions.size());
    shell.mesh.triangles.push_back(t);
  }
  shell.mesh.positions.insert(shell.mesh.positions.end(), inside.mesh.positions.begin(),
                              inside.mesh.positions.end());
  const auto apart = united({shell, ball("kernel", {}, 1)});
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->parts.size(), 2U);
  // A ball that fills the hollow and ends within the shell.
  const auto filled = united({shell, ball("kernel", {}, 1.75)});
  ASSERT_TRUE(filled);
  ASSERT_EQ(filled->parts.size(), 1U);
  EXPECT_EQ(check(filled->parts[0].mesh).components, 1U);
  EXPECT_NEAR(volume(filled->parts[0].mesh), 4 * pi / 3 * 8, 0.3);
  // One that crosses the hollow's wall.
  const MeshReport crossing = sound(united({shell, ball("kernel", {0.5, 0, 0}, 1.2)}));
  EXPECT_EQ(crossing.components, 2U);
  EXPECT_EQ(crossing.voids, 1U);
}

TEST(Unite, PartsApartStayAsTheyAre) {
  const MeshPart a = ball("a", {}), b = ball("b", {1.9, 1.9, 0});  // boxes overlap
  const auto result = united({a, b});
  ASSERT_TRUE(result);
  ASSERT_EQ(result->parts.size(), 2U);
  EXPECT_EQ(result->parts[0].mesh.positions, a.mesh.positions);
  EXPECT_EQ(result->parts[1].mesh.triangles, b.mesh.triangles);
  EXPECT_TRUE(result->parts[0].sources.empty());
}

TEST(Unite, ThreeInARow) {
  const auto result = united(
      {ball("a", {}), ball("c", {3, 0.1, 0}), ball("b", {1.5, 0, 0.1}), ball("d", {9, 9, 9})});
  ASSERT_TRUE(result);
  ASSERT_EQ(result->parts.size(), 2U);
  EXPECT_EQ(result->parts[0].name, "a + 2 more");
  const MeshReport report = check(result->parts[0].mesh);
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(report.genus, 0);
}

TEST(Unite, ATorusThroughABall) {
  using namespace analytic;
  auto ring = mesh_lattice(Surface<Torus>{}, {.cell = 0.1});
  const MeshReport bead = sound(united({{"ring", *ring}, ball("bead", {1, 0.01, 0.02}, 0.5)}));
  EXPECT_EQ(bead.genus, 1);
  // A ball that fills the hole, and one that nearly does.
  const MeshReport filled = sound(united({{"ring", *ring}, ball("bead", {0, 0, 0}, 0.9)}));
  EXPECT_EQ(filled.genus, 0);
}

TEST(Unite, BoxesFaceToFace) {
  const MeshReport stacked =
      sound(united({box("below", {0, 0, 0}, {1, 1, 1}), box("above", {0, 0, 1}, {1, 1, 2})}));
  EXPECT_NEAR(stacked.volume, 2, 0.01);
  EXPECT_EQ(stacked.components, 1U);
  const MeshReport smaller = sound(
      united({box("below", {0, 0, 0}, {1, 1, 1}), box("above", {0.25, 0.25, 1}, {0.5, 1, 2})}));
  EXPECT_NEAR(smaller.volume, 1 + 0.25 * 0.75, 0.01);
  // Off by rounding, so that the faces cross over and over.
  MeshPart tilted = box("above", {0.2, 0.2, 1}, {0.7, 0.7, 2});
  for (Vec3d& p : tilted.mesh.positions) p.z += 1e-16 * (p.x - 0.4);
  EXPECT_NEAR(sound(united({box("below", {0, 0, 0}, {1, 1, 1}), tilted})).volume, 1.25, 0.01);
}

TEST(Unite, BoxesThatTouchAtAnEdgeOrAVertexAreMadeToOverlap) {
  for (const Vec3d& at : {Vec3d{1, 1, 0}, Vec3d{1, 1, 1}}) {
    const MeshReport report =
        sound(united({box("a", {0, 0, 0}, {1, 1, 1}), box("b", at, at + Vec3d{1, 1, 1})}));
    EXPECT_EQ(report.components, 1U);
    EXPECT_EQ(report.genus, 0);
    EXPECT_NEAR(report.volume, 2, 0.01);
  }
}

TEST(Unite, APartTwice) {
  const MeshReport twice = sound(united({ball("a", {}), ball("b", {})}));
  EXPECT_EQ(twice.components, 1U);
  EXPECT_NEAR(twice.volume, volume(ball("a", {}).mesh), 0.01);
}

TEST(Unite, ManyBallsAnywhereAreSoundAndTheSameEachTime) {
  Random random(5);
  for (int round = 0; round < 30; ++round) {
    std::vector<MeshPart> parts;
    for (int i = 0; i < 4; ++i) {
      const Vec3d center{random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6),
                         random.uniform(-0.6, 0.6)};
      parts.push_back(ball("b" + std::to_string(i), center, random.uniform(0.7, 1.2), 3));
    }
    const auto result = united(parts, 0.02);
    const MeshReport report = sound(result);
    EXPECT_EQ(report.components, 1U);
    const auto again = united(parts, 0.02);
    EXPECT_EQ(again->parts[0].mesh.positions, result->parts[0].mesh.positions);
    EXPECT_EQ(again->parts[0].mesh.triangles, result->parts[0].mesh.triangles);
  }
}

}  // namespace
}  // namespace cs2mesh
