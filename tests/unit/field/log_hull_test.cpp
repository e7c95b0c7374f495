// Bends and slopes over hulls of a few points hold what is sampled.
#include "libfield/field/log_hull.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/base/check.h"
#include "libfield/field/field.h"
#include "tests/property/random_primitives.h"

namespace cs2mesh {
namespace {

Term random_term(Random& random) {
  constexpr KernelKind kKinds[] = {KernelKind::gaussian, KernelKind::gaussian, KernelKind::cauchy,
                                   KernelKind::inverse, KernelKind::squared};
  Term term;
  term.kernel = testing::random_kernel(random, kKinds[random.bits() % 5],
                                       testing::log_uniform(random, 0.1, 1.0));
  const std::size_t primitive = random.bits() % 3 == 0 ? random.bits() % 4 : 0;
  term.primitive = testing::random_primitive(random, primitive, 1.0);
  term.frame = frame_of(term.primitive);
  return term;
}

std::vector<Vec3d> random_hull(Random& random) {
  const Vec3d center = 2.0 * random.uniform() * random.direction();
  const double size = testing::log_uniform(random, 1e-3, 0.5);
  std::vector<Vec3d> points(1 + random.bits() % LogHull::kMostPoints);
  for (Vec3d& p : points) p = center + size * random.uniform() * random.direction();
  return points;
}

Vec3d random_inside(Random& random, const std::vector<Vec3d>& hull) {
  Vec3d sum{};
  double weights = 0.0;
  for (const Vec3d& p : hull) {
    const double weight = std::pow(random.uniform(), 3);
    sum += weight * p;
    weights += weight;
  }
  return sum / weights;
}

/// The logarithm of the sum.
Jet log_sum_at(const std::vector<Term>& terms, const Vec3d& p) {
  Jet sum;
  for (const Term& term : terms) accumulate(term, {&p, 1}, std::span<Jet>(&sum, 1));
  return {std::log(sum.value), sum.gradient / sum.value};
}

HullBound bound_of(const std::vector<Term>& terms, const std::vector<Vec3d>& points,
                   const std::vector<Vec3d>& directions) {
  LogHull hull(points, directions);
  for (const Term& term : terms) hull.add(term);
  HullBound bound;
  hull.bound(bound);
  return bound;
}

TEST(LogHull, SlopeAndBendHoldWhatIsSampled) {
  Random random(7, 1);
  int rising = 0, bent = 0;
  for (int round = 0; round < 3000; ++round) {
    std::vector<Term> terms(1 + random.bits() % 6);
    for (Term& term : terms) term = random_term(random);
    const std::vector<Vec3d> hull = random_hull(random);
    const Vec3d direction = random.direction();
    const HullBound bound = bound_of(terms, hull, {direction, 0.5 * direction});
    for (int k = 0; k < 12; ++k) {
      const Vec3d a = random_inside(random, hull), b = random_inside(random, hull);
      const Jet at_a = log_sum_at(terms, a), at_b = log_sum_at(terms, b);
      const double size = 1 + std::abs(at_a.value) + std::abs(at_b.value) + norm(at_a.gradient);
      if (!std::isfinite(size)) continue;
      const double along = dot(at_a.gradient, direction);
      ASSERT_GE(std::min(along, 0.5 * along), bound.slope - 1e-10 * size);
      // Along a line: G(b) >= G(a) + G'(a) - bend / 2.
      const double squared = squared_norm(b - a);
      ASSERT_GE(at_b.value - at_a.value - dot(at_a.gradient, b - a) + 0.5 * bound.bend * squared,
                -1e-10 * size);
    }
    rising += bound.slope > 0 ? 1 : 0;
    bent += std::isfinite(bound.bend) ? 1 : 0;
  }
  EXPECT_GT(rising, 300);
  EXPECT_GT(bent, 2500);
}

TEST(LogHull, OneGaussianPointIsExact) {
  Term term;
  term.kernel = Gaussian{3.0, 2.0};
  term.primitive = Point{{1, 0, 0}};
  term.frame = frame_of(term.primitive);
  const std::vector<Vec3d> hull{{2, 0, 0}, {3, 0, 0}, {2, 1, 0}};
  const HullBound bound = bound_of({term}, hull, {{-1, 0, 0}});
  EXPECT_NEAR(bound.bend, 18.0, 1e-9);
  EXPECT_NEAR(bound.slope, 18.0, 1e-9);
}

TEST(LogHull, FarNarrowTermsDoNotCount) {
  std::vector<Term> terms(2);
  terms[0].kernel = Gaussian{1.0, 1.0};
  terms[0].primitive = Point{{0, 0, 0}};
  terms[1].kernel = Gaussian{50.0, 1.0};
  terms[1].primitive = Point{{1.5, 0, 0}};
  for (Term& term : terms) term.frame = frame_of(term.primitive);
  const std::vector<Vec3d> hull{{0.9, 0, 0}, {1.0, 0.1, 0}, {1.0, 0, 0.1}};
  const HullBound bound = bound_of(terms, hull, {{-1, 0, 0}});
  EXPECT_NEAR(bound.bend, 2.0, 1e-6);
  EXPECT_NEAR(bound.slope, 1.8, 1e-6);
}

TEST(LogHull, StiffPointsHaveOneWhereTheirExponentIsNotCutOff) {
  Term term;
  term.kernel = Gaussian{std::sqrt(1000.0), 1000.0};
  term.primitive = Point{};
  term.frame = frame_of(term.primitive);
  EXPECT_FALSE(has_log_hull(term));
  EXPECT_TRUE(has_log_hull(term, {{0.95, -0.05, -0.05}, {1.05, 0.05, 0.05}}));
  EXPECT_FALSE(has_log_hull(term, {{0.6, -0.05, -0.05}, {1.05, 0.05, 0.05}}));
  EXPECT_FALSE(has_log_hull(term, {{-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}}));
}

TEST(LogHull, WantsAFewPoints) {
  EXPECT_THROW(LogHull({}, {}), ContractViolation);
  const std::vector<Vec3d> many(LogHull::kMostPoints + 1);
  EXPECT_THROW(LogHull(many, {}), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
