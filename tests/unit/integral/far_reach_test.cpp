// How segments far from a cell are taken, against what their series and nodes leave out.

#include "libfield/integral/far_reach.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/integral/bulk.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

FarBounds bounds_for(double two_nu) {
  return {two_nu, far_terms(two_nu), rule_bounds(two_nu), sum_bounds(two_nu)};
}

/// By the middles of many parts of it.
double exact_at(double two_nu, const SegmentSource& segment, const Vec3d& p) {
  if (squared_norm(segment.half) == 0.0) {
    return segment.weight * std::pow(squared_norm(p - segment.middle) + segment.tau, -0.5 * two_nu);
  }
  double sum = 0.0;
  constexpr int kParts = 16;
  for (int part = 0; part < kParts; ++part) {
    for (std::size_t i = 0; i < 8; ++i) {
      const double along = (2.0 * (part + kUnitRule<8>.node[i])) / kParts - 1.0;
      const Vec3d q = segment.middle + along * segment.half;
      sum += kUnitRule<8>.weight[i] / kParts *
             std::pow(squared_norm(p - q) + segment.tau, -0.5 * two_nu);
    }
  }
  return segment.weight * sum;
}

double taken_at(double two_nu, const SegmentSource& segment, FarChoice choice, const Vec3d& center,
                const Vec3d& p) {
  Series series{};
  const NodeRule& rule = kNodeRules[choice.rule];
  for (std::size_t i = 0; i < rule.size; ++i) {
    const Vec3d d = center - segment.middle - rule.along[i] * segment.half;
    const double s = squared_norm(d) + segment.tau;
    kernel_series(two_nu, choice.order, d, s, std::pow(s, -0.5 * two_nu),
                  [&](std::size_t k, double value) { series[k] += rule.part[i] * value; });
  }
  return segment.weight * series_jet(series.data(), p - center).value;
}

/// Segments about a cell of the half edge 1, points among them.
std::vector<SegmentSource> segments_around(Random& random, const Vec3d& center, std::size_t count) {
  std::vector<SegmentSource> segments;
  while (segments.size() < count) {
    const double length = segments.size() % 5 == 0 ? 0.0 : random.uniform(0.05, 1.5);
    const Vec3d d = random.uniform(1.8, 9.0) * random.direction();
    segments.push_back({center + d, 0.5 * length * random.direction(),
                        random.uniform() < 0.3 ? -0.7 : 1.3,
                        segments.size() % 3 == 0 ? random.uniform(0.0, 4.0) : 0.01});
  }
  return segments;
}

/// The pair of octants that x is in.
std::size_t pair_of(const Vec3d& x) {
  return ((x.x > 0) != (x.y > 0) ? 1U : 0U) + ((x.x > 0) != (x.z > 0) ? 2U : 0U);
}

TEST(FarReach, NothingIsLeftOpenThatIsNotCounted) {
  const Vec3d center{0.3, -0.2, 0.1};
  testing::with_every_isa([&](Isa) {
    for (const double two_nu : {1.0, 2.0, 4.0}) {
      const FarBounds bounds = bounds_for(two_nu);
      Random random(11);
      const std::vector<SegmentSource> segments = segments_around(random, center, 150);
      double tightest = 0.0;
      std::size_t taken = 0;
      for (std::uint32_t i = 0; i < segments.size(); ++i) {
        const double most = std::pow(10.0, random.uniform(-10.0, -3.0));
        FarChoice choice;
        OctantErrors errors{};
        bulk_table().choose_far(bounds, {center, 1.0, most}, segments.data(), &i, 1, &choice,
                                errors);
        if (choice.order == 0) {
          EXPECT_EQ(greatest(errors), 0.0);
          continue;
        }
        ++taken;
        ASSERT_LE(greatest(errors), 2 * most * (1 + 1e-9));
        ASSERT_LE(choice.order, kTaylorOrder);
        ASSERT_EQ(choice.rule == 0, squared_norm(segments[i].half) == 0.0);
        for (int k = 0; k < 80; ++k) {
          // Half of them on the surface, corners among them.
          Vec3d x{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
          if (k < 48) x[static_cast<std::size_t>(k) % 3] = k % 2 == 0 ? 1.0 : -1.0;
          if (k < 8) x = {k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0};
          const Vec3d p = center + x;
          const double exact = exact_at(two_nu, segments[i], p);
          const double left = std::abs(exact - taken_at(two_nu, segments[i], choice, center, p));
          const double error = errors[pair_of(x)];
          ASSERT_LE(left, error + 1e-14) << two_nu << ", segment " << i << ", order "
                                         << int{choice.order} << ", rule " << int{choice.rule};
          if (error > 1e-11) tightest = std::max(tightest, left / error);
        }
      }
      EXPECT_GT(taken, 75U);
      EXPECT_GT(tightest, 0.3) << two_nu;
    }
  });
}

TEST(FarReach, SegmentsAreTakenOneByOneAndErrorsAddUp) {
  const Vec3d center{-0.1, 0.4, 0.2};
  const FarBounds bounds = bounds_for(4.0);
  Random random(12);
  const std::vector<SegmentSource> segments = segments_around(random, center, 37);
  std::vector<std::uint32_t> index(segments.size());
  std::iota(index.begin(), index.end(), 0U);
  std::reverse(index.begin(), index.end());
  testing::with_every_isa([&](Isa) {
    std::vector<FarChoice> choices(index.size());
    OctantErrors together{}, sum{};
    const FarFrame frame{center, 1.0, 1e-6};
    bulk_table().choose_far(bounds, frame, segments.data(), index.data(), index.size(),
                            choices.data(), together);
    for (std::size_t i = 0; i < index.size(); ++i) {
      FarChoice alone;
      OctantErrors errors{};
      bulk_table().choose_far(bounds, frame, segments.data(), &index[i], 1, &alone, errors);
      EXPECT_EQ(alone.order, choices[i].order);
      EXPECT_EQ(alone.rule, choices[i].rule);
      for (std::size_t k = 0; k < kOctantPairs; ++k) sum[k] += errors[k];
      // What may leave open more is taken no farther.
      FarChoice loose;
      bulk_table().choose_far(bounds, {center, 1.0, 1e-5}, segments.data(), &index[i], 1, &loose,
                              errors);
      if (alone.order == 0) continue;
      EXPECT_LE(loose.order, alone.order);
      EXPECT_LE(loose.rule, alone.rule);
    }
    for (std::size_t k = 0; k < kOctantPairs; ++k) {
      EXPECT_NEAR(together[k], sum[k], 1e-12 * sum[k]);
    }
  });
}

TEST(FarReach, SegmentsAboutTheCenterAreNotFar) {
  const FarBounds bounds = bounds_for(4.0);
  // Through the centre, at it, within the cell; what is wide as well, but flat.
  const std::vector<SegmentSource> segments = {{{0, 0, 0}, {1, 0, 0}, 1.0, 0.0},
                                               {{0, 0, 0}, {0, 0, 0}, 1.0, 0.0},
                                               {{0.5, 0.5, 0}, {0.1, 0, 0}, 1.0, 0.01},
                                               {{0, 0, 0}, {0, 0, 0}, 1.0, 1e6}};
  testing::with_every_isa([&](Isa) {
    const std::array<std::uint32_t, 4> index = {0, 1, 2, 3};
    std::array<FarChoice, 4> choices;
    OctantErrors errors{};
    bulk_table().choose_far(bounds, {{0, 0, 0}, 1.0, 1e-3}, segments.data(), index.data(), 4,
                            choices.data(), errors);
    for (const std::size_t i : {0, 1, 2}) EXPECT_EQ(choices[i].order, 0);
    EXPECT_NE(choices[3].order, 0);
    EXPECT_LE(greatest(errors), 1e-3);
  });
}

TEST(FarReach, NodesLeaveNoMoreOpenThanIsCounted) {
  const Vec3d center{0.2, 0.1, -0.3};
  constexpr double kHalf = 0.4;
  testing::with_every_isa([&](Isa) {
    for (const double two_nu : {1.0, 2.0, 4.0}) {
      const FarBounds bounds = bounds_for(two_nu);
      Random random(13);
      double tightest = 0.0;
      std::array<std::size_t, kFarNodes.size() + 1> taken{};
      for (int i = 0; i < 400; ++i) {
        const SegmentSource segment{center + random.uniform(0.3, 4.0) * random.direction(),
                                    random.uniform(0.1, 1.2) * random.direction(),
                                    i % 2 == 0 ? 0.9 : -1.4,
                                    i % 3 == 0 ? random.uniform(0.0, 1.0) : 0.002};
        const std::uint32_t index = 0;
        std::uint8_t choice = 0;
        const double error = bulk_table().choose_nodes(
            bounds, {center, kHalf, std::pow(10.0, random.uniform(-11.0, -3.0))}, &segment, &index,
            1, &choice);
        ++taken[choice];
        if (choice == 0) {
          EXPECT_EQ(error, 0.0);
          continue;
        }
        for (int k = 0; k < 60; ++k) {
          const auto side = [&] { return random.uniform() < 0.5 ? -kHalf : kHalf; };
          Vec3d x{side(), side(), side()};
          if (k % 3 > 0) x = random.uniform() * x;
          if (k % 3 > 1) x[static_cast<std::size_t>(k) / 3 % 3] = random.uniform(-kHalf, kHalf);
          const Vec3d p = center + x;
          double sum = 0.0;
          bulk_table().add_segments<double>()(two_nu, choice - 1U, &segment, &index, 1, &p, &sum,
                                              1);
          const double exact = exact_at(two_nu, segment, p), left = std::abs(sum - exact);
          ASSERT_LE(left, error + 1e-13 * std::abs(exact)) << two_nu << ", segment " << i;
          if (error > 1e-10) tightest = std::max(tightest, left / error);
        }
      }
      EXPECT_GT(tightest, 0.1) << two_nu;
      if (two_nu != 4.0) continue;  // near a segment that may be clamped, no number will do
      for (const std::size_t count : taken) EXPECT_GT(count, 5U);
    }
  });
}

}  // namespace
}  // namespace cs2mesh
