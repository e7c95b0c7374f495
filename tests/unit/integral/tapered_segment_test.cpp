// Weights inside the integral over a segment: against 100 digits, and the laws they obey.

#include "libfield/integral/tapered_segment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>

#include "libfield/integral/bound.h"
#include "libfield/integral/isolation.h"
#include "tests/property/random_primitives.h"
#include "tests/unit/integral/cases.h"
#include "tests/unit/integral/wide.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

using testing::log_uniform;

constexpr double kLimit = 16.0;

/// All sorts: vanishing at an end or at both, constant, with a root between the ends, arbitrary.
SegmentWeight random_weight(Random& random) {
  switch (random.bits() % 8) {
    case 0:
      return linear_weight(0, 1);
    case 1:
      return {1, 0, 0};
    case 2:
      return {0, 0, 1};
    case 3:
      return {0, 1, 0};
    case 4:
      return linear_weight(1, 1);
    case 5:
      return quadratic_weight(1, 0, 1);
    case 6:
      return {random.uniform(), random.uniform(), random.uniform()};
    default:
      return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  }
}

TaperedSegment with_absolute_weight(TaperedSegment segment) {
  SegmentWeight& w = segment.weight;
  w = {std::abs(w.b0), std::abs(w.b1), std::abs(w.b2)};
  return segment;
}

/// Errors in units of what moving the inputs by one part in 2^52 makes of the field with the
/// absolute values of the coefficients.
struct TaperedReference {
  template <class K>
  TaperedReference(const K& kernel, const TaperedSegment& segment, const Vec3d& point, double scale,
                   double condition)
      : exact(wide::exact_field(kernel, segment, point, scale, condition)) {
    const reference::Exact all =
        wide::exact_field(kernel, with_absolute_weight(segment), point, scale, condition);
    const auto slope =
        static_cast<double>(std::hypot(all.gradient[0], all.gradient[1], all.gradient[2]));
    const auto value = static_cast<double>(all.value);
    exact.condition = 0.0;  // all of it is in the conditioning
    conditioning = {condition * value + slope * scale,
                    condition * slope + all.hessian_norm * scale};
  }
  reference::BackwardError error(const Jet& jet) const {
    return reference::backward_error(jet, exact, conditioning);
  }
  reference::Exact exact;
  reference::Conditioning conditioning{};
};

struct Worst {
  double value = 0.0, gradient = 0.0;

  void include(const reference::BackwardError& error) {
    EXPECT_LE(error.value, kLimit);
    EXPECT_LE(error.gradient, kLimit);
    value = std::max(value, error.value);
    gradient = std::max(gradient, error.gradient);
  }
};

/// One point at a time, and in packs with every instruction set.
template <class K>
void check(const K& kernel, const TaperedSegment& segment, const Vec3d& point, double scale,
           double condition, Worst& plain, Worst& packed) {
  const TaperedReference reference(kernel, segment, point, scale, condition);
  const Jet alone = integral(kernel, segment, point);
  plain.include(reference.error(alone));
  const Term term = testing::plain_term(kernel, segment);
  testing::with_every_isa([&](Isa) {
    std::array<Vec3d, 4> points;
    points.fill(point);
    std::array<Jet, 4> jets{};
    accumulate(term, points, jets);
    packed.include(reference.error(jets[3]));
    EXPECT_EQ(jets[3], alone);  // the same bits
  });
}

template <class MakeKernel>
void expect_exact(const char* name, int configurations, const MakeKernel& make_kernel) {
  Worst plain, packed;
  for (int i = 0; i < configurations; ++i) {
    Random random(7, static_cast<std::uint64_t>(i));
    cases::SegmentCase sample(random);
    const TaperedSegment segment{sample.primitive, random_weight(random)};
    const auto kernel = make_kernel(sample);
    SCOPED_TRACE(std::string(name) + ", configuration " + std::to_string(i));
    check(kernel, segment, sample.point, sample.scale, sample.condition, plain, packed);
  }
  std::printf("%s: worst value %.2f, gradient %.2f ulp; in packs %.2f, %.2f\n", name, plain.value,
              plain.gradient, packed.value, packed.gradient);
}

TEST(TaperedSegment, CauchyIsExactForInputsMovedByAFewUlp) {
  expect_exact("tapered cauchy", 200,
               [](const cases::SegmentCase& c) { return Cauchy{c.per_width}; });
}

TEST(TaperedSegment, GaussianIsExactForInputsMovedByAFewUlp) {
  expect_exact("tapered gaussian", 70,
               [](cases::SegmentCase& c) { return cases::gaussian_for(c); });
}

/// Where forms change: near every switch, in units of the kernel.
TEST(TaperedSegment, IsExactWhereFormsChange) {
  Worst plain, packed;
  for (int i = 0; i < 60; ++i) {
    Random random(5, static_cast<std::uint64_t>(i));
    const double c = random.uniform() < 0.5 ? 0.0 : log_uniform(random, 0.01, 3.0);
    const bool cauchy = i % 2 == 0;
    // The foot beyond an end, or on the segment.
    const double x = random.uniform() < 0.6 ? log_uniform(random, 0.01, cauchy ? 1e3 : 20.0) : 0.0;
    const double variation = log_uniform(random, 0.1, 40.0);
    const double length = cauchy ? (x + 1.0) * log_uniform(random, 0.05, 10.0)
                                 : variation / (x + std::sqrt(x * x + variation));
    const double start = x > 0 ? x : -length * random.uniform();
    const TaperedSegment segment{{{start, 0, 0}, {start + length, 0, 0}}, random_weight(random)};
    const double scale = std::hypot(c, std::abs(start) + length);
    SCOPED_TRACE(i);
    if (cauchy) {
      check(Cauchy{1.0}, segment, {0, c, 0}, scale, 1.0, plain, packed);
    } else {
      check(Gaussian{1.0}, segment, {0, c, 0}, scale, 1.0, plain, packed);
    }
  }
  std::printf("switches: worst value %.2f, gradient %.2f ulp\n", plain.value, plain.gradient);
}

/// Scales from 1e-12 to 1e12, 1e9 R from the origin, |B| from 1e-6 to 1e6, strengths included.
TEST(TaperedSegment, IsExactInExtremeScenes) {
  struct Family {
    double scale, offset, blobbiness, stretch;
  };
  const Family families[] = {{1e-12, 0, -2, 3}, {1e12, 0, -2, 3},      {1, 1e9, -2, 3},
                             {1, 0, -1e6, 3},   {1, 0, -1e-6, 3},      {1, 0, -2, 1e-6},
                             {1, 0, -2, 1e6},   {1e-7, 1e6, -1e3, 1e3}};
  Worst plain, packed;
  for (const Family& family : families) {
    for (std::uint64_t i = 0; i < 6; ++i) {
      Random random(9, i);
      const Vec3d origin = family.scale * family.offset * random.direction();
      const double size = family.scale * family.stretch;
      const Segment axis{origin, origin + size * random.direction()};
      const TaperedSegment segment{axis, random_weight(random)};
      const Vec3d on = axis.a + random.uniform() * (axis.b - axis.a);
      const Vec3d p = on + family.scale * log_uniform(random, 1e-3, 1.2) * random.direction();
      const double scale = std::max({norm(p - axis.a), norm(p - axis.b), size});
      SCOPED_TRACE(family.blobbiness);
      const KernelKind kind = i % 2 == 0 ? KernelKind::cauchy : KernelKind::gaussian;
      const Isolation alone = isolate(kind, segment, family.scale, family.blobbiness);
      if (i % 2 == 0) {
        check(Cauchy{alone.width, alone.strength}, segment, p, scale, 1.0, plain, packed);
      } else {
        const Gaussian kernel{alone.width, alone.log_strength};
        const double top =
            kernel.log_amplitude - std::pow(kernel.a * distance(axis, p), 2) + std::log(size);
        if (std::abs(top) > 500) continue;  // cut off, or next to nothing
        check(kernel, segment, p, scale, std::max(1.0, kernel.log_amplitude), plain, packed);
      }
    }
  }
  std::printf("extremes: worst value %.2f, gradient %.2f ulp\n", plain.value, plain.gradient);
}

TEST(TaperedSegment, GradientsAreThoseOfTheValues) {
  for (int i = 0; i < 20; ++i) {
    Random random(11, static_cast<std::uint64_t>(i));
    cases::SegmentCase sample(random);
    const TaperedSegment segment{sample.primitive, {0.2, random.uniform(), 0.9}};
    const auto expect = [&](const auto& kernel) {
      EXPECT_LT(wide::gradient_mismatch(kernel, segment, sample.point, sample.scale), 1e-12) << i;
    };
    if (i % 2 == 0) {
      expect(Cauchy{sample.per_width});
    } else {
      expect(cases::gaussian_for(sample));
    }
  }
}

// ---- Laws ----

/// Beside the segment, at sizes and widths over some powers of ten.
struct Case {
  TaperedSegment segment;
  Vec3d p;
  double per_length;

  explicit Case(std::uint64_t stream) {
    Random random(21, stream);
    per_length = 1.0 / log_uniform(random, 0.1, 3.0);
    const double size = log_uniform(random, 0.05, 5.0);
    segment.axis = std::get<Segment>(testing::random_primitive(random, 1, size));
    segment.weight = {random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1)};
    p = testing::random_near(random, segment.axis, size, 2.0 / per_length);
  }
};

template <class Law>
void for_each_case(const Law& law) {
  for (std::uint64_t i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Case c(i);
    law(c, Cauchy{c.per_length});
    law(c, Gaussian{c.per_length});
  }
}

/// Of sums of positive parts, in units of the last place and of the inputs' rounding.
void expect_near(const Jet& a, const Jet& b, const Case& c, double ulps) {
  const double d = distance(c.segment, c.p) + size(c.segment) + 1.0 / c.per_length;
  const double scale = b.value * (1.0 + std::pow(d * c.per_length, 2));
  EXPECT_NEAR(a.value, b.value, ulps * 2.2e-16 * scale);
  EXPECT_LE(norm(a.gradient - b.gradient) * d, ulps * 2.2e-16 * scale * (1 + d * c.per_length));
}

TEST(TaperedSegment, OfConstantWeightIsThePlainSegment) {
  for_each_case([](const Case& c, const auto& kernel) {
    const TaperedSegment constant{c.segment.axis, linear_weight(0.75, 0.75)};
    expect_near(integral(kernel, constant, c.p), 0.75 * integral(kernel, c.segment.axis, c.p), c,
                8);
  });
}

/// w restricted to [x0, x1], by de Casteljau: b1 is w's blossom at both.
SegmentWeight part(const SegmentWeight& w, double x0, double x1) {
  const auto blossom = [&](double x, double y) {
    return w.b0 * (1 - x) * (1 - y) + w.b1 * (x * (1 - y) + y * (1 - x)) + w.b2 * x * y;
  };
  return {blossom(x0, x0), blossom(x0, x1), blossom(x1, x1)};
}

TEST(TaperedSegment, IsTheSumOfItsHalvesWithTheirPartsOfTheWeight) {
  for_each_case([](const Case& c, const auto& kernel) {
    const Vec3d cut = middle(c.segment);
    const auto& [axis, w] = c.segment;
    Jet sum = integral(kernel, TaperedSegment{{axis.a, cut}, part(w, 0, 0.5)}, c.p);
    sum += integral(kernel, TaperedSegment{{cut, axis.b}, part(w, 0.5, 1)}, c.p);
    expect_near(sum, integral(kernel, c.segment, c.p), c, 32);
  });
}

TEST(TaperedSegment, IsItselfFromTheOtherEnd) {
  for_each_case([](const Case& c, const auto& kernel) {
    const auto& [axis, w] = c.segment;
    const TaperedSegment reversed{{axis.b, axis.a}, {w.b2, w.b1, w.b0}};
    expect_near(integral(kernel, reversed, c.p), integral(kernel, c.segment, c.p), c, 8);
  });
}

TEST(TaperedSegment, MovesAndScalesWithItsAxis) {
  for (std::uint64_t i = 0; i < 100; ++i) {
    const Case c(i);
    Random random(22, i);
    const double factor = log_uniform(random, 0.01, 100);
    const Affine map = testing::random_similarity(random, factor, i % 2 == 0);
    const Jet here = integral(Cauchy{c.per_length}, c.segment, c.p);
    const Jet there =
        integral(Cauchy{c.per_length / factor}, transformed(c.segment, map), map(c.p));
    EXPECT_NEAR(there.value, factor * here.value, 1e-11 * there.value);
    const Vec3d turned = (map.linear * here.gradient) / factor;
    EXPECT_LE(norm(there.gradient - turned), 1e-10 * (norm(turned) + here.value * c.per_length));
  }
}

TEST(TaperedSegment, WithoutLengthIsThePointOfItsMean) {
  const Vec3d at{0.3, -0.2, 0.1}, along{0.6, 0, 0.8}, p{1, 0.5, -0.25};
  const SegmentWeight w{0.5, 2, 0.25};
  for (const double length : {1e-3, 1e-6, 1e-12}) {
    const TaperedSegment segment{{at, at + length * along}, w};
    const double exact_length = norm(segment.axis.b - segment.axis.a);
    const Jet jet = integral(Cauchy{2.0}, segment, p);
    const double h = Cauchy{2.0}.profile(squared_norm(p - at));
    EXPECT_NEAR(jet.value / exact_length, mean(w) * h, 2 * length * h + 1e-15);
  }
  const Jet none = integral(Gaussian{2.0}, TaperedSegment{{at, at}, w}, p);
  EXPECT_EQ(none, Jet{});
}

TEST(TaperedSegment, IsFiniteForEveryFinitePoint) {
  const double greatest = std::numeric_limits<double>::max();
  const double reaches[] = {0.0, 1e-300, 1e-160, 1e-8, 1.0, 2.0, 1e8, 1e77, 1e100, 1e141, greatest};
  const Segment segments[] = {
      {{0, 0, 0}, {2, 0, 0}}, {{1, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1e-310, 0, 0}}};
  for (const double x : reaches) {
    for (const double y : reaches) {
      for (const Vec3d& p : {Vec3d{x, y, 0}, Vec3d{-x, 0, y}, Vec3d{1, x, -x}}) {
        for (const double width : {1e-20, 1e-3, 1.0, 1e3, 1e20}) {
          for (const Segment& axis : segments) {
            const TaperedSegment segment{axis, {1, -2, 0}};
            for (const Jet& jet : {integral(Cauchy{width}, segment, p),
                                   integral(Gaussian{width, 1e4}, segment, p)}) {
              ASSERT_TRUE(std::isfinite(jet.value) && is_finite(jet.gradient))
                  << p.x << ", " << p.y << ", " << p.z << " width " << width;
            }
          }
        }
      }
    }
  }
}

TEST(SegmentWeight, KeepsItsMiddleThroughItsCoefficients) {
  for (std::uint64_t i = 0; i < 20000; ++i) {
    Random random(31, i);
    const auto draw = [&] { return random.uniform(-1, 1) * log_uniform(random, 1e-12, 1e3); };
    const double start = draw(), middle_of = draw(), end = draw();
    const SegmentWeight w = quadratic_weight(start, middle_of, end);
    EXPECT_EQ(quadratic_weight(w.b0, middle_value(w), w.b2), w) << i;
  }
}

TEST(SegmentWeight, RangeIsTight) {
  for (std::uint64_t i = 0; i < 500; ++i) {
    Random random(32, i);
    const SegmentWeight w = random_weight(random);
    Interval seen(w.b0, w.b0);
    for (int k = 0; k <= 1000; ++k) {
      const double x = k / 1000.0, y = 1 - x;
      seen = hull(seen, w.b0 * y * y + 2 * w.b1 * x * y + w.b2 * x * x);
    }
    EXPECT_TRUE(widened(range(w), 1e-15).contains(seen)) << i;
    EXPECT_LE(range(w).width(), seen.width() + 1e-5) << i;
  }
}

TEST(TaperedSegment, BoundsByDistanceHold) {
  for_each_case([](const Case& c, const auto& kernel) {
    TaperedSegment segment = c.segment;
    segment.weight.b1 = -1.5;  // of both signs
    const double d = distance(segment, c.p) * (1 - 1e-12);
    const Jet jet = integral(kernel, segment, c.p);
    EXPECT_LE(std::abs(jet.value), derivative_bound(kernel, segment, 0, d) * (1 + 1e-11));
    EXPECT_LE(norm(jet.gradient), derivative_bound(kernel, segment, 1, d) * (1 + 1e-11));
    EXPECT_LE(derivative_bound(kernel, segment, 0, d),
              mass_bound(segment) * kernel.derivative_envelope(0, d) * (1 + 1e-10));
  });
}

}  // namespace
}  // namespace cs2mesh
