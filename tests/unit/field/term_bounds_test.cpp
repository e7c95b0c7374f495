// Bounds of single terms and sums over boxes contain what is sampled, for every kernel over every
// primitive, and are not much wider.
#include "libfield/field/term_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libfield/field/field.h"
#include "libfield/field/kink_remainder.h"
#include "libfield/field/quadratic_range.h"
#include "libfield/primitive/nearest_point.h"
#include "tests/property/random_primitives.h"

namespace cs2mesh {
namespace {

bool diverges(KernelKind kind, std::size_t primitive) {
  return primitive == 4 && (kind == KernelKind::inverse || kind == KernelKind::squared);
}

/// A kernel that falls over 0.5 on a primitive of size 1; transformed terms see them stretched.
Term random_term(Random& random, KernelKind kind, std::size_t primitive, bool transformed) {
  Term term;
  const bool inverse_width = kind == KernelKind::cauchy || kind == KernelKind::gaussian;
  term.kernel = make_kernel(kind, inverse_width ? 2.0 : 1.0, 1.5, std::log(1.5), 1e-6);
  term.primitive = testing::random_primitive(random, primitive, 1.0);
  term.frame = frame_of(term.primitive);
  if (transformed) {
    term.to_local = std::make_shared<Affine>(
        Affine::translate(0.3 * random.direction()) *
        Affine::rotate(random.direction(), random.uniform(0, 360)) *
        Affine::scale({random.uniform(0.5, 2), random.uniform(0.5, 2), -1.0}));
  }
  return term;
}

/// A box whose centre lies near the primitive of the term, seen from the scene.
Aabb random_box(Random& random, const Term& term) {
  Vec3d center = testing::random_near(random, term.primitive, 1.0, 1.0);
  if (term.to_local) center = inverse(*term.to_local)(center);
  const double half = std::pow(10.0, random.uniform(-4, -0.3));
  const Vec3d edges = half * Vec3d{random.uniform(0.2, 1), random.uniform(0.2, 1), 1.0};
  return {center - edges, center + edges};
}

std::vector<Vec3d> samples(Random& random, const Aabb& box) {
  std::vector<Vec3d> points;
  for (int i = 0; i < 8; ++i) points.push_back(box.corner(i));
  for (int i = 0; i < 12; ++i) {
    points.push_back({random.uniform(box.min.x, box.max.x), random.uniform(box.min.y, box.max.y),
                      random.uniform(box.min.z, box.max.z)});
  }
  return points;
}

std::vector<Jet> jets_of(const Term& term, const std::vector<Vec3d>& points) {
  std::vector<Jet> jets(points.size());
  accumulate(term, points, std::span<Jet>(jets));
  return jets;
}

void expect_contained(const Term& term, Random& random, const std::string& label) {
  std::vector<BatchBox> boxes;
  const Aabb first = random_box(random, term);
  boxes.emplace_back(first);
  const bool many = random.bits() % 2 == 0;
  for (int i = 1; many && i < 5; ++i) {
    const Vec3d shift = first.extent().x * static_cast<double>(i) * random.direction();
    boxes.emplace_back(Aabb{first.min + shift, first.max + shift});
  }
  for (const TaylorOrder order : {TaylorOrder::first, TaylorOrder::second}) {
    std::vector<SumBound> sums(boxes.size());
    add_bounds(term, BoxBatch(boxes, order), 1e-6, sums);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Interval range = range_of(sums[i], 1, boxes[i]);
      for (const Jet& jet : jets_of(term, samples(random, boxes[i].box))) {
        ASSERT_TRUE(range.contains(jet.value))
            << label << ": " << jet.value << " in " << range.lo << ", " << range.hi;
      }
    }
  }
  GradientSum sum;
  add_gradient_bound(term, boxes[0], sum);
  const std::array<Interval, 3> gradient = sum.bound(boxes[0]);
  for (const Jet& jet : jets_of(term, samples(random, boxes[0].box))) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double slack = 1e-12 * (1 + norm(jet.gradient));
      ASSERT_TRUE(widened(gradient[axis], slack).contains(jet.gradient[axis]))
          << label << " axis " << axis;
    }
  }
}

TEST(TermBounds, ContainValuesAndGradientsOfEveryKernelOverEveryPrimitive) {
  for (const KernelKind kind : kAllKernels) {
    for (std::size_t primitive = 0; primitive < testing::kPrimitiveKinds; ++primitive) {
      if (diverges(kind, primitive)) continue;
      for (std::uint64_t seed = 0; seed < 15; ++seed) {
        Random random(seed, primitive);
        const Term term = random_term(random, kind, primitive, seed % 3 == 0);
        expect_contained(term, random,
                         std::string(name_of(kind)) + " " + std::to_string(primitive) + " seed " +
                             std::to_string(seed));
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

// There the way from the nearest point to the centre is nothing but rounding.
TEST(TermBounds, ContainValuesAndGradientsOfBoxesInTheMiddleOfAPlane) {
  for (const KernelKind kind : {KernelKind::cauchy, KernelKind::gaussian, KernelKind::metaball,
                                KernelKind::soft, KernelKind::quartic}) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      Random random(seed, 50);
      const Term term = random_term(random, kind, 4, false);
      const auto& plane = std::get<Plane>(term.primitive);
      const Vec3d aside = random.direction();
      const Vec3d center = nearest_point(plane, plane.point + 3.0 * aside);
      const double half = std::pow(10.0, random.uniform(-4, -0.3));
      const BatchBox box(Aabb{center, center}.grown(half));
      std::vector<SumBound> sums(1);
      add_bounds(term, BoxBatch({&box, 1}, TaylorOrder::first), 1e-6, sums);
      const Interval range = range_of(sums[0], 1, box);
      GradientSum sum;
      add_gradient_bound(term, box, sum);
      const std::array<Interval, 3> gradient = sum.bound(box);
      for (const Jet& jet : jets_of(term, samples(random, box.box))) {
        ASSERT_TRUE(range.contains(jet.value)) << name_of(kind) << " seed " << seed;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          ASSERT_TRUE(widened(gradient[axis], 1e-12).contains(jet.gradient[axis]))
              << name_of(kind) << " seed " << seed << " axis " << axis;
        }
      }
    }
  }
}

// The divided difference of three gradients is a mean of third derivatives, of four of fourth.
TEST(TermBounds, HigherDerivativesHoldForDifferencesOfGradients) {
  for (const KernelKind kind : kAllKernels) {
    for (std::size_t primitive = 0; primitive < testing::kPrimitiveKinds; ++primitive) {
      if (diverges(kind, primitive)) continue;
      for (std::uint64_t seed = 0; seed < 30; ++seed) {
        Random random(seed, 10 + primitive);
        const Term term = random_term(random, kind, primitive, seed % 2 == 0);
        const Aabb box = random_box(random, term);
        const double step = 0.3 * std::min(box.extent().x, box.extent().y);
        const Vec3d way = random.direction();
        std::vector<Vec3d> points;
        for (int i = 0; i < 4; ++i) points.push_back(box.center() + (i - 1.5) * step * way);
        const std::vector<Jet> jets = jets_of(term, points);
        const Vec3d third = jets[2].gradient - 2.0 * jets[1].gradient + jets[0].gradient;
        const Vec3d fourth =
            jets[3].gradient - 3.0 * jets[2].gradient + 3.0 * jets[1].gradient - jets[0].gradient;
        const double noise = 1e-10 * (1 + norm(jets[0].gradient));
        EXPECT_LE(norm(third), derivative_bound(term, 3, box) * step * step + noise)
            << name_of(kind) << " " << primitive;
        EXPECT_LE(norm(fourth), derivative_bound(term, 4, box) * step * step * step + noise)
            << name_of(kind) << " " << primitive;
      }
    }
  }
}

/// Of terms with profiles, where these bend and where they have corners.
TEST(TermBounds, SecondDerivativesHoldForDifferencesOfGradients) {
  int bounded = 0, all = 0;
  for (const KernelKind kind : kAllKernels) {
    for (std::size_t primitive = 0; primitive < testing::kPrimitiveKinds; ++primitive) {
      if (diverges(kind, primitive)) continue;
      for (std::uint64_t seed = 0; seed < 40; ++seed) {
        Random random(seed, 20 + primitive);
        Term term = random_term(random, kind, primitive, true);
        for (std::uint64_t k = 0; k <= seed % 2; ++k) {
          StrengthProfile profile;
          profile.along_u = static_cast<ProfileFunction>(random.bits() % kProfileNames.size());
          if (seed % 4 == 0) profile.along_v = ProfileFunction::cos;
          profile.scale_u = random.uniform(-3.0, 3.0);
          profile.upper = random.uniform(0.5, 1.5);
          term.profiles.push_back(profile);
        }
        const Vec3d center = random_box(random, term).center();
        const double size = std::pow(10.0, random.uniform(-4.0, -1.0));
        const Aabb box{center - Vec3d{size, size, size}, center + Vec3d{size, size, size}};
        const double bound = derivative_bound(term, 2, box);
        ++all;
        bounded += std::isfinite(bound) ? 1 : 0;
        for (int i = 0; i < 10; ++i) {
          const std::vector<Jet> jets = jets_of(
              term, {center + size * random.direction(), center + size * random.direction()});
          const double noise = 1e-9 * (1 + norm(jets[0].gradient) + norm(jets[1].gradient));
          // Points on a sphere of that size are within twice of it.
          EXPECT_LE(norm(jets[1].gradient - jets[0].gradient), 2 * bound * size + noise)
              << name_of(kind) << " " << primitive << " seed " << seed;
        }
      }
    }
  }
  EXPECT_GT(2 * bounded, all);
}

Vec3d random_vector(Random& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

TEST(QuadraticRange, ContainsTheValuesAndIsAttained) {
  double widest = 0.0, sum = 0.0;
  constexpr int kTrials = 400;
  for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
    Random random(seed, 20);
    const Vec3d g = random.uniform(0, 3) * random_vector(random);
    const Vec3d diagonal = random_vector(random), others = random_vector(random);
    const Symmetric3 h{diagonal.x, diagonal.y, diagonal.z, others.x, others.y, others.z};
    const Vec3d half{random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1)};
    const Interval range = quadratic_range(g, h, half);
    double least = 0.0, most = 0.0;
    for (int i = 0; i < 21 * 21 * 21; ++i) {
      const Vec3d d{half.x * (i % 21 - 10) / 10, half.y * (i / 21 % 21 - 10) / 10,
                    half.z * (i / 441 - 10) / 10};
      const double value = dot(g, d) + 0.5 * dot(d, h * d);
      ASSERT_TRUE(range.contains(value)) << seed;
      least = std::min(least, value);
      most = std::max(most, value);
    }
    const double ratio = range.width() / (most - least);
    widest = std::max(widest, ratio);
    sum += ratio;
  }
  EXPECT_LT(sum / kTrials, 1.05);
  EXPECT_LT(widest, 1.6);
}

TEST(KinkRemainder, MassOfShellsIsThatOfTheElementsInThem) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed, 30);
    const Segment segment{random_vector(random), random_vector(random)};
    const Vec3d p = 1.5 * random_vector(random);
    const double lo = random.uniform(-0.2, 1.0), hi = lo + random.uniform(0, 1.0);
    int inside = 0;
    constexpr int kElements = 2000;
    for (int i = 0; i < kElements; ++i) {
      const double d = norm(segment.a + (i + 0.5) / kElements * (segment.b - segment.a) - p);
      inside += lo <= d && d <= hi ? 1 : 0;
    }
    const double length = measure(segment);
    EXPECT_NEAR(shell_mass(segment, p, lo, hi), length * inside / kElements, 3e-3 * length) << seed;
  }
}

struct Tightness {
  double alone = 0.0, batched = 0.0;
  int boxes = 0;
};

/// Widths over sampled ranges, for boxes of half an inverse width near the surface of twenty terms.
Tightness tightness(KernelKind kind, std::size_t primitive) {
  Tightness sum;
  for (std::uint64_t seed = 0; seed < 400 && sum.boxes < 40; ++seed) {
    Random random(seed, 40);
    std::vector<Term> terms;
    for (int i = 0; i < 20; ++i) terms.push_back(random_term(random, kind, primitive, false));
    const Field field(terms, 1e-9);
    const Vec3d center = random.uniform(0.0, 3.0) * random.direction();
    const Vec3d half{0.1, 0.1, 0.1};
    const Aabb box{center - half, center + half};
    if (!(std::abs(field.value(center)) < 0.7)) continue;
    std::vector<Vec3d> points = samples(random, box);
    for (int i = 0; i < 125; ++i) {
      points.push_back(center + 0.05 * Vec3d{i % 5 - 2.0, i / 5 % 5 - 2.0, i / 25 - 2.0});
    }
    std::vector<double> values(points.size());
    field.values(points, values);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    if (!(*most > *least)) continue;
    const Interval range = field.enclose(box);
    EXPECT_TRUE(range.contains(Interval(*least, *most))) << name_of(kind) << " " << seed;
    Interval batched;
    field.enclose_each({&box, 1}, {&batched, 1});
    EXPECT_TRUE(batched.contains(Interval(*least, *most))) << name_of(kind) << " " << seed;
    sum.alone += range.width() / (*most - *least);
    sum.batched += batched.width() / (*most - *least);
    ++sum.boxes;
  }
  return sum;
}

TEST(Enclosures, OfSumsAreAtMostTwiceAsWideAsTheRange) {
  for (const KernelKind kind : {KernelKind::cauchy, KernelKind::gaussian, KernelKind::metaball,
                                KernelKind::soft, KernelKind::quartic}) {
    for (const std::size_t primitive : {0, 1}) {
      const Tightness sum = tightness(kind, primitive);
      ASSERT_GT(sum.boxes, 5) << name_of(kind);
      EXPECT_LT(sum.alone / sum.boxes, 2.0) << name_of(kind) << " " << primitive;
    }
  }
}

}  // namespace
}  // namespace cs2mesh
