// Bounds by distance hold everywhere: value, gradient and curvature of the field never exceed them.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libfield/integral/bound.h"
#include "libfield/integral/integral.h"
#include "tests/property/random_primitives.h"

namespace cs2mesh {
namespace {

struct Case {
  Kernel kernel;
  Primitive primitive;
  Vec3d p;
  double length;  ///< over which the kernel falls
};

/// Where a primitive of that kind is nearest to a point in all its length, so that bounds have no
/// room: beside its middle.
Vec3d beside_middle(Random& random, const Primitive& primitive, double distance) {
  const Vec3d middle_of = std::visit([](const auto& p) { return middle(p); }, primitive);
  Vec3d away = random.direction();
  if (const auto* segment = std::get_if<Segment>(&primitive)) {
    away = cross(segment->b - segment->a, away);
  } else if (const auto* arc = std::get_if<Arc>(&primitive)) {
    away = cross(arc->ey, away);
  } else if (const auto* triangle = std::get_if<Triangle>(&primitive)) {
    away = area_vector(*triangle);
  }
  return middle_of + distance * normalized(away);
}

Case random_case(std::uint64_t seed) {
  Random random(seed);
  const std::size_t kernel = random.bits() % kAllKernels.size();
  const std::size_t primitive = random.bits() % testing::kPrimitiveKinds;
  const double size = testing::log_uniform(random, 0.05, 10.0);
  const double length = testing::log_uniform(random, 0.05, 3.0);
  Case c{testing::random_kernel(random, kAllKernels[kernel], length),
         testing::random_primitive(random, primitive, size),
         {},
         length};
  c.p = random.bits() % 2 == 0
            ? testing::random_near(random, c.primitive, size, 3.0 * length)
            : beside_middle(random, c.primitive, testing::log_uniform(random, 0.1, 3.0) * length);
  return c;
}

template <class Test>
void visit_case(const Case& c, const Test& test) {
  std::visit(
      [&](const auto& kernel, const auto& primitive) {
        using K = std::decay_t<decltype(kernel)>;
        using P = std::decay_t<decltype(primitive)>;
        if constexpr (kHasField<K, P>) test(kernel, primitive);
      },
      c.kernel, c.primitive);
}

/// The norm, where squares would underflow too.
double size_of(const Vec3d& v) {
  const double most = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return most > 0 ? most * norm(v / most) : 0.0;
}

/// Divided differences of the gradient are means of the derivatives in between.
template <class K, class P>
void check_differences(const K& kernel, const P& primitive, const Case& c, double d,
                       const Vec3d& way) {
  const double step = 0.02 * std::min(d, c.length);
  std::array<Vec3d, 4> gradient;
  double most = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double t = (static_cast<double>(i) - 1.5) * step;
    gradient[i] = integral(kernel, primitive, c.p + t * way).gradient;
    most = std::max(most, size_of(gradient[i]));
  }
  const Vec3d third = (gradient[2] - gradient[1]) - (gradient[1] - gradient[0]);
  const Vec3d fourth = ((gradient[3] - gradient[2]) - (gradient[2] - gradient[1])) - third;
  const double noise = 1e-11 * most + 1e-300;
  const double near = std::max(0.0, d - 1.5 * step);
  RC_ASSERT(size_of(third) <= derivative_bound(kernel, primitive, 3, near) * step * step + noise);
  RC_ASSERT(size_of(fourth) <=
            derivative_bound(kernel, primitive, 4, near) * step * step * step + noise);
}

void check_at_distance(std::uint64_t seed) {
  const Case c = random_case(seed);
  visit_case(c, [&](const auto& kernel, const auto& primitive) {
    const double d = distance(primitive, c.p) * (1.0 - 1e-12);
    if (!(d > 1e-4)) return;
    const Jet jet = integral(kernel, primitive, c.p);
    // Subnormal numbers have too few digits for the relative part.
    constexpr double kTiny = 1e-300;
    RC_ASSERT(jet.value <= derivative_bound(kernel, primitive, 0, d) * (1.0 + 1e-11) + kTiny);
    RC_ASSERT(size_of(jet.gradient) <=
              derivative_bound(kernel, primitive, 1, d) * (1.0 + 1e-11) + kTiny);
    // Differences of the gradient along a direction, over points at least d - step away.
    Random random(seed, 1);
    const double step = 1e-4 * std::min(d, c.length);
    const Vec3d direction = random.direction();
    const Vec3d ahead = integral(kernel, primitive, c.p + step * direction).gradient;
    const Vec3d behind = integral(kernel, primitive, c.p - step * direction).gradient;
    const double curvature = size_of(ahead - behind) / (2.0 * step);
    const double noise = 1e-11 * size_of(jet.gradient) / step;
    const double bound = derivative_bound(kernel, primitive, 2, d - step);
    RC_ASSERT(curvature <= bound * (1.0 + 1e-6) + noise + kTiny);
    if (seed % 3 == 0) check_differences(kernel, primitive, c, d, random.direction());
  });
}

RC_GTEST_PROP(Bound, HoldsAtTheDistanceOfThePoint, (std::uint64_t seed)) {
  for (std::uint64_t i = 0; i < 100; ++i) check_at_distance(mix64(seed) + i);
}

void check_fall(std::uint64_t seed) {
  const Case c = random_case(seed);
  Random random(seed, 2);
  std::visit(
      [&](const auto& kernel, const auto& primitive) {
        for (int order = 0; order <= 4; ++order) {
          const double near = testing::log_uniform(random, 1e-3, 10.0);
          const double far = near * (1.0 + testing::log_uniform(random, 1e-6, 1.0));
          // Subnormal numbers have too few digits for the relative part.
          RC_ASSERT(derivative_bound(kernel, primitive, order, far) <=
                    derivative_bound(kernel, primitive, order, near) * (1.0 + 1e-10) + 1e-307);
        }
      },
      c.kernel, c.primitive);
}

RC_GTEST_PROP(Bound, FallsWithDistance, (std::uint64_t seed)) {
  for (std::uint64_t i = 0; i < 100; ++i) check_fall(mix64(seed) + i);
}

RC_GTEST_PROP(Bound, IsAtMostMeasureTimesEnvelope, (std::uint64_t seed)) {
  const Case c = random_case(seed);
  visit_case(c, [&](const auto& kernel, const auto& primitive) {
    for (int order = 0; order <= 4; ++order) {
      const double d = 0.3 * c.length;
      const double crude = measure(primitive) * kernel.derivative_envelope(order, d);
      RC_ASSERT(derivative_bound(kernel, primitive, order, d) <= crude * (1.0 + 1e-10));
    }
  });
}

TEST(Bound, VanishesFarAway) {
  for (const KernelKind kind : kAllKernels) {
    for (std::size_t i = 0; i < testing::kPrimitiveKinds; ++i) {
      Random random(i);
      const Case c{testing::random_kernel(random, kind, 0.5),
                   testing::random_primitive(random, i, 1.0), Vec3d{}, 0.5};
      visit_case(c, [&](const auto& kernel, const auto& primitive) {
        for (const double far : {1e20, 1e100, 1e200, HUGE_VAL}) {
          for (int order = 0; order <= 4; ++order) {
            const double bound = derivative_bound(kernel, primitive, order, far);
            EXPECT_GE(bound, 0.0) << name_of(kind) << " " << far;
            EXPECT_LE(bound, 1e-18) << name_of(kind) << " " << far;
          }
        }
      });
    }
  }
}

// Where p is beside the middle of a long segment or over the middle of a large triangle the worst
// case is attained: the bound is of the size of the field there.
TEST(Bound, IsTightForLargePrimitives) {
  const Segment segment{{-50, 0, 0}, {50, 0, 0}};
  const Triangle triangle{{Vec3d{-50, -30, 0}, Vec3d{50, -30, 0}, Vec3d{0, 60, 0}}};
  const Arc arc = make_arc({0, 0, 0}, 30.0, {0, 0, 1}, 0.0, 300.0);
  for (const KernelKind kind : kAllKernels) {
    const bool inverse_width = kind == KernelKind::cauchy || kind == KernelKind::gaussian;
    const Kernel kernel = make_kernel(kind, inverse_width ? 1.0 : 2.0, 1.0, 0.0, 0.0);
    std::visit(
        [&](const auto& k) {
          for (const double d : {0.2, 1.0}) {
            const auto ratio = [&](const auto& primitive, const Vec3d& p) {
              return derivative_bound(k, primitive, 0, d) / integral(k, primitive, p).value;
            };
            EXPECT_LE(ratio(segment, {0, d, 0}), 1.25) << name_of(kind) << " " << d;
            EXPECT_LE(ratio(triangle, {0, 0, d}), 1.6) << name_of(kind) << " " << d;
            EXPECT_LE(ratio(arc, middle(arc) + Vec3d{0, 0, d}), 1.6) << name_of(kind) << " " << d;
          }
        },
        kernel);
  }
}

// The greatest fourth derivatives of the fields of an endless line (45 pi / 2 and 12 sqrt(pi)) and
// of a plane, which bounds by distance alone may exceed.
TEST(Bound, OfFourthOrderIsNotMuchMoreThanTheGreatest) {
  const Segment segment{{-50, 0, 0}, {50, 0, 0}};
  EXPECT_LE(derivative_bound(Cauchy{1.0}, segment, 4, 0.0), 1.45 * 70.686);
  EXPECT_LE(derivative_bound(Gaussian{1.0}, segment, 4, 0.0), 1.55 * 21.269);
  const Triangle triangle{{Vec3d{-50, -30, 0}, Vec3d{50, -30, 0}, Vec3d{0, 60, 0}}};
  const auto ratio = [&](const auto& kernel) {
    return derivative_bound(kernel, triangle, 4, 0.0) / derivative_bound(kernel, Plane{}, 4, 0.0);
  };
  EXPECT_LE(ratio(Cauchy{1.0}), 2.0);
  EXPECT_LE(ratio(Gaussian{1.0}), 2.4);
}

}  // namespace
}  // namespace cs2mesh
