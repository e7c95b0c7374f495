// The closed form of segments that is never judged against the field in a hundred digits: off by
// no more than it promises wherever the place is and however wide the kernel.

#include "libfield/integral/line_sum.h"

#include <cstdio>

#include "libfield/integral/bulk.h"
#include "libfield/integral/cauchy_segment.h"
#include "tests/unit/integral/cases.h"
#include "tests/unit/integral/packed_sum.h"

namespace cs2mesh {
namespace {

using cases::SegmentCase;

SegmentSource source_of(const Cauchy& kernel, const Segment& segment) {
  const double s2 = kernel.s * kernel.s;
  const Vec3d half = 0.5 * (segment.b - segment.a);
  return {segment.a + half, half, kernel.amplitude * 2 * norm(half) / (s2 * s2), 1 / s2};
}

TEST(LineSum, IsOffByAPartOfTheKernelsStrengthAndByRoundedInputs) {
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
    SCOPED_TRACE(i);
    // Of a segment far from the origin the middle is rounded to places of that distance.
    const double scale = sample.scale + norm(sample.point) + norm(source.middle);
    const auto add = [&]<class Out>(const Vec3d& p, Out& sum) {
      const std::uint32_t index = 0;
      bulk_table().add_lines<Out>()(&source, &index, 1, &p, &sum, 1);
    };
    worst = std::max(worst, testing::check_rounding(sample, kernel, rounding, scale, add));
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
  testing::check_company(sources, random, [] { return bulk_table().add_lines<Jet>(); });
}

}  // namespace
}  // namespace cs2mesh
