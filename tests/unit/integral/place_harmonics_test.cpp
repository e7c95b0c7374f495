// The series of many places by harmonics against the recurrence, place by place.

#include "libfield/integral/place_harmonics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/integral/bulk.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

constexpr SeriesFrame kFrame = {{0.3, -0.2, 0.1}, 0.7};

/// Some at any of them, the nearest of which the series still converges for.
std::vector<SegmentSource> segments_around() {
  Random random(17);
  std::vector<SegmentSource> segments;
  for (int i = 0; i < 54; ++i) {
    segments.push_back({kFrame.center + random.uniform(2.5, 60.0) * random.direction(),
                        i < 9 ? Vec3d{} : random.uniform(0.01, 0.3) * random.direction(),
                        random.uniform(-1.0, 2.0), random.uniform(0.0, 0.2)});
  }
  return segments;
}

/// The sum of the recurrence's series, and of their coefficients' absolute values.
void add_exact(double two_nu, int order, const SegmentSource& segment, const NodeRule& rule,
               Series& sum, Series& size) {
  for (std::size_t i = 0; i < rule.size; ++i) {
    const Vec3d place = segment.middle + rule.along[i] * segment.half;
    const Vec3d d = (1 / kFrame.unit) * (kFrame.center - place);
    const double s = squared_norm(d) + segment.tau / (kFrame.unit * kFrame.unit);
    const double power =
        std::pow(s * kFrame.unit * kFrame.unit, -0.5 * two_nu) * rule.part[i] * segment.weight;
    kernel_series(two_nu, order, d, s, power, [&](std::size_t k, double value) {
      sum[k] += value;
      size[k] += std::abs(value);
    });
    // Where a coefficient is 0 for the direction of d, that of its length.
    visit_powers(
        [&](int a, int b, int c) {
          size[series_index(a, b, c)] += std::abs(power) * std::pow(s, -0.5 * (a + b + c));
        },
        order);
  }
}

/// Adds the series of the segments, nine by each rule, each up to the order of its list or a higher
/// one.
Series series_of(double two_nu, const std::vector<SegmentSource>& segments,
                 const std::vector<std::uint8_t>& orders) {
  std::vector<std::uint32_t> elements(segments.size());
  std::iota(elements.begin(), elements.end(), 0U);
  NodeLists lists;
  for (std::size_t rule = 0; rule < lists.size(); ++rule) {
    lists[rule] = {std::span(elements).subspan(9 * rule, 9),
                   std::span(orders).subspan(9 * rule, 9)};
  }
  HarmonicSums sums{};
  bulk_table().add_nodes(two_nu, kFrame, segments.data(), lists, sums.data());
  Series series{};
  add_harmonics(sums, series);
  return series;
}

TEST(PlaceHarmonics, GiveTheSeriesOfTheRecurrence) {
  const std::vector<SegmentSource> segments = segments_around();
  testing::with_every_isa([&](Isa) {
    for (const double two_nu : {1.0, 2.0, 4.0}) {
      for (int order = 2; order <= kTaylorOrder; ++order) {
        const std::vector<std::uint8_t> orders(segments.size(), static_cast<std::uint8_t>(order));
        const Series series = series_of(two_nu, segments, orders);
        Series exact{}, size{};
        for (std::uint32_t i = 0; i < segments.size(); ++i) {
          add_exact(two_nu, order, segments[i], kNodeRules[i / 9], exact, size);
        }
        for (std::size_t k = 0; k < kSeriesSize; ++k) {
          EXPECT_LE(std::abs(series[k] - exact[k]), 1e-11 * size[k])
              << two_nu << ", order " << order << ", coefficient " << k;
        }
      }
    }
  });
}

TEST(PlaceHarmonics, NoOrderIsLowerThanAskedFor) {
  const std::vector<SegmentSource> segments = segments_around();
  std::vector<std::uint8_t> orders;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    orders.push_back(static_cast<std::uint8_t>(kTaylorOrder - i % 9));
  }
  testing::with_every_isa([&](Isa) {
    const Series series = series_of(4.0, segments, orders);
    Series exact{}, size{};
    for (std::uint32_t i = 0; i < segments.size(); ++i) {
      add_exact(4.0, kTaylorOrder, segments[i], kNodeRules[i / 9], exact, size);
    }
    // Up to the lowest of them all are complete.
    visit_powers(
        [&](int a, int b, int c) {
          const std::size_t k = series_index(a, b, c);
          EXPECT_LE(std::abs(series[k] - exact[k]), 1e-11 * size[k]) << a << b << c;
        },
        kTaylorOrder - 8);
  });
}

}  // namespace
}  // namespace cs2mesh
