// The far field against the sum of all of its terms.

#include "libfield/field/far_field.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "libfield/base/check.h"
#include "libfield/base/random.h"
#include "libfield/field/field.h"
#include "tests/property/random_primitives.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

using testing::plain_term;

constexpr double kBudget = 1e-9;

/// Bones in clumps, of differing widths, some of negative strength; kernels whose sum at a surface
/// is of the order of 1.
double strength_of(KernelKind kind) {
  return kind == KernelKind::inverse ? 1e-4 : kind == KernelKind::squared ? 1e-3 : 4.0;
}

enum class Shape { point, segment, triangle };

std::vector<Term> clumps(KernelKind kind, Shape shape, std::size_t count, std::uint64_t seed) {
  std::vector<Term> terms;
  for (std::size_t i = 0; i < count; ++i) {
    Random random(seed, i);
    Random clump(seed + 1, i / 50);
    const Vec3d middle = 8.0 * Vec3d{clump.uniform(), clump.uniform(), clump.uniform()} +
                         Vec3d{random.uniform(), random.uniform(), random.uniform()};
    const double radius = random.uniform(0.02, 0.06);
    const Vec3d half = 0.1 * random.direction();
    // Every fifth triangle is a needle or so.
    const Vec3d side = (i % 5 == 0 ? 0.01 : 1.0) * 0.15 * random.direction();
    const Primitive primitive =
        shape == Shape::point ? Primitive(Point{middle})
        : shape == Shape::segment
            ? Primitive(Segment{middle - half, middle + half})
            : Primitive(Triangle{{middle - half, middle + half, middle + side}});
    const double strength = (shape == Shape::triangle ? 20 : 1) * strength_of(kind);
    Term term = plain_term(make_kernel(kind, 1 / radius, strength, 0.0, 1e-6 * radius), primitive);
    if (i % 7 == 0) term.sign = -1.0;
    terms.push_back(term);
  }
  return terms;
}

std::vector<Vec3d> places(std::size_t count) {
  std::vector<Vec3d> points;
  Random random(9);
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back({random.uniform(-1, 10), random.uniform(-1, 10), random.uniform(-1, 10)});
  }
  return points;
}

/// More than one cell lists.
std::size_t many(Shape shape) {
  return shape == Shape::point ? 1500 : 800;
}

struct Case {
  KernelKind kind;
  Shape shape;
};
constexpr Case kCases[] = {
    {KernelKind::cauchy, Shape::segment},  {KernelKind::cauchy, Shape::point},
    {KernelKind::cauchy, Shape::triangle}, {KernelKind::inverse, Shape::segment},
    {KernelKind::inverse, Shape::point},   {KernelKind::inverse, Shape::triangle},
    {KernelKind::squared, Shape::segment}, {KernelKind::squared, Shape::point},
    {KernelKind::squared, Shape::triangle}};

TEST(FarField, HasTheSecondDerivativeOfItsTerms) {
  const std::vector<Vec3d> points = places(40);
  for (const Case& c : kCases) {
    const std::vector<Term> terms = clumps(c.kind, c.shape, many(c.shape), 4);
    const Field field(terms, kBudget);
    std::vector<Jet2> jets(points.size());
    field.second_jets(points, jets);
    std::vector<Symmetric3> exact(points.size());
    for (const Term& term : terms) accumulate(term, points, std::span(exact));
    for (std::size_t i = 0; i < points.size(); ++i) {
      // What is approximated is at least one of the smaller cells' edges, some 0.1, away.
      EXPECT_LE(norm(jets[i].hessian - exact[i]), 100 * kBudget + 1e-12 * norm(exact[i]))
          << name_of(c.kind) << " " << i << ", norm " << norm(exact[i]);
    }
  }
}

TEST(FarField, KeepsTheErrorBudgetWithEveryInstructionSet) {
  const std::vector<Vec3d> points = places(150);
  for (const Case& c : kCases) {
    const std::vector<Term> terms = clumps(c.kind, c.shape, 1500, 4);
    testing::with_every_isa([&](Isa) {
      const Field field(terms, kBudget);
      std::vector<Jet> jets(points.size()), full(points.size());
      std::vector<double> values(points.size());
      field.jets(points, jets);
      field.values(points, values);
      field.full_jets(points, full);
      double worst = 0.0, size = 0.0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        worst = std::max(worst, std::abs(jets[i].value + 1.0 - full[i].value));
        size = std::max(size, std::abs(full[i].value));
        EXPECT_NEAR(norm(jets[i].gradient - full[i].gradient), 0.0, 1e-6);
        EXPECT_EQ(values[i], jets[i].value);
      }
      EXPECT_LE(worst, kBudget) << name_of(c.kind);
      EXPECT_GT(size, 1e-3);  // there is something to get wrong
    });
  }
}

/// The greatest error around bones that are moved by `offset`, in their own radii.
double worst_around_bones(const Vec3d& offset) {
  std::vector<Term> terms = clumps(KernelKind::cauchy, Shape::segment, 1500, 4);
  std::vector<Vec3d> points;
  Random random(12);
  for (Term& term : terms) {
    auto segment = std::get<Segment>(term.primitive);
    segment = {segment.a + offset, segment.b + offset};
    const double sign = term.sign;
    term = plain_term(term.kernel, segment);
    term.sign = sign;
    points.push_back(segment.a + random.uniform() * (segment.b - segment.a) +
                     random.uniform(0.0, 0.1) * random.direction());
  }
  const Field field(terms, kBudget);
  std::vector<double> values(points.size());
  std::vector<Jet> full(points.size());
  field.values(points, values);
  field.full_jets(points, full);
  double worst = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    worst = std::max(worst, std::abs(values[i] + 1.0 - full[i].value));
  }
  return worst;
}

TEST(FarField, KeepsTheErrorBudgetOnBones) {
  testing::with_every_isa([&](Isa) { EXPECT_LE(worst_around_bones({}), kBudget); });
}

TEST(FarField, KeepsTheErrorBudgetOnBonesFarFromTheOrigin) {
  // Middles of segments are rounded to 1e-10 there: those of the nearest would change F by 1e-9.
  EXPECT_LE(worst_around_bones({1e6, -1e6, 1e6}), 1e-10);
}

TEST(FarField, APointGetsTheSameBitsInAnyCompanyFromAnyThreadAndInRestrictions) {
  const std::vector<Term> terms = clumps(KernelKind::cauchy, Shape::segment, 1500, 4);
  const std::vector<Vec3d> points = places(300);
  const Field first(terms, kBudget), second(terms, kBudget);
  std::vector<double> values(points.size());
  first.values(points, values);
  // Cells are made in another order, by several threads at once.
  std::vector<double> others(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t k) {
    const std::size_t i = points.size() - 1 - k;
    others[i] = second.value(points[i]);
  });
  EXPECT_EQ(values, others);
  for (std::size_t i = 0; i < 20; ++i) {
    const Aabb box{points[i] - Vec3d{0.3, 0.3, 0.3}, points[i] + Vec3d{0.3, 0.3, 0.3}};
    EXPECT_EQ(first.restrict_to(box)->value(points[i]), values[i]);
  }
}

TEST(FarField, PointsOfAnyNumberGetTheSameBits) {
  const Field field(clumps(KernelKind::cauchy, Shape::point, 1500, 4), kBudget);
  const std::vector<Vec3d> points = places(50'000);
  std::vector<double> values(points.size());
  field.values(points, values);
  for (std::size_t i = 0; i < points.size(); i += 97) EXPECT_EQ(field.value(points[i]), values[i]);
}

TEST(FarField, BoundsContainWhatIsSampled) {
  Random random(12);
  for (const Case& c : kCases) {
    const Field field(clumps(c.kind, c.shape, many(c.shape), 6), kBudget);
    for (int i = 0; i < 40; ++i) {
      const double half = std::pow(10.0, random.uniform(-3.0, 0.5));
      const Vec3d center{random.uniform(-1, 10), random.uniform(-1, 10), random.uniform(-1, 10)};
      const Aabb box{center - Vec3d{half, half, half}, center + Vec3d{half, half, half}};
      const Interval range = field.enclose(box);
      const std::array<Interval, 3> gradient = field.enclose_gradient(box);
      const double turn = field.derivative_bound(2, box);
      std::vector<Vec3d> points;
      for (int k = 0; k < 30; ++k) {
        points.push_back(center + half * Vec3d{random.uniform(-1, 1), random.uniform(-1, 1),
                                               random.uniform(-1, 1)});
      }
      std::vector<Jet> jets(points.size());
      field.jets(points, jets);
      for (std::size_t k = 0; k < points.size(); ++k) {
        ASSERT_TRUE(range.contains(jets[k].value)) << name_of(c.kind) << " " << i;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double slack = 1e-6 + 1e-9 * gradient[axis].magnitude();
          ASSERT_TRUE(widened(gradient[axis], slack).contains(jets[k].gradient[axis]));
        }
        const double between = norm(points[k] - points[0]);
        if (between == 0) continue;  // and the bound may be infinite
        ASSERT_LE(norm(jets[k].gradient - jets[0].gradient), turn * between * (1 + 1e-9) + 1e-6);
      }
    }
  }
}

TEST(FarField, EnclosuresOfSmallBoxesAreTight) {
  const Field field(clumps(KernelKind::cauchy, Shape::segment, 1500, 4), kBudget);
  for (const Vec3d& p : places(20)) {
    const Aabb box{p - Vec3d{1e-3, 1e-3, 1e-3}, p + Vec3d{1e-3, 1e-3, 1e-3}};
    const double slope = norm(field.jet(p).gradient);
    EXPECT_LT(field.enclose(box).width(), 2e-3 * 2 * slope + 1e-2);
  }
}

TEST(FarField, StandsBesideAPlane) {
  std::vector<Term> terms = clumps(KernelKind::cauchy, Shape::segment, 500, 4);
  terms.push_back(plain_term(Cauchy{4.0, 3.0}, Plane{{0, 0, -1}, {0, 0, 1}}));
  const Field field(terms, kBudget);
  const std::vector<Vec3d> points = places(60);
  std::vector<Jet> jets(points.size()), full(points.size());
  field.jets(points, jets);
  field.full_jets(points, full);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(jets[i].value + 1.0, full[i].value, kBudget);
    const Aabb box{points[i], points[i] + Vec3d{0.1, 0.1, 0.1}};
    EXPECT_TRUE(field.enclose(box).contains(jets[i].value));
  }
}

TEST(FarField, SumsEveryElementFarOutside) {
  const Field field(clumps(KernelKind::cauchy, Shape::segment, 1500, 4), kBudget);
  for (const Vec3d& p : {Vec3d{1e3, 0, 0}, Vec3d{-40, 90, 7}, Vec3d{1e80, 0, 1e80}}) {
    Jet full;
    field.full_jets({&p, 1}, {&full, 1});
    EXPECT_NEAR(field.value(p) + 1.0, full.value, kBudget);
  }
}

TEST(TaylorSeries, IsThatOfTheKernelWithinItsRemainder) {
  Random random(3);
  for (const double two_nu : {1.0, 2.0, 4.0, 6.0}) {
    for (int i = 0; i < 200; ++i) {
      const Vec3d d = random.uniform(1.5, 30.0) * random.direction();
      const double tau = random.uniform(0.0, 2.0), s = squared_norm(d) + tau;
      Series series{};
      const auto power = [&](double x) { return std::pow(x, -0.5 * two_nu); };
      kernel_series(two_nu, kTaylorOrder, d, s, power(s),
                    [&](std::size_t place, double value) { series[place] = value; });
      const Vec3d x = random.uniform(0.0, 1.0) * random.direction();
      const double exact = power(squared_norm(d + x) + tau);
      const double remainder =
          power(s) * series_remainder(two_nu, norm(x) / std::sqrt(s)) + 1e-14 * exact;
      EXPECT_LE(std::abs(series_jet(series.data(), x).value - exact), remainder);
      // The same polynomial about another centre.
      const Vec3d offset{0.3, -0.2, 0.1};
      const Series moved = recentered(series, offset, 0.5);
      const Vec3d inner = 2.0 * (x - offset);
      EXPECT_NEAR(series_jet(moved.data(), inner).value, series_jet(series.data(), x).value,
                  1e-13 * exact + 1e-3 * remainder);
    }
  }
}

}  // namespace
}  // namespace cs2mesh
