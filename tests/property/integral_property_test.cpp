// Laws that every field obeys, whatever its kernel and primitive: it adds up over parts, moves with
// its primitive, scales and mirrors with it, and its gradient is that of its values.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "libfield/integral/integral.h"
#include "tests/property/random_primitives.h"

namespace cs2mesh {
namespace {

// A relative difference of a jet, measured against its own parts and a slope over `length`.
double difference(const Jet& a, const Jet& b, double length) {
  const double value = std::abs(a.value - b.value);
  const double gradient = norm(a.gradient - b.gradient) * length;
  const double scale = std::abs(b.value) + norm(b.gradient) * length;
  return scale > 0.0 ? (value + gradient) / scale : value + gradient;
}

struct Case {
  Kernel kernel;
  Primitive primitive;
  Vec3d p;
  double length;  ///< over which the kernel falls
};

Case random_case(std::uint64_t seed, std::size_t primitive) {
  Random random(seed);
  const std::size_t kernel = random.bits() % kAllKernels.size();
  const double size = testing::log_uniform(random, 0.05, 5.0);
  const double length = testing::log_uniform(random, 0.1, 3.0);
  Case c{testing::random_kernel(random, kAllKernels[kernel], length),
         testing::random_primitive(random, primitive, size),
         {},
         length};
  c.p = testing::random_near(random, c.primitive, size, 2.0 * length);
  return c;
}

/// Beside the primitive; what rounding of the inputs does to the result grows towards it and, for
/// kernels that fall steeply, away from it.
template <class P>
bool well_conditioned(const P& primitive, const Case& c) {
  const double d = distance(primitive, c.p);
  const double support =
      std::visit([](const auto& k) { return std::min(k.support(), 1e300); }, c.kernel);
  return d > 1e-3 * c.length && d < 6.0 * c.length && std::abs(d - support) > 1e-2 * c.length;
}

template <class P>
Jet field(const Kernel& kernel, const P& primitive, const Vec3d& p) {
  return std::visit(
      [&](const auto& k) -> Jet {
        if constexpr (!kHasField<std::decay_t<decltype(k)>, P>) {
          return {};
        } else {
          return integral(k, primitive, p);
        }
      },
      kernel);
}

constexpr double kTolerance = 1e-10;

RC_GTEST_PROP(Superposition, ASegmentIsItsHalves, (std::uint64_t seed)) {
  const Case c = random_case(seed, 1);
  const auto& whole = std::get<Segment>(c.primitive);
  if (!well_conditioned(whole, c)) return;
  const Vec3d cut = middle(whole);
  Jet sum = field(c.kernel, Segment{whole.a, cut}, c.p);
  sum += field(c.kernel, Segment{cut, whole.b}, c.p);
  RC_ASSERT(difference(sum, field(c.kernel, whole, c.p), c.length) < kTolerance);
}

RC_GTEST_PROP(Superposition, AnArcIsItsThirds, (std::uint64_t seed)) {
  const Case c = random_case(seed, 2);
  const auto& whole = std::get<Arc>(c.primitive);
  if (!well_conditioned(whole, c)) return;
  Jet sum;
  for (int i = -1; i <= 1; ++i) {
    Arc third = whole;
    third.sweep = whole.sweep / 3.0;
    const double turn = i * third.sweep;
    third.ex = std::cos(turn) * whole.ex + std::sin(turn) * whole.ey;
    third.ey = std::cos(turn) * whole.ey - std::sin(turn) * whole.ex;
    sum += field(c.kernel, third, c.p);
  }
  RC_ASSERT(difference(sum, field(c.kernel, whole, c.p), c.length) < kTolerance);
}

RC_GTEST_PROP(Superposition, ATriangleIsItsFourQuarters, (std::uint64_t seed)) {
  const Case c = random_case(seed, 3);
  const auto& whole = std::get<Triangle>(c.primitive);
  const double slenderness = size(whole) * size(whole) / measure(whole);
  if (!well_conditioned(whole, c) || slenderness > 1e3) return;
  const auto& v = whole.vertex;
  const std::array<Vec3d, 3> m{0.5 * (v[0] + v[1]), 0.5 * (v[1] + v[2]), 0.5 * (v[2] + v[0])};
  Jet sum = field(c.kernel, Triangle{{m[0], m[1], m[2]}}, c.p);
  sum += field(c.kernel, Triangle{{v[0], m[0], m[2]}}, c.p);
  sum += field(c.kernel, Triangle{{m[0], v[1], m[1]}}, c.p);
  sum += field(c.kernel, Triangle{{m[2], m[1], v[2]}}, c.p);
  RC_ASSERT(difference(sum, field(c.kernel, whole, c.p), c.length) < kTolerance);
}

/// A kernel of the same amplitude whose lengths are `factor` times as long.
Kernel stretched(const Kernel& kernel, double factor) {
  Kernel result = kernel;
  std::visit(
      [&](auto& k) {
        using K = std::decay_t<decltype(k)>;
        if constexpr (std::is_same_v<K, Cauchy>) k.s /= factor;
        if constexpr (std::is_same_v<K, Gaussian>) k.a /= factor;
        if constexpr (std::is_same_v<K, Inverse>) k.amplitude *= factor;
        if constexpr (std::is_same_v<K, Squared>) k.amplitude *= factor * factor;
        if constexpr (requires { k.radius; }) k.radius *= factor;
      },
      result);
  return result;
}

void check_similarity(std::uint64_t seed, double factor, bool mirrored) {
  Random random(seed, 3);
  const Case c = random_case(seed, random.bits() % testing::kPrimitiveKinds);
  const Affine map = testing::random_similarity(random, factor, mirrored);
  std::visit(
      [&](const auto& primitive) {
        using P = std::decay_t<decltype(primitive)>;
        if (!well_conditioned(primitive, c)) return;
        if constexpr (std::is_same_v<P, Triangle>) {
          if (size(primitive) * size(primitive) > 1e3 * measure(primitive)) return;
        }
        const Jet here = field(c.kernel, primitive, c.p);
        const Jet there = field(stretched(c.kernel, factor), transformed(primitive, map), map(c.p));
        const double power = std::pow(factor, P::kDimension);
        const Vec3d turned = (map.linear * here.gradient) / (factor * factor);
        const Jet expected{power * here.value, power * turned};
        RC_ASSERT(difference(there, expected, factor * c.length) < kTolerance);
      },
      c.primitive);
}

RC_GTEST_PROP(Similarity, FieldsMoveWithTheirPrimitive, (std::uint64_t seed)) {
  check_similarity(seed, 1.0, false);
}
RC_GTEST_PROP(Similarity, FieldsMirrorWithTheirPrimitive, (std::uint64_t seed)) {
  check_similarity(seed, 1.0, true);
}
RC_GTEST_PROP(Similarity, FieldsScaleWithTheirPrimitive, (std::uint64_t seed)) {
  Random random(seed, 4);
  check_similarity(seed, testing::log_uniform(random, 0.01, 100.0), false);
}

RC_GTEST_PROP(Gradient, IsThatOfTheValues, (std::uint64_t seed)) {
  Random random(seed, 5);
  const Case c = random_case(seed, random.bits() % testing::kPrimitiveKinds);
  std::visit(
      [&](const auto& primitive) {
        if (!well_conditioned(primitive, c)) return;
        const double step = 1e-4 * std::min(c.length, distance(primitive, c.p));
        const Vec3d direction = random.direction();
        const Jet at = field(c.kernel, primitive, c.p);
        const double ahead = field(c.kernel, primitive, c.p + step * direction).value;
        const double behind = field(c.kernel, primitive, c.p - step * direction).value;
        const double slope = (ahead - behind) / (2.0 * step);
        const double scale = at.value / (1e4 * step) + norm(at.gradient);
        RC_ASSERT(std::abs(slope - dot(at.gradient, direction)) <= 1e-5 * scale);
      },
      c.primitive);
}

RC_GTEST_PROP(Quadrature, AgreesWithTheClosedForms, (std::uint64_t seed)) {
  Random random(seed, 6);
  const Case c = random_case(seed, 1 + random.bits() % 3);
  std::visit(
      [&](const auto& kernel, const auto& primitive) {
        if constexpr (requires { quadrature(kernel, primitive, c.p); }) {
          if (!(measure(primitive) > 1e-6) || !well_conditioned(primitive, c)) return;
          const Jet exact = integral(kernel, primitive, c.p);
          RC_ASSERT(difference(quadrature(kernel, primitive, c.p), exact, c.length) < kTolerance);
          // A loose tolerance is cheaper, not wild.
          const Jet rough = quadrature(kernel, primitive, c.p, 1e-6);
          RC_ASSERT(difference(rough, exact, c.length) < 1e-6);
        }
      },
      c.kernel, c.primitive);
}

TEST(Limit, ArcsOfHugeRadiusAreSegments) {
  constexpr double kRadius = 1e6;
  const double length = 1.5;
  Arc arc;
  arc.radius = kRadius;
  arc.sweep = length / kRadius;
  arc.center = {-kRadius, 0, 0};
  const Segment segment{{0, -0.5 * length, 0}, {0, 0.5 * length, 0}};
  for (const KernelKind kind : kAllKernels) {
    Random random(1);
    const Kernel kernel = testing::random_kernel(random, kind, 0.5);
    for (int i = 0; i < 20; ++i) {
      const Vec3d p = Vec3d{0.3, 0.0, 0.0} + testing::random_vector(random, 0.25);
      EXPECT_LT(difference(field(kernel, arc, p), field(kernel, segment, p), 0.5), 1e-5)
          << name_of(kind);
    }
  }
}

TEST(Limit, ThinTrianglesAreWeightedSegments) {
  // Of height eps over a base of length 2, its chords shrink linearly: half of eps on average, and
  // mirrored about the middle the weights add up to a constant.
  constexpr double kHeight = 1e-5;
  const Triangle left{{Vec3d{-1, 0, 0}, Vec3d{1, 0, 0}, Vec3d{-1, kHeight, 0}}};
  const Triangle right{{Vec3d{1, 0, 0}, Vec3d{-1, 0, 0}, Vec3d{1, kHeight, 0}}};
  const Segment segment{{-1, 0, 0}, {1, 0, 0}};
  for (const KernelKind kind : kAllKernels) {
    Random random(2);
    const Kernel kernel = testing::random_kernel(random, kind, 0.5);
    for (int i = 0; i < 20; ++i) {
      const Vec3d p = Vec3d{0.1, 0.2, 0.4} + testing::random_vector(random, 0.2);
      Jet sum = field(kernel, left, p);
      sum += field(kernel, right, p);
      const Jet expected = kHeight * field(kernel, segment, p);
      EXPECT_LT(difference(sum, expected, 0.5), 1e-3) << name_of(kind);
    }
  }
}

TEST(Finite, OnThePrimitiveAndFarAway) {
  for (const KernelKind kind : kAllKernels) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      Random random(seed);
      Kernel kernel = testing::random_kernel(random, kind, 0.5);
      std::visit(
          [](auto& k) {
            if constexpr (requires { k.clamp; }) k.clamp = 1e-6;
          },
          kernel);
      const Primitive primitive = testing::random_primitive(random, seed % 5, 1.0);
      std::visit(
          [&](const auto& p) {
            for (const double far : {0.0, 1e-300, 1e-17, 1e-9, 1e3, 1e9, 1e60}) {
              const Jet jet = field(kernel, p, middle(p) + far * random.direction());
              EXPECT_TRUE(std::isfinite(jet.value) && is_finite(jet.gradient))
                  << name_of(kind) << " primitive " << seed % 5 << " at " << far;
              EXPECT_GE(jet.value, 0.0);
            }
          },
          primitive);
    }
  }
}

TEST(Clamp, InverseKernelsAreFlatCloserThanIt) {
  const Segment segment{{-1, 0, 0}, {1, 0, 0}};
  const Inverse kernel{1.0, 1e-3};
  const Jet on_it = integral(kernel, segment, Vec3d{0.25, 0, 0});
  const Jet at_clamp = integral(Inverse{1.0, 0.0}, segment, Vec3d{0.25, 1e-3, 0});
  EXPECT_NEAR(on_it.value, at_clamp.value, 1e-12 * at_clamp.value);
  EXPECT_EQ(on_it.gradient, Vec3d{});
}

}  // namespace
}  // namespace cs2mesh
