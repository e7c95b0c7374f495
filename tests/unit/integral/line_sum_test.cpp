// The closed form of segments that is never judged against the field in a hundred digits: off by
// no more than it promises wherever the place is and however wide the kernel.

#include "libfield/integral/line_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/integral/bulk.h"
#include "libfield/integral/cauchy_segment.h"
#include "tests/unit/integral/cases.h"
#include "tests/unit/integral/wide.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

using cases::SegmentCase;

SegmentSource source_of(const Cauchy& kernel, const Segment& segment) {
  const double s2 = kernel.s * kernel.s;
  const Vec3d half = 0.5 * (segment.b - segment.a);
  return {segment.a + half, half, kernel.amplitude * 2 * norm(half) / (s2 * s2), 1 / s2};
}

TEST(LineSum, IsOffByAPartOfTheKernelsStrengthAndByRoundedInputs) {
  constexpr double kInputs = 64 * std::numeric_limits<double>::epsilon();
  double worst = 0.0;
  int tried = 0;
  for (int i = 0; tried < 600; ++i) {
    Random random(54, static_cast<std::uint64_t>(i));
    const SegmentCase sample(random);
    const Cauchy kernel{sample.per_width, random.uniform(0.5, 2.0)};
    const SegmentSource source = source_of(kernel, sample.primitive);
    const double rounding = line_rounding(source, sample.scale);
    if (!std::isfinite(rounding)) continue;
    ++tried;
    const reference::Exact exact =
        wide::exact_field(kernel, sample.primitive, sample.point, sample.scale, sample.condition);
    const double value = static_cast<double>(exact.value);
    const Vec3d gradient{static_cast<double>(exact.gradient[0]),
                         static_cast<double>(exact.gradient[1]),
                         static_cast<double>(exact.gradient[2])};
    // Of a segment far from the origin the middle is rounded to places of that distance.
    const double scale = sample.scale + norm(sample.point) + norm(source.middle);
    const double value_error = rounding + kInputs * (value + norm(gradient) * scale);
    const double slope_error =
        10 * kernel.s * rounding + kInputs * (norm(gradient) + exact.hessian_norm * scale);
    const std::uint32_t index = 0;
    testing::with_every_isa([&](Isa) {
      Jet jet;
      double alone = 0.0;
      bulk_table().add_lines<Jet>()(&source, &index, 1, &sample.point, &jet, 1);
      bulk_table().add_lines<double>()(&source, &index, 1, &sample.point, &alone, 1);
      EXPECT_LE(std::abs(jet.value - value), value_error) << "configuration " << i;
      EXPECT_LE(norm(jet.gradient - gradient), slope_error) << "configuration " << i;
      EXPECT_EQ(alone, jet.value);
      worst = std::max(worst, std::abs(jet.value - value) / value_error);
    });
  }
  std::printf("worst: %.3f of what is promised\n", worst);
  EXPECT_GT(worst, 1e-4);  // there is something to get wrong
}

TEST(LineSum, PromisesNothingWhereSquaresOverflow) {
  const SegmentSource moderate{{0, 0, 0}, {1, 0, 0}, 1.0, 0.01};
  EXPECT_LT(line_rounding(moderate, 10.0), 1e-8);
  EXPECT_EQ(line_rounding(moderate, 1e12), HUGE_VAL);
  EXPECT_EQ(line_rounding({{0, 0, 0}, {0, 0, 0}, 1.0, 0.01}, 10.0), HUGE_VAL);
  EXPECT_EQ(line_rounding({{0, 0, 0}, {1e20, 0, 0}, 1.0, 1e40}, 1e21), HUGE_VAL);
}

TEST(LineSum, AddsInOrderTheSameBitsForAPlaceInAnyCompany) {
  Random random(9);
  std::vector<SegmentSource> sources;
  for (int i = 0; i < 9; ++i) {
    sources.push_back({random.direction(), random.uniform(0.1, 0.6) * random.direction(),
                       i % 3 == 0 ? -1.0 : 1.0, random.uniform(0.001, 0.1)});
  }
  const std::vector<std::uint32_t> list{7, 0, 3, 4, 8};
  std::vector<Vec3d> places;
  for (int i = 0; i < 37; ++i) places.push_back(1.5 * random.uniform() * random.direction());
  testing::with_every_isa([&](Isa) {
    const auto add = bulk_table().add_lines<Jet>();
    std::vector<Jet> together(places.size());
    add(sources.data(), list.data(), list.size(), places.data(), together.data(), places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      Jet alone, single;
      double size = 0.0;
      for (const std::uint32_t source : list) {
        Jet one;
        add(sources.data(), &source, 1, &places[i], &one, 1);
        alone.value += one.value;
        size += std::abs(one.value);
      }
      EXPECT_NEAR(together[i].value, alone.value, 1e-14 * size);
      add(sources.data(), list.data(), list.size(), &places[i], &single, 1);
      EXPECT_EQ(single.value, together[i].value);
      EXPECT_EQ(single.gradient, together[i].gradient);
    }
  });
}

}  // namespace
}  // namespace cs2mesh
