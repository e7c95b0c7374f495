// Hard solids: known distances, bounds that contain.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/solid/make_solid.h"

namespace cs2mesh {
namespace {

Scene hard_element(ElementKind kind, Primitive skeleton, const Affine& transform = {}) {
  Scene scene;
  scene.materials.push_back({});
  scene.materials[0].radius = 0.5;
  Element element;
  element.kind = kind;
  element.skeleton = skeleton;
  element.transform = transform;
  scene.elements.push_back(element);
  return scene;
}

MadeSolid solid(const Scene& scene, bool offset = false) {
  return *make_solid(scene, scene.elements[0], offset);
}

TEST(Solid, SphereIsTheBall) {
  const MadeSolid ball = solid(hard_element(ElementKind::sphere, Point{{1, 0, 0}}));
  EXPECT_DOUBLE_EQ(ball.surface->value({1, 0.25, 0}), 0.25);
  EXPECT_DOUBLE_EQ(ball.surface->value({1, 0, -0.75}), -0.25);
  EXPECT_FALSE(ball.creased);
}

TEST(Solid, CylinderHasFlatLids) {
  const Scene scene = hard_element(ElementKind::cylinder, Segment{{0, 0, 0}, {0, 0, 2}});
  for (const bool offset : {false, true}) {
    const MadeSolid can = solid(scene, offset);
    EXPECT_TRUE(can.creased);
    EXPECT_NEAR(can.surface->value({0, 0, 2}), 0, 1e-15);
    EXPECT_NEAR(can.surface->value({0.49, 0, 2.25}), -0.25, 1e-12);
    EXPECT_NEAR(can.surface->value({0.5, 0, 1}), 0, 1e-15);
    EXPECT_TRUE(can.surface->bounds().contains(Vec3d{0.5, 0, 2}));
    EXPECT_TRUE(can.surface->bounds().finite());
  }
}

TEST(Solid, ArcsEndFlatAndTheirOffsetsRound) {
  for (const double width : {90.0, 270.0}) {
    const Scene scene = hard_element(ElementKind::arc, make_arc({0, 0, 0}, 2, {0, 0, 1}, 0, width));
    const Vec3d before_start{2, -0.25, 0};
    EXPECT_LT(solid(scene).surface->value(before_start), 0) << width;
    EXPECT_GT(solid(scene, true).surface->value(before_start), 0) << width;
    EXPECT_GT(solid(scene).surface->value({2, 0.25, 0}), 0) << width;
  }
  const Scene ring = hard_element(ElementKind::arc, make_arc({0, 0, 0}, 2, {0, 0, 1}, 0, 360));
  EXPECT_FALSE(solid(ring).creased);
  EXPECT_GT(solid(ring).surface->value({2, -0.25, 0}), 0);
}

TEST(Solid, HardPlaneIsTheHalfSpaceBelow) {
  const MadeSolid ground = solid(hard_element(ElementKind::plane, Plane{{0, 0, 1}, {0, 0, 1}}));
  EXPECT_GT(ground.surface->value({5, 5, 0}), 0);
  EXPECT_LT(ground.surface->value({5, 5, 2}), 0);
  EXPECT_EQ(ground.surface->bounds().max.z, 1);
  EXPECT_FALSE(ground.surface->bounds().finite());
}

Scene cone(const Vec3d& base, double radius, const Vec3d& apex, double apex_radius,
           const Affine& transform = {}) {
  Scene scene = hard_element(ElementKind::cone, Segment{base, apex}, transform);
  scene.elements[0].own_radius = radius;
  scene.elements[0].apex_radius = apex_radius;
  return scene;
}

TEST(Solid, ConeHasItsRadiiAtItsEndsAndLids) {
  const MadeSolid whole = solid(cone({0, 0, 0}, 3, {0, 0, 4}, 0));
  EXPECT_TRUE(whole.creased);
  EXPECT_NEAR(whole.surface->value({1.5, 0, 2}), 0, 1e-15);
  EXPECT_NEAR(whole.surface->value({0, 0, 4}), 0, 1e-15);
  // From the axis to the side 3/5 of the height above, at right angles; gradients have length 1.
  EXPECT_NEAR(whole.surface->value({0, 0, 3}), 0.6, 1e-15);
  EXPECT_NEAR(whole.surface->value({0, 2, 3}), 0.6 - 1.6, 1e-15);
  EXPECT_NEAR(norm(whole.surface->jet({0, 2, 3}).gradient), 1, 1e-15);
  EXPECT_NEAR(whole.surface->value({0, 1, -0.5}), -0.5, 1e-15);
  EXPECT_LT(whole.surface->value({0, 0, 5}), 0);
  const MadeSolid cut = solid(cone({1, 0, 0}, 1, {3, 0, 0}, 2));
  EXPECT_NEAR(cut.surface->value({2, 0, 1.5}), 0, 1e-15);
  EXPECT_NEAR(cut.surface->value({3.25, 1, 0}), -0.25, 1e-15);
  EXPECT_TRUE(cut.surface->bounds().finite());
  EXPECT_TRUE(cut.surface->bounds().contains(Vec3d{3, 2, 0}));
}

TEST(Solid, WhatIsShortBetweenFlatEndsIsAsThinAsThat) {
  const auto disc = hard_element(ElementKind::cylinder, Segment{{1, 0, 0}, {1, 0, 0.25}});
  EXPECT_EQ(solid(disc).radius, 0.125);
  EXPECT_EQ(solid(hard_element(ElementKind::cylinder, Segment{{1, 0, 0}, {1, 0, 2}})).radius, 0.5);
  EXPECT_EQ(solid(cone({0, 0, 0}, 2, {0, 0, 0.5}, 1)).radius, 0.25);
  const auto slice = hard_element(ElementKind::arc, make_arc({0, 0, 0}, 2, {0, 0, 1}, 0, 3));
  EXPECT_NEAR(solid(slice).radius, 0.5 * 2 * 3 * std::numbers::pi / 180, 1e-12);
}

TEST(Solid, BoxIsWhatLiesBetweenItsCorners) {
  const Scene scene = hard_element(ElementKind::box, Segment{{0, 0, 0}, {1, 2, 3}});
  const MadeSolid box = solid(scene);
  EXPECT_TRUE(box.creased);
  EXPECT_EQ(box.radius, 0.5);
  EXPECT_DOUBLE_EQ(box.surface->value({0.25, 1, 1}), 0.25);
  EXPECT_DOUBLE_EQ(box.surface->value({0.5, 1, 3.5}), -0.5);
  EXPECT_EQ(box.surface->bounds(), (Aabb{{0, 0, 0}, {1, 2, 3}}));
  Scene turned = scene;
  turned.elements[0].transform = Affine::rotate({1, 2, 3}, 50);
  EXPECT_TRUE(solid(turned).surface->bounds().finite());
}

Scene polygon(const std::vector<Vec3d>& vertices, const Affine& transform = {}) {
  Scene scene = hard_element(ElementKind::polygon, Point{}, transform);
  scene.elements[0].shape = 0;
  scene.polygons.push_back(std::get<Polygon>(make_polygon(vertices)));
  return scene;
}

Scene quadric(const Symmetric3& square, const Vec3d& linear, double constant,
              const Affine& transform = {}, std::optional<Aabb> bounds = std::nullopt) {
  Scene scene = hard_element(ElementKind::quadric, Point{}, transform);
  scene.elements[0].shape = 0;
  scene.quadrics.push_back({square, linear, constant, bounds});
  return scene;
}

const std::vector<Vec3d> kNotch = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0.5, 0}, {0, 2, 0}};

TEST(Solid, OffsetsAreAllWithinTheRadius) {
  // Where the skeleton, its offset surface and a point at a distance from it are known.
  struct Known {
    Scene scene;
    Vec3d point;
    double distance;
  };
  const std::vector<Known> all = {
      {hard_element(ElementKind::dot, Point{{1, 0, 0}}), {1, 2, 0}, 2},
      {hard_element(ElementKind::line, Segment{{0, 0, 0}, {0, 0, 2}}), {3, 0, 6}, 5},
      {hard_element(ElementKind::line, Segment{{0, 0, 0}, {0, 0, 2}}), {0, 0.25, 1}, 0.25},
      {hard_element(ElementKind::arch, Segment{{0, 0, 0}, {0, 0, 2}}), {0, 0, -0.4}, 0.4},
      {hard_element(ElementKind::arc, make_arc({0, 0, 0}, 2, {0, 0, 1}, 0, 90)), {2, -1, 0}, 1},
      {hard_element(ElementKind::triangle, Triangle{{Vec3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}),
       {0.25, 0.25, 3},
       3},
      {hard_element(ElementKind::triangle, Triangle{{Vec3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}),
       {0.5, -3, 4},
       5},
      {hard_element(ElementKind::plane, Plane{{0, 0, 1}, {0, 0, 1}}), {9, 9, -2}, 3},
      {polygon(kNotch), {0.25, 0.25, -3}, 3},
      {polygon(kNotch), {-3, 1, 4}, 5},
      {polygon(kNotch), {1, 0.75, 0}, 0.25 / std::sqrt(1 + 1.5 * 1.5)}};
  for (const Known& known : all) {
    const MadeSolid made = solid(known.scene, true);
    EXPECT_NEAR(made.surface->value(known.point), 0.5 - known.distance, 1e-14)
        << name_of(known.scene.elements[0].kind);
    EXPECT_EQ(made.radius, 0.5);
  }
  EXPECT_TRUE(solid(polygon(kNotch), true).creased);
  EXPECT_FALSE(solid(polygon({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}}), true).creased);
}

TEST(Solid, PipesHaveLidsUntilTheyAreOffsets) {
  Scene scene = hard_element(ElementKind::cylinder, Segment{{0, 0, 0}, {0, 0, 2}});
  scene.elements[0].spelling = Spelling::pipe;
  const Vec3d above{0, 0, 2.25};
  EXPECT_NEAR(solid(scene).surface->value(above), -0.25, 1e-15);
  EXPECT_NEAR(solid(scene, true).surface->value(above), 0.25, 1e-15);
  EXPECT_TRUE(solid(scene).creased);
  EXPECT_FALSE(solid(scene, true).creased);
  const Scene straight = hard_element(ElementKind::arch, Segment{{0, 0, 0}, {0, 0, 2}});
  EXPECT_NEAR(solid(straight).surface->value(above), -0.25, 1e-15);
}

TEST(Solid, OffsetOfAConeIsAllItsBalls) {
  Random random(11);
  for (const auto& [a, b] : {std::pair{1.0, 0.25}, {0.0, 0.9}, {0.5, 0.5}, {2.5, 0.1}}) {
    const Segment axis{{0, 0, 0}, {0, 1, 2}};
    const MadeSolid made = solid(cone(axis.a, a, axis.b, b), true);
    EXPECT_FALSE(made.creased);
    for (int trial = 0; trial < 100; ++trial) {
      const Vec3d p{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 4)};
      double greatest = -HUGE_VAL;
      for (int i = 0; i <= 2000; ++i) {
        const double t = i / 2000.0;
        greatest = std::max(greatest, a + t * (b - a) - norm(p - axis.a - t * (axis.b - axis.a)));
      }
      const Jet jet = made.surface->jet(p);
      EXPECT_NEAR(jet.value, greatest, 2e-6);
      EXPECT_GE(jet.value, greatest - 1e-14);
      EXPECT_NEAR(norm(jet.gradient), 1, 1e-12);
    }
  }
}

TEST(Solid, QuadricIsWhereItsPolynomialIsNotAboveZero) {
  const Affine place =
      Affine::translate({1000, 2, 3}) * Affine::rotate({1, 2, 3}, 50) * Affine::scale({1, 2, -0.5});
  const Symmetric3 square{1, 4, -0.5, 0.25, 0, 0.5};
  const Scene scene = quadric(square, {0.5, 0, 1}, -1, place);
  const auto surface = solid(scene).surface;
  Random random(12);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3d p{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
    const double q = evaluate(scene.quadrics[0], p).value;
    const double f = surface->value(place(p));
    EXPECT_EQ(f >= 0, q <= 0);
    EXPECT_NEAR(f, -q * surface->value(place({0, 0, 0})), 1e-9);
  }
}

TEST(Solid, QuadricsKeepTheirScaleAndTheirBounds) {
  const MadeSolid ball = solid(quadric({4, 4, 4, 0, 0, 0}, {}, -1));
  EXPECT_FALSE(ball.creased);
  EXPECT_DOUBLE_EQ(ball.radius, 0.5);
  EXPECT_NEAR(norm(ball.surface->jet({0.5, 0, 0}).gradient), 1, 1e-15);
  EXPECT_LT(norm(ball.surface->bounds().extent() - Vec3d{1, 1, 1}), 1e-11);
  EXPECT_EQ(ball.surface->derivative_bound(3, {{0, 0, 0}, {1, 1, 1}}), 0);
  const Aabb low{{-1, -1, -2}, {1, 1, 0}};
  const MadeSolid cut = solid(quadric({1, 1, 0, 0, 0, 0}, {0, 0, 1}, 0, {}, low));
  EXPECT_TRUE(cut.creased);
  EXPECT_TRUE(low.grown(1e-12).contains(cut.surface->bounds()));
  EXPECT_GT(cut.surface->value({0.5, 0.5, -1}), 0);
  EXPECT_LT(cut.surface->value({0.5, 0.5, -2.5}), 0);
}

TEST(Solid, QuadricsWithoutInsideAreErrors) {
  const auto fails = [](const Scene& scene) {
    return !make_solid(scene, scene.elements[0], false);
  };
  EXPECT_TRUE(fails(quadric({1, 1, 1, 0, 0, 0}, {}, 1)));
  EXPECT_TRUE(fails(quadric({1, 1, 1, 0, 0, 0}, {}, 0)));
  EXPECT_TRUE(fails(quadric({1, 1, 1, 0, 0, 0}, {}, -1, {}, Aabb{{5, 5, 5}, {6, 6, 6}})));
  EXPECT_TRUE(fails(quadric({1e300, 1, 1, 0, 0, 0}, {1e300, 1e300, 0}, 1e300)));
  EXPECT_TRUE(fails(quadric({1e-300, 0, 0, 0, 0, 0}, {1, 0, 0}, 0)));
  EXPECT_FALSE(fails(quadric({1, 1, -1, 0, 0, 0}, {}, 0)));
}

TEST(Solid, BoundsContainWhatIsSampled) {
  const Affine skew = Affine::rotate({1, 1, 0}, 40) * Affine::scale({0.5, 2, -1});
  const std::vector<Scene> scenes = {
      hard_element(ElementKind::sphere, Point{{1, 0, 0}}, skew),
      hard_element(ElementKind::cylinder, Segment{{0, 0, 0}, {0, 1, 2}}, skew),
      hard_element(ElementKind::arc, make_arc({0, 0, 0}, 1, {0, 0, 1}, 20, 100), skew),
      hard_element(ElementKind::arc, make_arc({0, 0, 0}, 1, {0, 0, 1}, 20, 300)),
      hard_element(ElementKind::plane, Plane{{0, 0, 1}, {0, 0, 1}}, skew),
      hard_element(ElementKind::triangle, Triangle{{Vec3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, skew),
      cone({0, 0, -1}, 1, {0.5, 0, 1}, 0.25, skew),
      cone({0, 0, -1}, 2, {0, 0, 2}, 0),
      hard_element(ElementKind::box, Segment{{-1, -1, -1}, {1, 2, 1}}, skew),
      polygon(kNotch, skew),
      polygon(kNotch),
      quadric({1, 2, 3, 0.5, 0, -0.5}, {1, 0, 0}, -1, skew),
      quadric({1, 2, -3, 0.5, 0, -0.5}, {1, 0, 0}, 0),
      quadric({1, 1, 0, 0, 0, 0}, {0, 0, 1}, 0, skew, Aabb{{-1, -1, -2}, {1, 1, 0}})};
  Random random(1);
  for (std::size_t which = 0; which < scenes.size(); ++which) {
    const ElementKind kind = scenes[which].elements[0].kind;
    const bool offset = kind == ElementKind::triangle || kind == ElementKind::polygon ||
                        (kind == ElementKind::cone && which % 2 == 0);
    const auto surface = solid(scenes[which], offset).surface;
    for (int trial = 0; trial < 400; ++trial) {
      const double size = std::pow(10.0, random.uniform(-2, 0));
      const Vec3d corner{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
      const Aabb box{corner, corner + Vec3d{size, size, size}};
      const auto part = surface->restrict_to(box);
      const auto gradient = surface->enclose_gradient(box);
      const double hessian = surface->derivative_bound(2, box);
      const Jet first = surface->jet(box.center());
      for (int sample = 0; sample < 12; ++sample) {
        const Vec3d p = corner + size * Vec3d{random.uniform(), random.uniform(), random.uniform()};
        const Jet jet = surface->jet(p);
        EXPECT_EQ(jet.value, part->value(p));
        ASSERT_TRUE(surface->enclose(box).contains(jet.value)) << which;
        EXPECT_LE(norm(jet.gradient), surface->derivative_bound(1, box) * (1 + 1e-12));
        EXPECT_LE(norm(jet.gradient - first.gradient),
                  hessian * norm(p - box.center()) * (1 + 1e-9) + 1e-12)
            << which;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          EXPECT_TRUE(widened(gradient[axis], 1e-12).contains(jet.gradient[axis])) << which;
        }
        if (jet.value >= 0) {
          EXPECT_TRUE(surface->bounds().grown(1e-12).contains(p));
        }
      }
    }
  }
}

}  // namespace
}  // namespace cs2mesh
