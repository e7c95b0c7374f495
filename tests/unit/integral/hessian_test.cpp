// Second derivatives of fields: against the differentiated kernel integrated in extended precision,
// against the closed forms in 100 digits, and against laws.

#include "libfield/integral/hessian.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>

#include "libfield/base/random.h"
#include "tests/property/random_primitives.h"
#include "tests/unit/integral/cases.h"
#include "tests/unit/integral/hessian_oracle.h"
#include "tests/unit/integral/wide.h"

namespace cs2mesh {
namespace {

using cases::ArcCase;
using cases::SegmentCase;
using cases::TriangleCase;
using hessian_oracle::Matrix;
using hessian_oracle::Real;
using hessian_oracle::Vector;
using wide::Wide;

/// In units of what moving the inputs by one part in 2^52 does.
constexpr double kLimit = 64.0;

template <class T>
double difference(const Symmetric3& h, const SymmetricOf<T>& exact) {
  const SymmetricOf<T> off{h.xx - exact.xx, h.yy - exact.yy, h.zz - exact.zz,
                           h.xy - exact.xy, h.xz - exact.xz, h.yz - exact.yz};
  return static_cast<double>(norm(off));
}

/// A point, and one near or far from it.
struct PointCase {
  Point primitive;
  Vec3d point;
  double per_width, scale, condition = 1.0;

  explicit PointCase(Random& random) {
    const cases::Setting setting(random);
    per_width = setting.per_width;
    primitive = {setting.origin};
    point = setting.origin + setting.distance * random.direction();
    scale = setting.distance > 0 ? norm(point - setting.origin) : setting.size;
  }
};

/// The kernel for a configuration, where there is something to compare: a Gaussian neither cut off
/// nor vanished, whose amplitude's logarithm rounds as an error of the exponent.
template <class K, class Case>
K kernel_for(Case& sample) {
  if constexpr (std::is_same_v<K, Cauchy>) {
    return {sample.per_width};
  } else if constexpr (std::is_same_v<K, Gaussian>) {
    const double d = distance(sample.primitive, sample.point);
    const double a = std::min(sample.per_width, 25.0 / std::max(d, 1e-4 * sample.scale));
    const double log_amplitude = std::min(500.0, 0.5 * a * a * d * d);
    sample.condition *= std::max(1.0, log_amplitude);
    return {a, log_amplitude};
  } else if constexpr (detail::kIsInverse<K>) {
    return {};
  } else {
    return {1.0 / sample.per_width};
  }
}

/// The norm of the third derivative, from differences over a small part of the kernel's reach;
/// that along one direction stands for all where the oracle takes its time.
template <class K, class Case>
double third_derivative(const K& kernel, const Case& sample, const Matrix& exact, Random& random) {
  const double width = kernel.length_scale() > 0 ? kernel.length_scale() : sample.scale;
  const double near = std::max(distance(sample.primitive, sample.point), 1e-8 * sample.scale);
  const Real step = 1e-4L * std::min({near, sample.scale, width});
  const auto along = [&](const Vector& direction) {
    const Vector moved = Vector(sample.point) + step * direction;
    const Matrix there = hessian_oracle::exact(kernel, sample.primitive, moved).matrix;
    return norm(Matrix(there - exact)) / step;
  };
  if constexpr (std::is_same_v<Case, TriangleCase>) {
    return std::sqrt(3.0) * static_cast<double>(along(Vector(random.direction())));
  } else {
    return static_cast<double>(std::hypot(along({1, 0, 0}), along({0, 1, 0}), along({0, 0, 1})));
  }
}

template <class K, class Case>
double backward_error(Case sample, Random& random) {
  const K kernel = kernel_for<K>(sample);
  const Symmetric3 found = hessian(kernel, sample.primitive, sample.point);
  const Matrix exact = hessian_oracle::exact(kernel, sample.primitive, Vector(sample.point)).matrix;
  const double off = difference(found, exact);
  if (!(off > 1e-290)) return std::isnan(off) ? HUGE_VAL : 0.0;
  const double moved = third_derivative(kernel, sample, exact, random) * sample.scale;
  return off / (2.2e-16 * (sample.condition * static_cast<double>(norm(exact)) + moved));
}

/// Configurations that extended precision resolves well enough, and where there is something.
template <class K, class Case>
bool is_telling(const Case& sample) {
  const double d = distance(sample.primitive, sample.point);
  constexpr bool kHasSupport = detail::kIsPolynomial<K> || std::is_same_v<K, Metaball>;
  if (kHasSupport && d * sample.per_width >= 1.0) return false;
  if (detail::kIsInverse<K> && !(d > 1e-7 * sample.scale)) return false;
  if constexpr (std::is_same_v<Case, TriangleCase>) {
    const double finest = detail::kIsInverse<K> ? d : std::max(d, 1.0 / sample.per_width);
    return sample.scale < 300.0 * finest;
  }
  return true;
}

template <class K, class Case>
void expect_exact(const char* shape, int count) {
  double worst = 0.0;
  for (int i = 0; i < count; ++i) {
    Random random(31, static_cast<std::uint64_t>(i));
    Case sample(random);
    while (!is_telling<K>(sample)) sample = Case(random);
    const double error = backward_error<K>(sample, random);
    EXPECT_LE(error, kLimit) << name_of(K::kKind) << " " << shape << " " << i;
    worst = std::max(worst, error);
  }
  std::printf("%s %s: worst %.2f ulp\n", std::string(name_of(K::kKind)).c_str(), shape, worst);
}

template <class Case>
void expect_all_exact(const char* shape, int count) {
  expect_exact<Cauchy, Case>(shape, count);
  expect_exact<Gaussian, Case>(shape, count);
  expect_exact<Inverse, Case>(shape, count);
  expect_exact<Squared, Case>(shape, count);
  expect_exact<Metaball, Case>(shape, count);
  expect_exact<Soft, Case>(shape, count);
  expect_exact<Quartic, Case>(shape, count);
}

TEST(Hessian, OfPointsIsExactForInputsMovedByAFewUlp) {
  expect_all_exact<PointCase>("point", 200);
}

TEST(Hessian, OfSegmentsIsExactForInputsMovedByAFewUlp) {
  expect_all_exact<SegmentCase>("segment", 120);
}

TEST(Hessian, OfArcsIsExactForInputsMovedByAFewUlp) {
  expect_all_exact<ArcCase>("arc", 30);
}

TEST(Hessian, OfTrianglesIsExactForInputsMovedByAFewUlp) {
  expect_all_exact<TriangleCase>("triangle", 6);
}

/// Central differences of the closed form's gradient in 100 digits, which know nothing of K'.
template <class K, class P>
SymmetricOf<Wide> differences(const K& kernel, const P& primitive, const Vec3d& p, double scale) {
  const Wide step = Wide(scale) * Wide("1e-25");
  std::array<Vec3<Wide>, 3> row;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3<Wide> before(p), after(p);
    before[axis] -= step, after[axis] += step;
    row[axis] = (integral(kernel, primitive, after).gradient -
                 integral(kernel, primitive, before).gradient) /
                Wide(2 * step);
  }
  return {row[0].x, row[1].y, row[2].z, row[0].y, row[0].z, row[1].z};
}

template <class K, class P>
void expect_slope_of_gradient(const K& kernel, const P& primitive, const Vec3d& p, double scale) {
  const SymmetricOf<Wide> exact = differences(kernel, primitive, p, scale);
  const auto size = static_cast<double>(norm(exact));
  EXPECT_LE(difference(hessian(kernel, primitive, p), exact), 1e-13 * size)
      << name_of(K::kKind) << " at " << p.x << ", " << p.y << ", " << p.z;
}

TEST(Hessian, IsTheSlopeOfTheGradientIn100Digits) {
  const Segment segment{{0, 0.125, 0}, {1, 0.5, 0.25}};
  const Arc arc = make_arc({0.25, 0, 0}, 0.75, {0, 0.6, 0.8}, 20, 250);
  const Triangle triangle{{Vec3d{0, 0, 0}, {1, 0.25, 0}, {0.25, 0.75, 0.5}}};
  const Plane plane{{0, 0, 0.125}, {0, 0.6, 0.8}};
  const TaperedSegment tapered{segment, quadratic_weight(1.0, 0.25, -0.5)};
  for (int i = 0; i < 3; ++i) {
    Random random(17, static_cast<std::uint64_t>(i));
    const Vec3d p = testing::random_vector(random, 1.5);
    const auto check = [&](const auto& kernel) {
      using K = std::decay_t<decltype(kernel)>;
      expect_slope_of_gradient(kernel, segment, p, 1.0);
      if constexpr (requires { integral(kernel, arc, Vec3<Wide>(p)); }) {
        expect_slope_of_gradient(kernel, arc, p, 1.0);
      }
      if constexpr (std::is_same_v<K, Cauchy>) expect_slope_of_gradient(kernel, triangle, p, 1.0);
      if constexpr (kHasField<K, TaperedSegment>) {
        expect_slope_of_gradient(kernel, tapered, p, 1.0);
      }
      if constexpr (!detail::kIsInverse<K>) expect_slope_of_gradient(kernel, plane, p, 1.0);
    };
    check(Cauchy{1.5, 0.75});
    check(Gaussian{1.5, 0.25});
    check(Inverse{1.5});
    check(Squared{0.75});
    check(Metaball{2.5, 0.75});
    check(Soft{2.5, 0.75});
    check(Quartic{2.5, 0.75});
  }
}

/// Calls visit(kernel, primitive, p) for random ones of every pair that has a field.
template <class Visit>
void visit_pairs(int rounds, const Visit& visit) {
  for (const KernelKind kind : kAllKernels) {
    for (std::size_t shape = 0; shape < testing::kPrimitiveKinds; ++shape) {
      for (int i = 0; i < rounds; ++i) {
        Random random(3, static_cast<std::uint64_t>(i));
        const Kernel any_kernel = testing::random_kernel(random, kind, 0.8);
        const Primitive any_primitive = testing::random_primitive(random, shape, 1.0);
        const Vec3d p = testing::random_near(random, any_primitive, 1.0, 0.8);
        std::visit(
            [&](const auto& kernel, const auto& primitive) {
              using K = std::decay_t<decltype(kernel)>;
              using P = std::decay_t<decltype(primitive)>;
              if constexpr (kHasField<K, P>) visit(kernel, primitive, p);
            },
            any_kernel, any_primitive);
      }
    }
  }
}

TEST(Hessian, TurnsWithARigidMotion) {
  Random random(5);
  visit_pairs(3, [&](const auto& kernel, const auto& primitive, const Vec3d& p) {
    const Affine motion = testing::random_similarity(random, 1.0, true);
    const Symmetric3 moved = hessian(kernel, transformed(primitive, motion), motion(p));
    const Symmetric3 here = hessian(kernel, primitive, p);
    EXPECT_LE(norm(congruent(moved, motion.linear) - here), 1e-10 * norm(here) + 1e-13)
        << name_of(kernel.kKind);
  });
}

TEST(Hessian, OfAnInverseKernelHasNoTrace) {
  visit_pairs(6, [&](const auto& kernel, const auto& primitive, const Vec3d& p) {
    if constexpr (std::is_same_v<std::decay_t<decltype(kernel)>, Inverse>) {
      const Symmetric3 h = hessian(kernel, primitive, p);
      EXPECT_LE(std::abs(trace(h)), 1e-12 * norm(h));
    }
  });
}

/// Segment, arc and triangle in two parts.
std::array<Segment, 2> halves(const Segment& s) {
  const Vec3d middle = s.a + 0.375 * (s.b - s.a);
  return {Segment{s.a, middle}, {middle, s.b}};
}
std::array<Triangle, 2> halves(const Triangle& t) {
  const Vec3d middle = t.vertex[0] + 0.375 * (t.vertex[1] - t.vertex[0]);
  return {Triangle{{t.vertex[0], middle, t.vertex[2]}}, {{middle, t.vertex[1], t.vertex[2]}}};
}
std::array<Arc, 2> halves(const Arc& arc) {
  std::array<Arc, 2> part{arc, arc};
  for (const std::size_t i : {0U, 1U}) {
    const double turn = (i == 0 ? -0.25 : 0.25) * arc.sweep;
    part[i].sweep = 0.5 * arc.sweep;
    part[i].ex = std::cos(turn) * arc.ex + std::sin(turn) * arc.ey;
    part[i].ey = std::cos(turn) * arc.ey - std::sin(turn) * arc.ex;
  }
  return part;
}

TEST(Hessian, AddsUpOverParts) {
  visit_pairs(6, [&](const auto& kernel, const auto& primitive, const Vec3d& p) {
    if constexpr (requires { halves(primitive); }) {
      const Symmetric3 whole = hessian(kernel, primitive, p);
      Symmetric3 sum;
      double size = norm(whole);
      for (const auto& part : halves(primitive)) {
        const Symmetric3 h = hessian(kernel, part, p);
        sum += h;
        size += norm(h);
      }
      EXPECT_LE(norm(sum - whole), 1e-10 * size) << name_of(kernel.kKind);
    }
  });
}

TEST(Hessian, DeepInsideALargeTriangleIsThatOfThePlane) {
  const Triangle triangle{{Vec3d{-9e4, -8e4, 0}, {1e5, -7e4, 0}, {2e4, 1e5, 0}}};
  const auto expect_plane = [&](const auto& kernel) {
    for (const double z : {0.0, 1e-6, 0.3, -0.7}) {
      const Symmetric3 exact = hessian(kernel, Plane{}, Vec3d{10, -20, z});
      const Symmetric3 found = hessian(kernel, triangle, Vec3d{10, -20, z});
      EXPECT_LE(norm(found - exact), 1e-13 * norm(exact)) << name_of(kernel.kKind) << " " << z;
    }
  };
  expect_plane(Gaussian{1.5});
  expect_plane(Metaball{1.25});
  expect_plane(Soft{1.25});
  expect_plane(Quartic{1.25});
}

TEST(Hessian, CloseToAnInverseTriangleDoesNotGrow) {
  const Triangle triangle{{Vec3d{0, 0, 0}, {2, 0, 0}, {1, 1, 0}}};
  const Symmetric3 at = hessian(Inverse{}, triangle, Vec3d{1, 0.4, 1e-6});
  const Symmetric3 closer = hessian(Inverse{}, triangle, Vec3d{1, 0.4, 1e-11});
  EXPECT_LE(norm(closer - at), 1e-4 * norm(at));
}

TEST(Hessian, VanishesBeyondTheSupportAndWithinTheClamp) {
  const Segment segment{{0, 0, 0}, {2, 0, 0}};
  const Triangle triangle{{Vec3d{0, 0, 0}, {2, 0, 0}, {1, 1, 0}}};
  for (const Vec3d& p : {Vec3d{1, 0.3, 1.001}, Vec3d{1, 0.3, 50}}) {
    EXPECT_EQ(hessian(Soft{1.0}, triangle, p), Symmetric3{});
    EXPECT_EQ(hessian(Quartic{1.0}, segment, p), Symmetric3{});
    EXPECT_EQ(hessian(Metaball{1.0}, Point{{1, 0.3, 0}}, p), Symmetric3{});
    EXPECT_EQ(hessian(Metaball{1.0}, Plane{}, p), Symmetric3{});
  }
  EXPECT_EQ(hessian(Inverse{1.0, 1e-3}, segment, Vec3d{1, 9e-4, 0}), Symmetric3{});
  EXPECT_EQ(hessian(Squared{1.0, 1e-3}, triangle, Vec3d{1, 0.3, 9e-4}), Symmetric3{});
  EXPECT_NE(hessian(Squared{1.0, 1e-3}, triangle, Vec3d{1, 0.3, 2e-3}), Symmetric3{});
}

TEST(Hessian, GivesTheValueAndGradientOfTheIntegral) {
  visit_pairs(2, [&](const auto& kernel, const auto& primitive, const Vec3d& p) {
    const Jet2 jet = second_jet(kernel, primitive, p);
    EXPECT_EQ((Jet{jet.value, jet.gradient}), integral(kernel, primitive, p));
    EXPECT_EQ(jet.hessian, hessian(kernel, primitive, p));
  });
}

template <class K>
void expect_finite(const K& kernel, const Vec3d& p) {
  const Arc turn{{0, 0, 0}, 1.0, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 2.0 * std::numbers::pi};
  const auto check = [&](const auto& primitive) {
    const Symmetric3 h = hessian(kernel, primitive, p);
    EXPECT_TRUE(is_finite(Vec3d{h.xx, h.yy, h.zz}) && is_finite(Vec3d{h.xy, h.xz, h.yz}))
        << name_of(K::kKind) << " at " << p.x << ", " << p.y << ", " << p.z;
  };
  check(Point{{1, 0, 0}});
  check(Segment{{0, 0, 0}, {2, 0, 0}});
  check(Segment{{1, 0, 0}, {1, 0, 0}});
  check(turn);
  check(Triangle{{Vec3d{0, 0, 0}, {2, 0, 0}, {1, 1, 0}}});
  check(Triangle{{Vec3d{0, 0, 0}, {2, 0, 0}, {1, 0, 0}}});
  if constexpr (!detail::kIsInverse<K>) check(Plane{});
}

TEST(Hessian, IsFiniteForEveryFinitePoint) {
  const double reaches[] = {
      0.0, std::numeric_limits<double>::denorm_min(), 1e-160, 1.0, 2.0, 1e8, 1e77, 1e100};
  for (const double x : reaches) {
    for (const double y : reaches) {
      for (const Vec3d& p : {Vec3d{x, y, 0}, Vec3d{-x, 0, y}, Vec3d{y, -x, -y}}) {
        expect_finite(Inverse{}, p);
        expect_finite(Squared{}, p);
        for (const double width : {1e-20, 1.0, 1e20}) {
          expect_finite(Cauchy{width}, p);
          expect_finite(Gaussian{width, 1e4}, p);
          expect_finite(Metaball{1.0 / width}, p);
          expect_finite(Soft{1.0 / width}, p);
          expect_finite(Quartic{1.0 / width}, p);
        }
      }
    }
  }
}

}  // namespace
}  // namespace cs2mesh
