#include "libfield/primitive/primitive.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "libfield/base/check.h"
#include "libfield/primitive/uv_bends.h"
#include "tests/property/random_primitives.h"

namespace cs2mesh {
namespace {

constexpr double kPi = std::numbers::pi;

// Points of a primitive by its parametrisation, s and t in [0, 1].
Vec3d sample(const Point& point, double, double) {
  return point.position;
}
Vec3d sample(const Segment& segment, double s, double) {
  return segment.a + s * (segment.b - segment.a);
}
Vec3d sample(const TaperedSegment& segment, double s, double t) {
  return sample(segment.axis, s, t);
}
Vec3d sample(const Arc& arc, double s, double) {
  const double t = (s - 0.5) * arc.sweep;
  return arc.center + arc.radius * (std::cos(t) * arc.ex + std::sin(t) * arc.ey);
}
Vec3d sample(const Triangle& triangle, double s, double t) {
  const auto& v = triangle.vertex;
  const double root = std::sqrt(s);
  return v[0] + root * ((1.0 - t) * (v[1] - v[0]) + t * (v[2] - v[0]));
}
Vec3d sample(const Plane& plane, double s, double t) {
  const Vec3d x = reference_axis(plane.normal);
  return plane.point + 20.0 * ((s - 0.5) * x + (t - 0.5) * cross(plane.normal, x));
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance) {
  EXPECT_LE(norm(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << " against " << b.x << " " << b.y << " " << b.z;
}

class PrimitiveTest : public ::testing::TestWithParam<std::size_t> {
 protected:
  // Calls test(primitive, random) for a few hundred primitives of the kind.
  template <class Test>
  void for_many(const Test& test) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      Random random(seed, GetParam());
      const double size_of_it = testing::log_uniform(random, 0.01, 10.0);
      const Primitive primitive = testing::random_primitive(random, GetParam(), size_of_it);
      std::visit([&](const auto& p) { test(p, random); }, primitive);
    }
  }
};

TEST_P(PrimitiveTest, DistanceIsTheLeastOverItsPoints) {
  for_many([](const auto& primitive, Random& random) {
    const Vec3d p = middle(primitive) + testing::random_vector(random, 3.0);
    double nearest = INFINITY;
    constexpr int kSteps = 100;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; j <= kSteps; ++j) {
        const Vec3d q = sample(primitive, i / double{kSteps}, j / double{kSteps});
        nearest = std::min(nearest, norm(p - q));
        EXPECT_LE(distance(primitive, q), 4e-15 * (norm(q) + 10.0));
      }
    }
    const double d = distance(primitive, p);
    EXPECT_LE(d, nearest * (1.0 + 1e-14));
    const double extent = std::min(size(primitive), 20.0);
    EXPECT_GE(d, nearest - 0.15 * extent);
    if (primitive.kDimension == 1) {
      EXPECT_GE(d, nearest - 0.04 * extent);
    }
  });
}

TEST_P(PrimitiveTest, BoundsSizeAndMiddleHoldItsPoints) {
  for_many([](const auto& primitive, Random& random) {
    const Aabb box = bounds(primitive).grown(1e-14);
    Aabb seen;
    for (int i = 0; i < 2000; ++i) {
      const Vec3d q =
          sample(primitive, i < 2 ? i : random.uniform(), i % 3 == 0 ? 1.0 : random.uniform());
      EXPECT_TRUE(box.contains(q));
      EXPECT_LE(norm(q - middle(primitive)), size(primitive) * (1.0 + 1e-14));
      seen.include(q);
    }
    if (primitive.kDimension == 1) {
      EXPECT_LE(norm(box.extent() - seen.extent()), 0.01 * size(primitive) + 1e-13);
    }
    EXPECT_LE(distance(primitive, middle(primitive)), 1e-15 * (norm(middle(primitive)) + 10.0));
  });
}

TEST_P(PrimitiveTest, SimilaritiesMoveItsPoints) {
  for_many([](const auto& primitive, Random& random) {
    const double factor = testing::log_uniform(random, 0.1, 10.0);
    const Affine map = testing::random_similarity(random, factor, random.uniform() < 0.5);
    const auto image = transformed(primitive, map);
    for (int i = 0; i < 20; ++i) {
      const Vec3d q = sample(primitive, random.uniform(), random.uniform());
      EXPECT_LE(distance(image, map(q)), 1e-13 * (1.0 + factor) * 10.0);
    }
    const double power = std::pow(factor, primitive.kDimension);
    if (std::isfinite(measure(primitive))) {
      EXPECT_NEAR(measure(image), power * measure(primitive), 1e-11 * measure(image));
    }
  });
}

TEST_P(PrimitiveTest, UvGradientsAreThoseOfDifferences) {
  for_many([](const auto& primitive, Random& random) {
    constexpr double kStep = 1e-7;
    const Vec3d p = middle(primitive) + testing::random_vector(random, 3.0);
    const Uv at = uv(primitive, p);
    const Vec3d direction = random.direction();
    const Uv forward = uv(primitive, p + kStep * direction);
    const Uv backward = uv(primitive, p - kStep * direction);
    const double steepness = 1.0 + norm(at.grad_u) + norm(at.grad_v);
    const double du = (forward.u - backward.u) / (2.0 * kStep);
    const double dv = (forward.v - backward.v) / (2.0 * kStep);
    if (std::abs(du) < 1e3 * steepness) {  // not across a seam
      EXPECT_NEAR(du, dot(at.grad_u, direction), 1e-5 * steepness * steepness);
    }
    if (std::abs(dv) < 1e3 * steepness) {
      EXPECT_NEAR(dv, dot(at.grad_v, direction), 1e-5 * steepness * steepness);
    }
  });
}

TEST_P(PrimitiveTest, UvEnclosureContainsEverySample) {
  for_many([](const auto& primitive, Random& random) {
    const Vec3d corner = middle(primitive) + testing::random_vector(random, 2.0);
    Aabb box{corner, corner};
    box.include(corner + testing::random_vector(random, testing::log_uniform(random, 1e-3, 3.0)));
    const auto [u, v] = enclose_uv(primitive, box);
    for (int i = 0; i < 60; ++i) {
      Vec3d p = box.corner(i);
      if (i >= 8) {
        for (std::size_t k = 0; k < 3; ++k) p[k] = random.uniform(box.min[k], box.max[k]);
      }
      const Uv at = uv(primitive, p);
      EXPECT_TRUE(u.contains(at.u)) << at.u << " not in " << u.lo << ", " << u.hi;
      EXPECT_TRUE(v.contains(at.v)) << at.v << " not in " << v.lo << ", " << v.hi;
    }
  });
}

std::string kind_name(const ::testing::TestParamInfo<std::size_t>& kind) {
  constexpr std::array<const char*, 5> kNames{"point", "segment", "arc", "triangle", "plane"};
  return kNames[kind.param];
}
/// Also where it tells that there are none: gradients then turn by no more than that.
TEST_P(PrimitiveTest, UvBendsHoldForDifferencesOfGradients) {
  int bounded = 0;
  for_many([&](const auto& primitive, Random& random) {
    const Vec3d corner = middle(primitive) + testing::random_vector(random, 2.0);
    Aabb box{corner, corner};
    box.include(corner + testing::random_vector(random, testing::log_uniform(random, 1e-3, 0.5)));
    const UvBends bends = bound_uv_bends(primitive, box);
    for (int i = 0; i < 20; ++i) {
      const auto within = [&](std::size_t axis) {
        return box.min[axis] + random.uniform() * (box.max[axis] - box.min[axis]);
      };
      const Vec3d p{within(0), within(1), within(2)}, q{within(0), within(1), within(2)};
      const Uv at_p = uv(primitive, p), at_q = uv(primitive, q);
      const double noise = 1e-9 * (1 + norm(at_p.grad_u) + norm(at_p.grad_v));
      EXPECT_LE(norm(at_p.grad_u - at_q.grad_u), bends.u * norm(p - q) + noise);
      EXPECT_LE(norm(at_p.grad_v - at_q.grad_v), bends.v * norm(p - q) + noise);
    }
    bounded += std::isfinite(bends.u) && std::isfinite(bends.v) ? 1 : 0;
  });
  EXPECT_GT(bounded, 30);
}

INSTANTIATE_TEST_SUITE_P(All, PrimitiveTest, ::testing::Range<std::size_t>(0, 5), kind_name);

TEST(Primitive, MeasuresAreLengthsAndAreas) {
  EXPECT_EQ(measure(Point{}), 1.0);
  EXPECT_EQ(measure(Segment{{0, 0, 0}, {3, 4, 0}}), 5.0);
  EXPECT_EQ(measure(Triangle{{Vec3d{0, 0, 0}, Vec3d{3, 0, 0}, Vec3d{0, 4, 0}}}), 6.0);
  EXPECT_NEAR(measure(make_arc({}, 2.0, {0, 0, 1}, 30.0, 90.0)), kPi, 1e-15);
  EXPECT_TRUE(std::isinf(measure(Plane{})));
}

TEST(Primitive, SegmentUvIsItsParameterAndAngle) {
  const Segment segment{{0, 0, 0}, {0, 0, 2}};
  const Uv at = uv(segment, {0, 3, 0.5});
  EXPECT_EQ(at.u, 0.25);
  EXPECT_EQ(at.v, 0.25);  // a quarter turn from x
  expect_near(at.grad_u, {0, 0, 0.5}, 1e-16);
  EXPECT_EQ(uv(segment, {1, 0, -3}).u, 0.0);
  EXPECT_EQ(uv(segment, {1, 0, 7}).u, 1.0);
}

TEST(Primitive, ArcUvSplitsTheRestOfTheCircleAtItsMiddle) {
  const Arc arc = make_arc({}, 1.0, {0, 0, 1}, 0.0, 90.0);
  EXPECT_NEAR(uv(arc, {1, 1, 0}).u, 0.5, 1e-15);
  EXPECT_EQ(uv(arc, {1, -0.2, 0}).u, 0.0);
  EXPECT_EQ(uv(arc, {-0.2, 1, 0}).u, 1.0);
  EXPECT_EQ(uv(arc, {-1, -0.99, 0}).u, 1.0);
  EXPECT_EQ(uv(arc, {-0.99, -1, 0}).u, 0.0);
  EXPECT_NEAR(uv(arc, {2, 0, 0}).v, 0.0, 1e-15);    // outward
  EXPECT_NEAR(uv(arc, {1, 0, 1}).v, 0.25, 1e-15);   // along the normal
  EXPECT_NEAR(uv(arc, {0.5, 0, 0}).v, 0.5, 1e-15);  // inward
}

TEST(Primitive, ArcsFollowTheFrameRule) {
  // Angles count from world x about the normal, counter-clockwise seen against it.
  const Arc up = make_arc({}, 1.0, {0, 0, 2}, 0.0, 90.0);
  expect_near(sample(up, 0.0, 0.0), {1, 0, 0}, 1e-15);
  expect_near(sample(up, 1.0, 0.0), {0, 1, 0}, 1e-15);
  const Arc down = make_arc({}, 1.0, {0, 0, -1}, 0.0, 90.0);
  expect_near(sample(down, 1.0, 0.0), {0, -1, 0}, 1e-15);
  // A normal along x: angles count from world y.
  const Arc side = make_arc({}, 1.0, {1, 0, 0}, 0.0, 90.0);
  expect_near(sample(side, 0.0, 0.0), {0, 1, 0}, 1e-15);
  expect_near(sample(side, 1.0, 0.0), {0, 0, 1}, 1e-15);
  const Arc tilted = make_arc({}, 1.0, {1, 0, 1}, 0.0, 10.0);
  const double h = std::sqrt(0.5);
  expect_near(sample(tilted, 0.0, 0.0), {h, 0, -h}, 1e-15);
}

TEST(Primitive, ArcsOfAWholeTurnAndBackwards) {
  EXPECT_EQ(make_arc({}, 1.0, {0, 0, 1}, 17.0, 360.0).sweep, 2.0 * kPi);
  EXPECT_EQ(make_arc({}, 1.0, {0, 0, 1}, 17.0, 1000.0).sweep, 2.0 * kPi);
  const Arc backwards = make_arc({}, 1.0, {0, 0, 1}, 0.0, -90.0);
  expect_near(middle(backwards), {std::sqrt(0.5), -std::sqrt(0.5), 0}, 1e-15);
}

TEST(Primitive, ArchesPassThroughTheirPoints) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const Vec3d p1 = testing::random_vector(random, 2.0);
    const Vec3d p2 = testing::random_vector(random, 2.0);
    const Vec3d p3 = testing::random_vector(random, 2.0);
    const auto arch = make_arch(p1, p2, p3);
    ASSERT_TRUE(arch);
    const Arc& arc = std::get<Arc>(*arch);
    const double tolerance = 1e-14 * (arc.radius + 10.0);
    expect_near(sample(arc, 0.0, 0.0), p1, tolerance);
    expect_near(sample(arc, 1.0, 0.0), p3, tolerance);
    EXPECT_LE(distance(arc, p2), tolerance);
    EXPECT_NEAR(dot(cross(arc.ex, arc.ey), arc.normal), 1.0, 1e-14);
  }
}

TEST(Primitive, ArchesOfCollinearPointsAreSegmentsOrNothing) {
  const Vec3d a{0, 0, 0}, b{1, 2, 3}, c{3, 6, 9};
  ASSERT_TRUE(make_arch(a, b, c));
  EXPECT_TRUE(std::holds_alternative<Segment>(*make_arch(a, b, c)));
  EXPECT_FALSE(make_arch(a, c, b));
  EXPECT_FALSE(make_arch(a, b, a));
  EXPECT_TRUE(std::holds_alternative<Arc>(*make_arch(a, b + Vec3d{1e-6, 0, 0}, c)));
}

TEST(Primitive, PlanesAcrossAnAxisAreBoundedAlongIt) {
  const Aabb flat = bounds(Plane{{1, 2, 3}, {0, 0, -1}});
  EXPECT_EQ(flat.min.z, 3.0);
  EXPECT_EQ(flat.max.z, 3.0);
  EXPECT_TRUE(std::isinf(flat.min.x) && std::isinf(flat.max.y));
  EXPECT_FALSE(std::isfinite(bounds(Plane{{}, normalized(Vec3d{1, 0, 1})}).min.z));
}

TEST(Primitive, PlanesFollowAnyAffineMap) {
  const Affine map =
      Affine::translate({1, 2, 3}) * Affine::scale({1, -2, 5}) * Affine::rotate({1, 1, 0}, 40.0);
  const Plane plane{{0.5, 0, 0}, normalized(Vec3d{1, 2, 3})};
  const Plane image = transformed(plane, map);
  for (int i = 0; i < 20; ++i) {
    const Vec3d q = sample(plane, 0.05 * i, 0.31 * i);
    EXPECT_LE(distance(image, map(q)), 1e-12);
  }
  // The side that the normal points to goes along.
  const Vec3d above = map(plane.point + plane.normal);
  EXPECT_GT(dot(above - image.point, image.normal), 0.0);
}

TEST(Primitive, ArcsRefuseMapsThatAreNoSimilarity) {
  EXPECT_THROW(transformed(make_arc({}, 1.0, {0, 0, 1}, 0.0, 90.0), Affine::scale({1, 2, 1})),
               ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
