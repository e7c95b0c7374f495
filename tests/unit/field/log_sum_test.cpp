// Bounds in the exponent, and slopes along a direction, hold what is sampled.
#include "libfield/field/log_sum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "libfield/field/field.h"
#include "libfield/field/slope_program.h"
#include "libfield/simd/isa.h"
#include "tests/property/random_primitives.h"

namespace cs2mesh {
namespace {

Vec3d random_in(Random& random, const Aabb& box) {
  return {random.uniform(box.min.x, box.max.x), random.uniform(box.min.y, box.max.y),
          random.uniform(box.min.z, box.max.z)};
}

/// A kernel as steep as `stiffness` over a primitive of size 1.
Term random_term(Random& random, KernelKind kind, std::size_t primitive, double stiffness) {
  Term term;
  const bool inverse_width = kind == KernelKind::cauchy || kind == KernelKind::gaussian;
  term.kernel = make_kernel(kind, inverse_width ? std::sqrt(stiffness) : 1.0, std::exp(stiffness),
                            stiffness, 1e-6);
  term.primitive = testing::random_primitive(random, primitive, 1.0);
  term.frame = frame_of(term.primitive);
  return term;
}

std::vector<Term> gaussian_terms(Random& random) {
  std::vector<Term> terms;
  const auto count = 1 + random.bits() % 6;
  constexpr std::size_t kKinds[] = {0, 1, 3};  // points, segments, triangles
  for (std::size_t i = 0; i < count; ++i) {
    terms.push_back(random_term(random, KernelKind::gaussian, kKinds[random.bits() % 3],
                                random.uniform(0.5, 30)));
  }
  return terms;
}

Aabb random_box(Random& random) {
  const Vec3d center = 1.5 * random.uniform() * random.direction();
  const double half = std::pow(10.0, random.uniform(-3, -0.2));
  const Vec3d edges = half * Vec3d{random.uniform(0.2, 1), random.uniform(0.2, 1), 1.0};
  return {center - edges, center + edges};
}

/// All terms, those that matter in `around` apart from the others.
LogTerms log_terms(const std::vector<Term>& terms, const Aabb& around, double share) {
  std::vector<std::uint32_t> all(terms.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  return {terms, all, around, share};
}

Jet sum_at(const std::vector<Term>& terms, const Vec3d& p) {
  Jet jet;
  for (const Term& term : terms) accumulate(term, {&p, 1}, std::span<Jet>(&jet, 1));
  return jet;
}

TEST(LogSum, RangeAndSlopeHoldWhatIsSampled) {
  Random random(1, 1);
  int steep = 0;
  for (int round = 0; round < 3000; ++round) {
    const std::vector<Term> terms = gaussian_terms(random);
    const BatchBox box(random_box(random));
    LogSum sum(log_terms(terms, box.box, 0.0), box);
    const Interval range = sum.range();
    const Vec3d direction = round % 2 == 0 ? random.direction() : sum.common_direction();
    const double least = sum.least_slope(direction);
    for (int k = 0; k < 20; ++k) {
      const Vec3d p = k < 8 ? box.box.corner(k) : random_in(random, box.box);
      const Jet jet = sum_at(terms, p);
      if (!(jet.value > 1e-280)) continue;
      ASSERT_LE(range.lo, std::log(jet.value));
      ASSERT_GE(range.hi, std::log(jet.value));
      ASSERT_LE(least, dot(jet.gradient, direction) / jet.value * (1 + 1e-12) + 1e-9);
    }
    if (range.width() > 10) ++steep;
  }
  EXPECT_GT(steep, 100) << "the test means to try steep sums";
}

TEST(LogSum, WhatIsLeftOutStaysBelowItsBounds) {
  Random random(5, 1);
  int left_out = 0;
  for (int round = 0; round < 500; ++round) {
    const std::vector<Term> terms = gaussian_terms(random);
    const BatchBox box(random_box(random));
    const LogTerms some = log_terms(terms, box.box, 0.1);
    ASSERT_LE(some.left_out(), 0.1);
    if (some.left_out() > 0) ++left_out;
    const Interval range = LogSum(some, box).range();
    for (int k = 0; k < 20; ++k) {
      const double value = sum_at(terms, random_in(random, box.box)).value;
      ASSERT_LE(std::exp(range.lo) * (1 - 1e-9), value);
      ASSERT_GE(std::exp(range.hi) * (1 + 1e-9) + some.left_out(), value);
    }
  }
  EXPECT_GT(left_out, 20);
}

TEST(LogSum, FindsTheDirectionInWhichAllTermsGrow) {
  // Across the groove between two balls no normal of one leads into the other, the way to the
  // middle between them does.
  std::vector<Term> terms(2);
  for (const double side : {-1.0, 1.0}) {
    Term& term = terms[side < 0 ? 0 : 1];
    term.kernel = make_kernel(KernelKind::gaussian, std::sqrt(6.0), std::exp(6.0), 6.0, 1e-6);
    term.primitive = Point{{side, 0, 0}};
    term.frame = frame_of(term.primitive);
  }
  const Vec3d center{0.2, 0.6, 0}, edges{0.25, 0.25, 0.25};
  const BatchBox box(Aabb{center - edges, center + edges});
  const LogSum sum(log_terms(terms, box.box, 0.0), box);
  const Vec3d normal = normalized(sum_at(terms, center).gradient);
  EXPECT_LT(sum.least_slope(normal), 0);
  EXPECT_GT(sum.least_slope(sum.common_direction()), 0);
}

TEST(LogSum, IsTheSameForEveryInstructionSetButForRounding) {
  Random random(6, 1);
  const Isa before = active_isa();
  for (int round = 0; round < 200; ++round) {
    const std::vector<Term> terms = gaussian_terms(random);
    const BatchBox box(random_box(random));
    const Vec3d direction = random.direction();
    std::optional<Interval> first;
    double slope = 0.0;
    for (const Isa isa : available_isas()) {
      use_isa(isa);
      LogSum sum(log_terms(terms, box.box, 0.0), box);
      const Interval range = sum.range();
      const double least = sum.least_slope(direction);
      if (!first) {
        first = range;
        slope = least;
      }
      ASSERT_NEAR(range.lo, first->lo, 1e-9 * (1 + std::abs(first->lo)));
      ASSERT_NEAR(range.hi, first->hi, 1e-9 * (1 + std::abs(first->hi)));
      ASSERT_NEAR(least, slope, 1e-9 * (1 + std::abs(slope)));
    }
  }
  use_isa(before);
}

TEST(Field, EnclosesPointsFarTooStiffForTheirExponentials) {
  Random random(5, 1);
  for (int round = 0; round < 100; ++round) {
    std::vector<Term> terms;
    for (int i = 0; i < 3; ++i) {
      const double stiffness = random.uniform(400, 3000);  // exponents are cut off at 600
      terms.push_back(random_term(random, KernelKind::gaussian, 0, 1.0));
      terms.back().kernel = Gaussian{std::sqrt(stiffness), stiffness};
    }
    const Field field(terms, 1e-9);
    ASSERT_TRUE(field.has_cheap_bounds());
    const BatchBox box(random_box(random));
    Interval range;
    field.enclose_each({&box.box, 1}, {&range, 1});
    for (int k = 0; k < 20; ++k) {
      const double value = field.value(k < 8 ? box.box.corner(k) : random_in(random, box.box));
      ASSERT_LE(range.lo, value);
      ASSERT_GE(range.hi, value);
    }
  }
}

TEST(LogSum, IsTightForSmallBoxes) {
  Random random(2, 1);
  for (int round = 0; round < 200; ++round) {
    const std::vector<Term> terms = gaussian_terms(random);
    const Vec3d center = random.direction();
    const double half = 1e-4;
    const Vec3d edges{half, half, half};
    const BatchBox box(Aabb{center - edges, center + edges});
    const Interval range = LogSum(log_terms(terms, box.box, 0.0), box).range();
    const Jet jet = sum_at(terms, center);
    const Vec3d g = jet.gradient / jet.value;
    const double linear = 2 * half * (std::abs(g.x) + std::abs(g.y) + std::abs(g.z));
    EXPECT_LT(range.width(), 1.05 * linear + 1e-5);
  }
}

// The box of a slanted segment is no measure of the distance from it.
TEST(LogSum, StiffTermsAreNothingFarFromThem) {
  const double a = std::sqrt(260.0);
  for (const Primitive& primitive : {Primitive(Segment{{0, 0, 0}, {4, 4, 4}}),
                                     Primitive(Triangle{{Vec3d{0, 0, 0}, {4, 4, 4}, {4, 4, 0}}})}) {
    Term term;
    term.kernel = Gaussian{a, 260.0};
    term.primitive = primitive;
    term.frame = frame_of(primitive);
    const BatchBox box(Aabb{{2.9, 0.1, 2.0}, {3.0, 0.2, 2.1}});
    EXPECT_LT(LogSum(log_terms({term}, box.box, 0.0), box).range().hi, -100.0);
  }
}

/// Bisects F - total along a segment; nothing where it has one sign.
std::optional<Vec3d> root_between(const std::vector<Term>& terms, Vec3d a, Vec3d b, double total) {
  const bool a_inside = sum_at(terms, a).value >= total;
  if (a_inside == (sum_at(terms, b).value >= total)) return std::nullopt;
  for (int i = 0; i < 60; ++i) {
    const Vec3d middle = 0.5 * (a + b);
    ((sum_at(terms, middle).value >= total) == a_inside ? a : b) = middle;
  }
  return a;
}

TEST(SlopeProgram, HoldsOnTheSurfaceForEveryPair) {
  Random random(3, 1);
  int roots = 0, proven = 0;
  for (const KernelKind kind : kAllKernels) {
    for (std::size_t primitive = 0; primitive < 4; ++primitive) {
      for (int round = 0; round < 120; ++round) {
        const double stiffest = round % 3 == 2 ? 80 : 8;
        std::vector<Term> terms{random_term(random, kind, primitive, random.uniform(0.5, stiffest)),
                                random_term(random, kind, primitive, random.uniform(0.5, 8))};
        if (round % 4 == 3) terms[1].sign = -1;
        const BatchBox box(random_box(random));
        const Jet middle = sum_at(terms, box.center);
        if (!(middle.value > 0) || !(squared_norm(middle.gradient) > 0)) continue;
        const double total = middle.value * random.uniform(0.9, 1.1);
        const Vec3d direction = normalized(middle.gradient);
        SlopeProgram program;
        for (const Term& term : terms) program.add(term, box, direction);
        const double least = program.least(total);
        if (least > 0) ++proven;
        for (int k = 0; k < 8; ++k) {
          const auto root =
              root_between(terms, random_in(random, box.box), random_in(random, box.box), total);
          if (!root) continue;
          ++roots;
          const Jet jet = sum_at(terms, *root);
          const double slope = dot(jet.gradient, direction);
          ASSERT_LE(least, slope + 1e-6 * norm(jet.gradient))
              << "kernel " << static_cast<int>(kind) << ", primitive " << primitive;
        }
      }
    }
  }
  EXPECT_GT(roots, 1000);
  EXPECT_GT(proven, 300);
}

TEST(Field, BoundsOfRestrictionsHoldWhatIsSampled) {
  Random random(4, 1);
  for (int round = 0; round < 200; ++round) {
    std::vector<Term> terms;
    for (int i = 0; i < 6; ++i) {
      terms.push_back(random_term(random, KernelKind::cauchy, i % 4, random.uniform(0.5, 4)));
      if (i == 5) terms.back().sign = -1;
    }
    const Field field(terms, 1e-9);
    const Aabb whole = random_box(random).grown(0.3);
    const auto part = field.restrict_to(whole);
    const Vec3d center = whole.center(), edges = 0.1 * whole.extent();
    const Aabb box{center - edges, center + edges};
    Interval range;
    part->enclose_each({&box, 1}, {&range, 1});
    const Vec3d direction = random.direction();
    const double least = part->least_slope(box, direction);
    for (int k = 0; k < 20; ++k) {
      const Vec3d p = random_in(random, box);
      const Jet jet = part->jet(p);
      ASSERT_TRUE(range.contains(jet.value));
      if (std::abs(jet.value) < 1e-3) {
        ASSERT_LE(least, dot(jet.gradient, direction) + 1e-2);
      }
    }
  }
}

/// Beside the ball, within it and across its surface, along every direction.
TEST(Field, SlopesOfGaussiansAreInfiniteJustWhereNoSurfaceIs) {
  Random random(5, 1);
  std::vector<Term> terms{random_term(random, KernelKind::gaussian, 0, 8.0)};
  terms[0].primitive = Point{};
  terms[0].frame = frame_of(terms[0].primitive);
  const Field field(terms, 1e-9);
  int without = 0, with = 0;
  for (int round = 0; round < 1000; ++round) {
    const Aabb box = random_box(random);
    const auto part = field.restrict_to(box.grown(0.1));
    const double nearest = box.distance({{}, {}});
    double farthest = 0.0;
    for (int i = 0; i < 8; ++i) farthest = std::max(farthest, norm(box.corner(i)));
    const double radius = field.bounds().max.x;  // of the ball, and a hair more
    const Vec3d downhill = box.center(), sideways = cross(downhill, random.direction());
    for (const Vec3d& direction : {downhill, sideways}) {
      const double least = part->least_slope(box, direction);
      const double rise = part->rise(box, direction).slope;
      if (nearest > 1.05 * radius || farthest < 0.95 * radius) {
        ++without;
        EXPECT_TRUE(std::isinf(least) && least > 0);
        EXPECT_TRUE(std::isinf(rise) && rise > 0);
      } else if (nearest < 0.95 * radius && farthest > 1.05 * radius) {
        ++with;
        EXPECT_TRUE(std::isfinite(least));
        EXPECT_TRUE(std::isfinite(rise));
      }
    }
  }
  EXPECT_GT(without, 100);
  EXPECT_GT(with, 100);
}

}  // namespace
}  // namespace cs2mesh
