// Bounds of sums of any terms over boxes within boxes hold what is sampled.
#include "libfield/field/near_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "libfield/field/field.h"
#include "tests/property/random_primitives.h"

namespace cs2mesh {
namespace {

Vec3d random_in(Random& random, const Aabb& box) {
  return {random.uniform(box.min.x, box.max.x), random.uniform(box.min.y, box.max.y),
          random.uniform(box.min.z, box.max.z)};
}

/// A kernel of some steepness over any primitive but a plane.
Term random_term(Random& random, KernelKind kind) {
  Term term;
  const double stiffness = random.uniform(0.5, 12);
  const bool inverse_width = kind == KernelKind::cauchy || kind == KernelKind::gaussian;
  term.kernel = make_kernel(kind, inverse_width ? std::sqrt(stiffness) : random.uniform(0.4, 1.5),
                            std::exp(0.3 * stiffness), stiffness, 1e-6);
  term.primitive = testing::random_primitive(random, random.bits() % 4, 1.0);
  term.frame = frame_of(term.primitive);
  return term;
}

/// Gives a segment that may have one a weight, of one sign or of both.
void taper(Random& random, Term& term) {
  const auto* segment = std::get_if<Segment>(&term.primitive);
  const bool reaches_everywhere =
      std::holds_alternative<Gaussian>(term.kernel) || std::holds_alternative<Cauchy>(term.kernel);
  if (segment == nullptr || !reaches_everywhere) return;
  const double least = random.bits() % 2 == 0 ? 0.0 : -0.5;
  const auto weight = [&] { return random.uniform(least, 1.5); };
  const double start = weight(), middle = weight(), end = weight();
  term.primitive = TaperedSegment{*segment, quadratic_weight(start, middle, end)};
  term.frame = frame_of(term.primitive);
}

struct Mixture {
  std::vector<Term> terms;

  Mixture(Random& random, int round) {
    const auto count = 1 + random.bits() % 8;
    const KernelKind one = kAllKernels[random.bits() % kAllKernels.size()];
    for (std::size_t i = 0; i < count; ++i) {
      const KernelKind kind =
          round % 3 == 0 ? kAllKernels[random.bits() % kAllKernels.size()] : one;
      terms.push_back(random_term(random, kind));
      if (round % 4 == 1 && i % 3 == 1) terms.back().sign = -1;
      if (round % 5 == 2) {
        terms.back().to_local = std::make_shared<Affine>(
            Affine::rotate(random.direction(), random.uniform(0, 90)) *
            Affine::scale({random.uniform(0.5, 2), random.uniform(0.5, 2), 1.0}));
      }
      if (round % 6 == 1) taper(random, terms.back());
    }
  }
  std::vector<std::uint32_t> all() const {
    std::vector<std::uint32_t> list(terms.size());
    for (std::uint32_t i = 0; i < list.size(); ++i) list[i] = i;
    return list;
  }
  Jet at(const Vec3d& p) const {
    Jet jet;
    for (const Term& term : terms) accumulate(term, {&p, 1}, std::span<Jet>(&jet, 1));
    return jet;
  }
  /// Bisects the sum less `total` between two points; nothing where it has one sign.
  std::optional<Vec3d> root_between(Vec3d a, Vec3d b, double total) const {
    const bool a_inside = at(a).value >= total;
    if (a_inside == (at(b).value >= total)) return std::nullopt;
    for (int i = 0; i < 60; ++i) {
      const Vec3d middle = 0.5 * (a + b);
      ((at(middle).value >= total) == a_inside ? a : b) = middle;
    }
    return a;
  }
};

/// A box and others around it, the largest first.
std::vector<Aabb> nested_boxes(Random& random) {
  const Vec3d center = 2.5 * random.uniform() * random.direction();
  const double half = std::pow(10.0, random.uniform(-2.5, -0.3));
  const Vec3d edges = half * Vec3d{random.uniform(0.3, 1), random.uniform(0.3, 1), 1.0};
  std::vector<Aabb> boxes{{center - edges, center + edges}};
  for (std::size_t i = 0; i < random.bits() % 4; ++i) {
    Aabb outer = boxes.front().grown(random.uniform(0.1, 2) * half);
    outer.max.x += random.uniform() * half;
    boxes.insert(boxes.begin(), outer);
  }
  return boxes;
}

TEST(NearSum, HoldsWhatIsSampled) {
  Random random(1, 1);
  int roots = 0, proven = 0, one_sided = 0, rounds = 0;
  for (int round = 0; round < 2000; ++round) {
    const Mixture sum(random, round);
    const std::vector<Aabb> boxes = nested_boxes(random);
    auto near = std::make_shared<const NearSum>(sum.terms, sum.all(), boxes.front());
    for (std::size_t i = 1; i < boxes.size(); ++i) {
      near = std::make_shared<const NearSum>(near, boxes[i]);
    }
    // The box, and part of it.
    const BatchBox inner[] = {BatchBox(boxes.back()),
                              BatchBox(Aabb{boxes.back().min, boxes.back().center()})};
    Interval ranges[2];
    near->enclose(inner, ranges);
    for (std::size_t b = 0; b < 2; ++b) {
      const BatchBox& box = inner[b];
      const Jet middle = sum.at(box.center);
      const Vec3d direction =
          norm(middle.gradient) > 0 ? normalized(middle.gradient) : random.direction();
      const double total =
          middle.value + 0.3 * box.radius * random.uniform(-1, 1) * norm(middle.gradient);
      const double least = near->least_slope(box, direction, total, 0.0);
      ++rounds;
      if (least > 0) ++proven;
      if (ranges[b].lo > 0.5 * middle.value && ranges[b].hi < 2 * middle.value) ++one_sided;
      for (int k = 0; k < 16; ++k) {
        const Vec3d p = k < 8 ? box.box.corner(k) : random_in(random, box.box);
        const double value = sum.at(p).value;
        ASSERT_LE(ranges[b].lo, value + 1e-12 * std::abs(value)) << "round " << round;
        ASSERT_GE(ranges[b].hi, value - 1e-12 * std::abs(value)) << "round " << round;
        const auto root =
            k < 8 ? std::nullopt : sum.root_between(p, random_in(random, box.box), total);
        if (!root) continue;
        ++roots;
        const Jet jet = sum.at(*root);
        ASSERT_LE(least, dot(jet.gradient, direction) + 1e-6 * norm(jet.gradient))
            << "round " << round;
      }
    }
  }
  EXPECT_GT(roots, 5000);
  EXPECT_GT(proven, rounds / 3);
  EXPECT_GT(one_sided, rounds / 4);
}

/// Whatever the logarithm of the sum does in the hull, over chords and along the directions.
void expect_to_hold(const HullBound& bound, const Mixture& sum, const BatchBox& box,
                    std::span<const Vec3d> directions, Random& random) {
  for (int k = 0; k < 12; ++k) {
    Vec3d p = k < 8 ? box.box.corner(k) : random_in(random, box.box);
    p = box.center + std::min(1.0, box.radius / norm(p - box.center)) * (p - box.center);
    const Vec3d q = box.center + random.uniform() * box.radius * random.direction();
    if (!box.box.contains(q)) continue;
    const Jet at_p = sum.at(p), at_q = sum.at(q), at_middle = sum.at(0.5 * (p + q));
    const double second =
        std::log(at_p.value) + std::log(at_q.value) - 2 * std::log(at_middle.value);
    ASSERT_GE(second, -0.25 * bound.bend * squared_norm(p - q) - 1e-9);
    for (const Vec3d& u : directions) {
      ASSERT_LE(bound.slope,
                dot(at_p.gradient, u) / at_p.value + 1e-6 * norm(at_p.gradient) / at_p.value);
    }
  }
}

TEST(NearSum, HullBoundsHoldWhatIsSampled) {
  Random random(3, 1);
  int growing = 0, bounded = 0, tight = 0;
  for (int round = 0; round < 3000; ++round) {
    const Mixture sum(random, round);
    const std::vector<Aabb> boxes = nested_boxes(random);
    auto near = std::make_shared<const NearSum>(sum.terms, sum.all(), boxes.front());
    for (std::size_t i = 1; i < boxes.size(); ++i) {
      near = std::make_shared<const NearSum>(near, boxes[i]);
    }
    BatchBox box(boxes.back());
    box.radius *= random.uniform(0.5, 1.0);
    const Jet middle = sum.at(box.center);
    if (!(norm(middle.gradient) > 0)) continue;
    const std::array<Vec3d, 2> directions{
        normalized(middle.gradient), normalized(normalized(middle.gradient) + random.direction())};
    HullBound bound;
    if (!near->hull_bound(box, directions, bound)) continue;
    EXPECT_TRUE(bound.in_exponent);
    ++bounded;
    growing += bound.slope > 0 ? 1 : 0;
    tight += bound.bend * box.radius * box.radius < 1 ? 1 : 0;
    expect_to_hold(bound, sum, box, directions, random);
    if (HasFatalFailure()) FAIL() << "round " << round;
  }
  EXPECT_GT(bounded, 800);
  EXPECT_GT(growing, bounded / 3);
  EXPECT_GT(tight, bounded / 3);
}

TEST(NearSum, HasNoHullBoundsWhereTermsAreSubtracted) {
  Random random(4, 1);
  Mixture sum(random, 0);
  sum.terms.assign(2, random_term(random, KernelKind::cauchy));
  sum.terms[1].sign = -1;
  const BatchBox box(Aabb{{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}});
  HullBound bound;
  EXPECT_FALSE(NearSum(sum.terms, sum.all(), box.box).hull_bound(box, {}, bound));
  // Also where they are far.
  const BatchBox away(Aabb{{90, 0, 0}, {90.1, 0.1, 0.1}});
  EXPECT_FALSE(NearSum(sum.terms, sum.all(), away.box).hull_bound(away, {}, bound));
}

TEST(NearSum, ProvesBoxesOfAThirdOfATubesRadius) {
  // Beside a long segment, every element of which pulls the same way.
  for (const KernelKind kind : kAllKernels) {
    Term term;
    term.kernel = make_kernel(kind,
                              kind == KernelKind::gaussian ? 3.0
                              : kind == KernelKind::cauchy ? 3.5
                                                           : 1.2,
                              10.0, 4.0, 1e-6);
    term.primitive = Segment{{-5, 0, 0}, {5, 0, 0}};
    term.frame = frame_of(term.primitive);
    const Vec3d center{0.1, 1.0, 0.0}, half{0.2, 0.2, 0.2};
    const Aabb box{center - half, center + half};
    const std::uint32_t index = 0;
    const NearSum sum({&term, 1}, {&index, 1}, box.grown(0.4));
    Jet jet;
    accumulate(term, {&center, 1}, std::span<Jet>(&jet, 1));
    EXPECT_GT(sum.least_slope(BatchBox(box), {0, -1, 0}, jet.value, 0.0), 0.0) << name_of(kind);
  }
}

TEST(NearSum, IsWhatSmallBoxesOfFieldsAreBoundedBy) {
  Random random(2, 1);
  int sure = 0;
  for (int round = 0; round < 60; ++round) {
    const Mixture sum(random, 1 + 15 * round);
    const Field field(sum.terms, 1e-9);
    const std::vector<Aabb> boxes = nested_boxes(random);
    auto part = field.restrict_to(boxes.front());
    for (const Aabb& box : boxes) part = part->restrict_to(box);
    EXPECT_TRUE(part->has_cheap_bounds());
    Interval range;
    part->enclose_each({&boxes.back(), 1}, {&range, 1});
    if (range.lo > 0 || range.hi < 0) ++sure;
    for (int k = 0; k < 20; ++k) {
      ASSERT_TRUE(range.contains(part->value(random_in(random, boxes.back()))));
    }
  }
  EXPECT_GT(sure, 10);
}

}  // namespace
}  // namespace cs2mesh
