// What compile() makes of a scene, and what it refuses.
#include "libfield/field/compile.h"

#include <gtest/gtest.h>

#include "libfield/field/field.h"

namespace cs2mesh {
namespace {

Scene one_element(ElementKind kind, Primitive skeleton) {
  Scene scene;
  scene.file = "one.art";
  Material material;
  material.name = "m";
  material.radius = 0.25;
  material.blobbiness = -4;
  scene.materials.push_back(material);
  Element element;
  element.kind = kind;
  element.skeleton = skeleton;
  element.where = {scene.file, 3, 2};
  scene.elements.push_back(element);
  return scene;
}

std::string error_of(const Scene& scene) {
  const Result<CompiledScene> compiled = compile(scene);
  EXPECT_FALSE(compiled);
  return compiled ? "" : to_string(compiled.diagnostics()[0]);
}

TEST(Compile, AnIsolatedPrimitiveHasItsSurfaceAtItsRadius) {
  const Scene ball = one_element(ElementKind::sphere, Point{{1, 2, 3}});
  const auto surface = compile(ball)->parts[0].surface;
  EXPECT_NEAR(surface->value({1.25, 2, 3}), 0, 1e-13);
  EXPECT_GT(surface->value({1.24, 2, 3}), 0);

  const Scene bone = one_element(ElementKind::line, Segment{{0, 0, 0}, {2, 0, 0}});
  EXPECT_NEAR(compile(bone)->parts[0].surface->value({1, 0.25, 0}), 0, 1e-12);
}

TEST(Compile, WidthAloneGivesThePlainIntegral) {
  Scene scene = one_element(ElementKind::sphere, Point{{0, 0, 0}});
  scene.materials[0].radius.reset();
  scene.materials[0].width = 2.0;
  scene.elements[0].own_radius = 0.7;
  const auto field = std::dynamic_pointer_cast<const Field>(compile(scene)->parts[0].surface);
  const Vec3d p{0.5, 0, 0};
  Jet jet;
  field->full_jets({&p, 1}, {&jet, 1});
  EXPECT_DOUBLE_EQ(jet.value, 0.25);  // (1 + 4/4)^-2
}

TEST(Compile, RefusesWhatHasNoRadius) {
  Scene scene = one_element(ElementKind::line, Segment{{0, 0, 0}, {1, 0, 0}});
  scene.materials[0].radius.reset();
  EXPECT_EQ(error_of(scene),
            "one.art:3:2: error: a soft line needs a radius, expected 'radius' or 'width' in "
            "surface 'm'");
}

TEST(Compile, RefusesAnInverseKernelOnAPlane) {
  Scene scene = one_element(ElementKind::plane, Plane{});
  scene.materials[0].kernel = KernelKind::inverse;
  const Result<CompiledScene> compiled = compile(scene);
  ASSERT_FALSE(compiled);
  EXPECT_EQ(compiled.diagnostics()[0].failure, Failure::unmeshable);
}

TEST(Compile, RefusesASceneWithoutSurface) {
  Scene scene = one_element(ElementKind::sphere, Point{});
  scene.materials[0].strength = 0;
  EXPECT_NE(error_of(scene).find("no surface"), std::string::npos);
  EXPECT_NE(error_of(Scene{}).find("no surface"), std::string::npos);
}

TEST(Compile, RefusesAFlatThingWithoutThickness) {
  Scene scene =
      one_element(ElementKind::triangle, Triangle{{Vec3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
  scene.materials[0].blobbiness.reset();
  EXPECT_NE(error_of(scene).find("no thickness"), std::string::npos);
}

TEST(Compile, DegeneratePrimitivesBecomePoints) {
  const Scene scene = one_element(ElementKind::line, Segment{{1, 0, 0}, {1, 0, 0}});
  const Result<CompiledScene> compiled = compile(scene);
  ASSERT_TRUE(compiled);
  ASSERT_EQ(compiled.diagnostics().size(), 1U);
  EXPECT_EQ(compiled.diagnostics()[0].severity, Severity::note);
  EXPECT_NEAR(compiled->parts[0].surface->value({1, 0.25, 0}), 0, 1e-12);
}

Scene tapered_bone(const SegmentWeight& weight, double length = 2) {
  Scene scene = one_element(ElementKind::line, Segment{{0, 0, 0}, {length, 0, 0}});
  scene.elements[0].taper = weight;
  return scene;
}

double full_value(const Scene& scene, const Vec3d& p) {
  const auto field = std::dynamic_pointer_cast<const Field>(compile(scene)->parts[0].surface);
  Jet jet;
  field->full_jets({&p, 1}, {&jet, 1});
  return jet.value;
}

TEST(Compile, ALinearTaperKeepsTheRadiusInTheMiddle) {
  const auto surface = compile(tapered_bone(linear_weight(1.75, 0.25)))->parts[0].surface;
  EXPECT_NEAR(surface->value({1, 0.25, 0}), 0, 1e-12);
  EXPECT_GT(surface->value({0.5, 0.25, 0}), 0);
  EXPECT_LT(surface->value({1.5, 0.25, 0}), 0);
}

TEST(Compile, TapersOfAnySizeAndSignAreTheirWeightTimesTheBone) {
  const Vec3d p{0.7, 0.1, 0.2};
  const double whole = full_value(tapered_bone(linear_weight(1, 1)), p);
  EXPECT_NEAR(whole, full_value(one_element(ElementKind::line, Segment{{0, 0, 0}, {2, 0, 0}}), p),
              1e-14 * whole);
  const double some = full_value(tapered_bone({1, 0.5, -0.75}), p);
  for (const double k : {-1e200, -3.0, 1e-150, 1e30}) {
    Scene scene = tapered_bone({k, 0.5 * k, -0.75 * k});
    EXPECT_NEAR(full_value(scene, p) / k, some, 1e-12 * std::abs(some)) << k;
    scene.materials[0].strength = -1 / k;
    EXPECT_NEAR(full_value(scene, p), -some, 1e-12 * std::abs(some)) << k;
  }
}

TEST(Compile, ATaperedBoneOfNoSizeIsThePointOfTheMeanWeight) {
  const double point = full_value(one_element(ElementKind::line, Segment{}), {0.25, 0, 0});
  EXPECT_NEAR(full_value(tapered_bone({1, 0.5, 3}, 1e-14), {0.25, 0, 0}), 1.5 * point, 1e-12);
}

TEST(Compile, RefusesATaperThatDoesNothing) {
  EXPECT_NE(error_of(tapered_bone({0, 0, 0})).find("no surface"), std::string::npos);
  for (const KernelKind kind : kAllKernels) {
    if (kind == KernelKind::cauchy || kind == KernelKind::gaussian) continue;
    Scene scene = tapered_bone(linear_weight(1, 0.5));
    scene.materials[0].kernel = kind;
    EXPECT_NE(error_of(scene).find("takes no taper"), std::string::npos) << name_of(kind);
  }
}

TEST(Compile, UnboundedPartsNeedBounds) {
  Scene scene = one_element(ElementKind::plane, Plane{{0, 0, 0}, {0, 0, 1}});
  Result<CompiledScene> open = clip_to_bounds(*compile(scene), scene);
  ASSERT_FALSE(open);
  EXPECT_EQ(open.diagnostics()[0].failure, Failure::unmeshable);

  scene.mesh.bounds = Aabb{{-1, -1, -1}, {1, 1, 1}};
  const Result<CompiledScene> closed = clip_to_bounds(*compile(scene), scene);
  ASSERT_TRUE(closed);
  const ImplicitSurface& surface = *closed->parts[0].surface;
  EXPECT_TRUE(surface.bounds().finite());
  EXPECT_NEAR(surface.value({0.5, 0.5, 0.25}), 0, 1e-12);
  EXPECT_LT(surface.value({1.5, 0, 0}), 0);
  EXPECT_NEAR(surface.value({1, 0, 0}), 0, 1e-15);
}

TEST(Compile, WhatOnlyCarvesIsEmptyNotUnbounded) {
  Scene scene = one_element(ElementKind::sphere, Point{});
  scene.materials[0].strength = -1;
  const Result<CompiledScene> open = clip_to_bounds(*compile(scene), scene);
  ASSERT_TRUE(open);
  EXPECT_TRUE(open->parts[0].surface->bounds().empty());
  scene.mesh.bounds = Aabb{{-1, -1, -1}, {1, 1, 1}};
  const Result<CompiledScene> closed = clip_to_bounds(*compile(scene), scene);
  ASSERT_TRUE(closed);
  EXPECT_TRUE(closed->parts[0].surface->bounds().empty());
}

TEST(Compile, BlendLinesMakeGroups) {
  Scene scene = one_element(ElementKind::sphere, Point{});
  for (int i = 0; i < 3; ++i) {
    Object object;
    object.name = "o" + std::to_string(i);
    object.blend = i == 0 ? "legs" : "";
    scene.objects.push_back(object);
    Element element = scene.elements[0];
    element.object = i;
    scene.elements.push_back(element);
  }
  const Result<CompiledScene> compiled = compile(scene);
  ASSERT_EQ(compiled->parts.size(), 4U);
  EXPECT_EQ(compiled->parts[0].name, "soft");
  EXPECT_EQ(compiled->parts[1].name, "legs");
  EXPECT_EQ(compiled->parts[2].name, "#1");
  EXPECT_EQ(compiled->parts[3].name, "#2");
}

TEST(Compile, ExtentIsTheUnionOfGrownBoxes) {
  Scene scene = one_element(ElementKind::line, Segment{{0, 0, 0}, {2, 0, 0}});
  scene.elements[0].transform = Affine::scale({2, 2, 2});
  const Aabb extent = compile(scene)->extent;
  EXPECT_EQ(extent.min, (Vec3d{-0.5, -0.5, -0.5}));
  EXPECT_EQ(extent.max, (Vec3d{4.5, 0.5, 0.5}));
}

}  // namespace
}  // namespace cs2mesh
