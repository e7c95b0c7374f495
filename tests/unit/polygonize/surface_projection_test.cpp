// Feet are found where value and gradient of a field say little of the distance.
#include "polygonize/surface_projection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/field/field.h"
#include "polygonize/triangle_sample.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

/// Two balls of radius 1 and blobbiness -1000, 1.9 apart: a groove as sharp as a knife.
Field stiff_pair() {
  std::vector<Term> terms(2);
  for (Term& term : terms) term.kernel = Gaussian{std::sqrt(1000.0), 1000.0};
  terms[0].primitive = Point{{0, 0, 0}};
  terms[1].primitive = Point{{1.9, 0, 0}};
  for (Term& term : terms) term.frame = frame_of(term.primitive);
  return {std::move(terms), 1e-9};
}

TEST(FindFoot, GoesByTheLogarithmInAGroove) {
  const Field field = stiff_pair();
  const Vec3d p{0.95, 0.33, 0};  // 0.0177 above the ring where the spheres meet
  const double first_order = first_order_distance(field.jet(p), HUGE_VAL);
  ASSERT_GT(first_order, 1.0) << "the test means to try a place where that is useless";
  const Foot foot = find_foot(field, p, first_order);
  EXPECT_LT(foot.distance, 0.0090);  // of either sphere 0.00569, of the ring 0.0177
  EXPECT_GT(foot.distance, 0.0050);
  EXPECT_NEAR(norm(foot.point - p), foot.distance, 1e-3 * foot.distance);
}

TEST(FindFoot, LooksAroundWhereThereIsNoGradient) {
  // Between two walls of a kernel of finite support F is 0, and so is its gradient.
  std::vector<Term> terms(2);
  for (Term& term : terms) term.kernel = make_kernel(KernelKind::quartic, 1.0, 1e6, 1.0, 1e-6);
  terms[0].primitive = Point{{0, 0, 0}};
  terms[1].primitive = Point{{2.1, 0, 0}};
  for (Term& term : terms) term.frame = frame_of(term.primitive);
  const Field field(std::move(terms), 1e-9);
  const Vec3d p{1.05, 0, 0};
  ASSERT_EQ(norm(field.jet(p).gradient), 0.0);
  const Foot foot = find_foot(field, p, 100.0);
  EXPECT_LT(foot.distance, 0.12);
}

TEST(SearchAround, CloselyFindsABallBetweenItsLines) {
  // 23 degrees and more off all axes and diagonals; seen from the origin it is 13 degrees wide.
  const Vec3d direction = normalized(Vec3d{1, 0.5, 0.27});
  const analytic::Surface<analytic::Sphere> ball(analytic::Sphere{1.3 * direction, 0.3});
  EXPECT_FALSE(search_around(ball, {0, 0, 0}, 1.2));
  const auto found = search_around(ball, {0, 0, 0}, 1.2, true);
  ASSERT_TRUE(found);
  EXPECT_GE(found->distance, 1.0);
  EXPECT_LT(found->distance, 1.1);
  EXPECT_LE(ball.value(found->near), 0.0);
  EXPECT_GE(ball.value(found->far), 0.0);
  EXPECT_FALSE(search_around(ball, {0, 0, 0}, 0.99, true));
}

TEST(FirstOrderDistance, IsNotZeroDeepInsideAStiffField) {
  const Field field = stiff_pair();
  const double distance = first_order_distance(field.jet({0.7, 0, 0}), HUGE_VAL);
  EXPECT_GT(distance, 0.1);
  EXPECT_LT(distance, 0.6);
}

/// A bone that is thick to one side of a step and thin to the other, of which the gradient on the
/// thin side knows nothing.
TEST(FindFoot, OfSurfaceNearEnoughIsEnough) {
  std::vector<Term> terms(1);
  terms[0].kernel = Gaussian{4.0, 3.0};
  terms[0].primitive = Segment{{-1, 0, 0}, {1, 0, 0}};
  terms[0].frame = frame_of(terms[0].primitive);
  StrengthProfile half;
  half.along_u = ProfileFunction::step;
  half.lower = 0.5;
  terms[0].profiles = {half};
  const Field field(std::move(terms), 1e-9);
  const auto radius_at = [&](double x) {
    double lo = 0, hi = 1;
    for (int i = 0; i < 50; ++i)
      (field.value({x, 0.5 * (lo + hi), 0}) >= 0 ? lo : hi) = 0.5 * (lo + hi);
    return lo;
  };
  const double thin = radius_at(-0.01), thick = radius_at(0.01);
  ASSERT_GT(thick, thin + 0.04);
  const Vec3d p{-0.01, thick - 0.005, 0};  // 0.01 before the wall, more above the thin part
  const double first_order = first_order_distance(field.jet(p), HUGE_VAL);
  ASSERT_GT(first_order, 0.02);
  for (const double enough : {0.012, 0.02}) {
    const Foot foot = find_foot(field, p, first_order, enough);
    EXPECT_LE(foot.distance, enough);
    EXPECT_GE(foot.distance, 0.0099);
    EXPECT_NEAR(norm(foot.point - p), foot.distance, 1e-9);
  }
}

}  // namespace
}  // namespace cs2mesh
