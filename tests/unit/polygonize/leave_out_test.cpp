#include "polygonize/leave_out.h"

#include <gtest/gtest.h>

#include <numbers>

#include "polygonize/check.h"
#include "polygonize/mesh_components.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using test::bare_sphere;

TriangleMesh hollow(const Vec3d& center, double radius) {
  TriangleMesh mesh = bare_sphere(center, radius);
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  return mesh;
}

/// A ball with a hollow, a ball in the hollow, and a small ball beside; somewhere far away.
MeshPart shell_and_more(const Vec3d& at = {}) {
  Model model;
  for (const TriangleMesh& mesh :
       {bare_sphere(at, 2), hollow(at, 1), bare_sphere(at + Vec3d{0.3, 0, 0}, 0.5),
        bare_sphere(at + Vec3d{4, 0, 0}, 0.25)}) {
    model.parts.push_back({"", mesh});
  }
  return {"all", joined(model)};
}

TEST(Components, SizesAndSigns) {
  const Vec3d far{1e6, -1e6, 1e6};
  const TriangleMesh mesh = shell_and_more(far).mesh;
  const std::vector<MeshComponent> found = components(mesh);
  ASSERT_EQ(found.size(), 4U);
  double total = 0, total_area = 0;
  for (const MeshComponent& component : found) {
    total += component.volume;
    total_area += component.area;
    EXPECT_EQ(component.triangles.size(), 128U);
  }
  EXPECT_NEAR(total, volume(mesh), 1e-6);
  EXPECT_NEAR(total_area, area(mesh), 1e-6);
  EXPECT_NEAR(found[1].box.diagonal(), 2 * std::numbers::sqrt3, 1e-6);
  EXPECT_TRUE(found[1].inwards);
  for (const std::size_t i : {0, 2, 3}) EXPECT_FALSE(found[i].inwards);
  // About a point in the inner ball the shell goes round once, its hollow once the other way.
  const Vec3d inside = far + Vec3d{0.3, 0.1, 0.05};
  EXPECT_NEAR(winding_number(mesh, found[0], inside), 1, 1e-9);
  EXPECT_NEAR(winding_number(mesh, found[1], inside), -1, 1e-9);
  EXPECT_NEAR(winding_number(mesh, found[3], inside), 0, 1e-9);
  EXPECT_NEAR(winding_number(mesh, inside), 1, 1e-9);
}

TEST(Components, WithoutVolumeThereIsNoSign) {
  // Two triangles back to back: a volume of rounding at most, whichever way round.
  TriangleMesh leaf;
  leaf.positions = {{0.1, 0.2, 0.3}, {1.7, 0.4, 0.1}, {0.2, 1.3, 0.9}};
  leaf.triangles = {{0, 1, 2}, {2, 1, 0}};
  EXPECT_FALSE(components(leaf)[0].inwards);
  leaf.triangles = {{2, 1, 0}, {0, 1, 2}};
  EXPECT_FALSE(components(leaf)[0].inwards);
  EXPECT_TRUE(components({}).empty());
}

TEST(LeaveOut, NothingUnlessAsked) {
  Model model{{shell_and_more()}};
  const TriangleMesh before = model.parts[0].mesh;
  EXPECT_TRUE(leave_out(model, {}).nothing());
  EXPECT_EQ(model.parts[0].mesh.positions, before.positions);
  EXPECT_EQ(model.parts[0].mesh.triangles, before.triangles);
}

TEST(LeaveOut, SmallComponentsGo) {
  Model model{{shell_and_more()}};
  // The diagonal of the box of a ball of radius r is 2 sqrt(3) r.
  const LeftOut left_out = leave_out(model, {.smallest = 0.51 * 2 * std::numbers::sqrt3});
  EXPECT_EQ(left_out.small.components, 2U);
  EXPECT_EQ(left_out.small.voids, 0U);
  EXPECT_EQ(left_out.enclosed.components, 0U);
  const double gone = area(bare_sphere({}, 0.5)) + area(bare_sphere({}, 0.25));
  EXPECT_NEAR(left_out.small.area, gone, 1e-12);
  const MeshReport report = check(model.parts[0].mesh);
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.components, 2U);
  EXPECT_EQ(report.voids, 1U);
  EXPECT_NEAR(report.area + gone, area(shell_and_more().mesh), 1e-12);
}

TEST(LeaveOut, WhatIsEnclosedGoes) {
  for (const Vec3d& at : {Vec3d{}, Vec3d{1e5, 1e5, -1e5}}) {
    Model model{{shell_and_more(at)}};
    const LeftOut left_out = leave_out(model, {.enclosed = true});
    EXPECT_EQ(left_out.enclosed.components, 2U);
    EXPECT_EQ(left_out.enclosed.voids, 1U);
    const MeshReport report = check(model.parts[0].mesh);
    EXPECT_TRUE(report.ok());
    EXPECT_EQ(report.components, 2U);
    EXPECT_EQ(report.voids, 0U);
    EXPECT_EQ(report.vertices, 2 * bare_sphere({}, 1).positions.size());
  }
}

TEST(LeaveOut, ABoxInABoxIsNotYetInside) {
  // Within the box of the large ball, at its corner, but outside of the ball.
  Model model;
  model.parts.push_back({"a", bare_sphere({}, 2)});
  model.parts.push_back({"b", bare_sphere({1.7, 1.7, 1.7}, 0.2)});
  EXPECT_TRUE(leave_out(model, {.enclosed = true, .across_parts = true}).nothing());
}

TEST(LeaveOut, PartsInsideOfOthersGoIfTheyMay) {
  Model model;
  model.parts.push_back({"inner", bare_sphere({}, 0.5)});
  model.parts.push_back({"shell", joined({{{"", bare_sphere({}, 2)}, {"", hollow({}, 1)}}})});
  Model by_part = model;
  LeftOut left_out = leave_out(by_part, {.enclosed = true});
  EXPECT_EQ(left_out.enclosed.components, 1U);
  EXPECT_FALSE(by_part.parts[0].mesh.empty());
  left_out = leave_out(model, {.enclosed = true, .across_parts = true});
  EXPECT_EQ(left_out.enclosed.components, 2U);
  EXPECT_TRUE(model.parts[0].mesh.empty());
  EXPECT_TRUE(check(model.parts[1].mesh).ok());
}

TEST(LeaveOut, TrianglesKeepTheirSources) {
  MeshPart part = shell_and_more();
  part.sources = {"a", "b", "c", "d"};
  for (std::uint32_t t = 0; t < part.mesh.triangles.size(); ++t) part.source_of.push_back(t / 128);
  Model model{{part}};
  leave_out(model, {.enclosed = true});
  const MeshPart& rest = model.parts[0];
  ASSERT_EQ(rest.source_of.size(), rest.mesh.triangles.size());
  for (std::size_t t = 0; t < rest.source_of.size(); ++t) {
    EXPECT_EQ(rest.source_of[t], t < 128 ? 0U : 3U);
    EXPECT_EQ(rest.mesh.positions[rest.mesh.triangles[t][0]].x > 3, t >= 128);
  }
}

TEST(LeaveOut, ABrokenMeshIsNotMended) {
  // Wound inwards with nothing around: for the check to find.
  Model model{{{"inwards", hollow({}, 1)}}};
  EXPECT_TRUE(leave_out(model, {.enclosed = true}).nothing());
  EXPECT_FALSE(check(model.parts[0].mesh).outward);
}

}  // namespace
}  // namespace cs2mesh
