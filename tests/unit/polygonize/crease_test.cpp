// From the surfaces to their union: contacts, refinement at creases, attributes of the pieces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "libfield/solid/offset.h"
#include "polygonize/check.h"
#include "polygonize/crease_refinement.h"
#include "polygonize/mesher.h"
#include "polygonize/metrology.h"
#include "polygonize/part_contacts.h"
#include "polygonize/source_patches.h"
#include "polygonize/unite.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

/// Two balls, meshed to a tolerance, refined where they meet, united.
struct TwoBalls {
  TwoBalls(const Vec3d& at, double radius, double tolerance)
      : one(Point{{0, 0, 0}}, 1), other(Point{at}, radius), surfaces{&one, &other} {
    for (const auto* ball : {&one, &other}) {
      MesherRequest request;
      request.tolerance = tolerance;
      request.thinnest_radius = std::min(1.0, radius);
      parts.parts.push_back(
          {ball == &one ? "one" : "other", meshers().front().mesh(*ball, request)->mesh});
    }
  }
  Offset one, other;
  std::vector<const ImplicitSurface*> surfaces;
  Model parts;
};

TEST(PartContacts, AreFoundWhereTrianglesIntersect) {
  const TwoBalls apart({2.01, 0, 0}, 1, 0.01);
  EXPECT_TRUE(find_contacts(apart.parts).empty());
  const TwoBalls meeting({1.5, 0, 0}, 1, 0.01);
  const auto contacts = find_contacts(meeting.parts);
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_EQ(contacts[0].a, 0U);
  EXPECT_EQ(contacts[0].b, 1U);
  if (!can_unite()) return;
  for (const auto& pair : contacts[0].triangles) {
    const auto& corner = meeting.parts.parts[0].mesh.triangles[pair[0]];
    EXPECT_NEAR(meeting.parts.parts[0].mesh.positions[corner[0]].x, 0.75, 0.2);
  }
}

TEST(PartContacts, ComponentsInsideAreRemoved) {
  TwoBalls pair({0.2, 0, 0}, 0.5, 0.01);
  EXPECT_FALSE(remove_components_inside(pair.parts.parts[0].mesh, pair.parts.parts[1].mesh));
  EXPECT_TRUE(remove_components_inside(pair.parts.parts[1].mesh, pair.parts.parts[0].mesh));
  EXPECT_TRUE(pair.parts.parts[1].mesh.empty());
}

TEST(CreaseRefinement, TheUnionIsWithinTheToleranceBothWays) {
  if (!can_unite()) return;
  constexpr double kTolerance = 0.004;
  // From a right angle to a narrow groove.
  for (const double distance : {0.6, 1.3, 1.6, 1.75}) {
    TwoBalls pair({distance, 0.05, 0.02}, 0.8, kTolerance);
    refine_at_creases(pair.surfaces, pair.parts, kTolerance);
    UniteOptions options;
    options.tolerance = kTolerance;
    const auto united = unite(pair.parts, options);
    ASSERT_TRUE(united);
    ASSERT_EQ(united->parts.size(), 1U);
    EXPECT_TRUE(check(united->parts[0].mesh).ok());
    MeasureOptions measuring;
    measuring.samples = 100'000;
    const MeasuredError error = measure(pair.surfaces, united->parts[0].mesh, measuring);
    EXPECT_LE(error.mesh_to_surface_max, kTolerance) << distance;
    EXPECT_LE(error.surface_to_mesh_max, kTolerance) << distance;
  }
}

TEST(CreaseUnion, PartsThatMeetNeedCgalAndOthersDoNot) {
  UniteOptions options;
  options.tolerance = 0.01;
  EXPECT_TRUE(unite({{TwoBalls({1, 0, 0}, 1, 0.01).parts.parts[0]}}, options));
  EXPECT_EQ(unite(TwoBalls({5, 0, 0}, 1, 0.01).parts, options)->parts.size(), 2U);
  const auto meeting = unite(TwoBalls({1, 0, 0}, 1, 0.01).parts, options);
  EXPECT_EQ(static_cast<bool>(meeting), can_unite());
  if (!meeting) {
    EXPECT_EQ(meeting.diagnostics().back().failure, Failure::unmeshable);
  }
}

TEST(CreaseRefinement, LeavesPartsThatAreApartAlone) {
  TwoBalls pair({3, 0, 0}, 1, 0.01);
  const Model before = pair.parts;
  refine_at_creases(pair.surfaces, pair.parts, 0.001);
  EXPECT_EQ(pair.parts.parts[0].mesh.positions, before.parts[0].mesh.positions);
  EXPECT_EQ(pair.parts.parts[1].mesh.triangles, before.parts[1].mesh.triangles);
}

TEST(SourcePatches, EachVertexHasTheAttributesOfItsPart) {
  MeshPart part;
  part.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  part.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  EXPECT_TRUE(split_by_source(part).empty());
  part.sources = {"a", "b", "c"};
  part.source_of = {0, 0, 2, 2};
  auto patches = split_by_source(part);
  ASSERT_EQ(patches.size(), 2U);
  EXPECT_EQ(patches[1].source, 2U);
  EXPECT_EQ(patches[0].mesh.triangles.size(), 2U);
  for (auto& patch : patches) {
    const float red = patch.source == 0 ? 1.0F : 0.0F;
    patch.mesh.colors.assign(patch.vertex.size(), {red, 0, 0});
    patch.mesh.normals.assign(patch.vertex.size(), {red, 1 - red, 0});
  }
  take_attributes(part, patches);
  ASSERT_EQ(part.mesh.colors.size(), 4U);
  EXPECT_EQ(part.mesh.colors[0].x, 0.5F);  // in both patches, as all four are
  EXPECT_NEAR(part.mesh.normals[1].x, std::sqrt(0.5), 1e-6);
  // The other way round, one has none: none is taken.
  patches[0].mesh.colors.clear();
  take_attributes(part, patches);
  EXPECT_TRUE(part.mesh.colors.empty());
  EXPECT_EQ(part.mesh.normals.size(), 4U);
}

TEST(SourcePatches, GlbFilesHaveSharpCreasesAndReadBackAsOnePart) {
  MeshPart part;
  part.name = "a + b";
  part.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  part.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  part.sources = {"a", "b"};
  part.source_of = {0, 0, 0, 1};
  auto patches = split_by_source(part);
  for (auto& patch : patches) {
    const float red = patch.source == 0 ? 1.0F : 0.0F;
    patch.mesh.colors.assign(patch.vertex.size(), {red, 0, 0});
    patch.mesh.normals.assign(patch.vertex.size(), {red, 1 - red, 0});
  }
  take_attributes(part, patches);
  const test::Folder folder;
  ASSERT_TRUE(write_mesh({{part}}, folder / "x.glb"));
  const auto back = read_mesh(folder / "x.glb");
  ASSERT_TRUE(back);
  ASSERT_EQ(back->parts.size(), 1U);
  const MeshPart& read = back->parts[0];
  EXPECT_EQ(read.mesh.positions.size(), 4U);
  EXPECT_TRUE(check(read.mesh).ok());
  EXPECT_EQ(read.sources, part.sources);
  EXPECT_EQ(read.source_of, part.source_of);
  ASSERT_EQ(read.patches.size(), 2U);
  EXPECT_EQ(read.patches[1].mesh.colors[0].x, 0);
  EXPECT_EQ(read.patches[0].mesh.colors[0].x, 1);
  EXPECT_EQ(read.mesh.colors.size(), 4U);
  test::expect_survives_damage(test::content(folder / "x.glb"), MeshFormat::glb);
}

TEST(SourcePatches, ObjFilesNameTheMaterialOfEachPiece) {
  MeshPart part;
  part.name = "a + b";
  part.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  part.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  part.mesh.colors.assign(4, {1, 0, 0});
  part.sources = {"a", "left b"};
  part.source_of = {0, 0, 0, 1};
  const test::Folder folder;
  ASSERT_TRUE(write_mesh({{part}}, folder / "x.obj"));
  const std::string text = test::content(folder / "x.obj");
  const auto first = text.find("usemtl a\nf "), second = text.find("usemtl left_b\nf ");
  EXPECT_NE(first, std::string::npos);
  EXPECT_NE(second, std::string::npos);
  EXPECT_LT(first, second);
  EXPECT_NE(test::content(folder / "x.mtl").find("newmtl left_b"), std::string::npos);
  EXPECT_EQ(read_mesh(folder / "x.obj")->parts.size(), 1U);
}

}  // namespace
}  // namespace cs2mesh
