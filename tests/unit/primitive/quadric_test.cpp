#include "libfield/primitive/quadric.h"

#include <gtest/gtest.h>

#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

Vec3d random_vector(Random& random) {
  return {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
}

Quadric random_quadric(Random& random) {
  const auto entry = [&] { return random.uniform(-1, 1); };
  return {{entry(), entry(), entry(), entry(), entry(), entry()},
          random_vector(random),
          entry(),
          std::nullopt};
}

/// (p - center)^T A (p - center) - 1 with half axes along a turned frame.
Quadric ellipsoid(const Vec3d& half, const Affine& placement) {
  Quadric unit;
  unit.square = {1 / (half.x * half.x), 1 / (half.y * half.y), 1 / (half.z * half.z), 0, 0, 0};
  unit.constant = -1;
  return substituted(unit, inverse(placement));
}

TEST(Quadric, SubstitutionIsThatOfThePoint) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Quadric q = random_quadric(random);
    const Affine map = Affine::translate(random_vector(random)) *
                       Affine::rotate({1, 2, -1}, random.uniform(0, 360)) *
                       Affine::scale({0.5, -2, 1.5});
    const Vec3d p = random_vector(random);
    const Jet2 direct = evaluate(q, map(p));
    const Jet2 moved = evaluate(substituted(q, map), p);
    EXPECT_NEAR(moved.value, direct.value, 1e-12);
    EXPECT_LT(norm(moved.gradient - transpose(map.linear) * direct.gradient), 1e-12);
    EXPECT_LT(norm(moved.hessian - congruent(direct.hessian, map.linear)), 1e-12);
  }
}

TEST(Quadric, AnEllipsoidIsFoundAgain) {
  const Affine placement = Affine::translate({3, -1, 2}) * Affine::rotate({1, 1, 3}, 50);
  const QuadricForm form = form_of(ellipsoid({1, 2, 0.5}, placement));
  EXPECT_LT(norm(form.center - Vec3d{3, -1, 2}), 1e-13);
  EXPECT_NEAR(form.value, -1, 1e-12);
  EXPECT_EQ(form.slope, Vec3d{});
  EXPECT_NEAR(least_radius(form), 0.5, 1e-13);
  EXPECT_FALSE(has_no_inside(form));
  const Aabb box = bounds(form);
  Random random(2);
  Aabb touched;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d d = random.direction();
    const Vec3d p = placement({d.x, 2 * d.y, 0.5 * d.z});
    EXPECT_TRUE(box.contains(p));
    touched.include(p);
  }
  EXPECT_LT(norm(box.extent() - touched.extent()), 0.01);
}

TEST(Quadric, FormsAreToldApart) {
  const QuadricForm tube = form_of({{1, 1, 0, 0, 0, 0}, {-4, 0, 0}, 0, std::nullopt});
  EXPECT_EQ(bounds(tube).min.x, 2 - 2 * (1 + 1e-12));
  EXPECT_EQ(bounds(tube).max.z, HUGE_VAL);
  EXPECT_EQ(least_radius(tube), 2);
  const QuadricForm bowl = form_of({{2, 2, 0, 0, 0, 0}, {0, 0, -1}, 0, std::nullopt});
  EXPECT_EQ(bowl.slope, (Vec3d{0, 0, -1}));
  EXPECT_EQ(least_radius(bowl), 0.25);  // the radius of curvature at the vertex
  EXPECT_FALSE(bounds(bowl).finite());
  const QuadricForm tip = form_of({{1, 1, -1, 0, 0, 0}, {-2, 0, 0}, 1, std::nullopt});
  EXPECT_EQ(tip.value, 0);
  EXPECT_EQ(least_radius(tip), 0);
  EXPECT_FALSE(has_no_inside(tip));
  EXPECT_TRUE(has_no_inside(form_of({{1, 1, 1, 0, 0, 0}, {}, 0, std::nullopt})));
  EXPECT_TRUE(has_no_inside(form_of({{1, 0, 0, 0, 0, 0}, {}, 0.5, std::nullopt})));
  EXPECT_TRUE(has_no_inside(form_of({{1, 1, 0, 0, 0, 0}, {-2, 4, 0}, 6, std::nullopt})));
  EXPECT_FALSE(has_no_inside(form_of({{}, {0, 0, 1}, 0, std::nullopt})));
  EXPECT_TRUE(bounds(form_of({{1, 1, 1, 0, 0, 0}, {}, 1, std::nullopt})).empty());
}

}  // namespace
}  // namespace cs2mesh
