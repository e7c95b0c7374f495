// The closed form of triangles that is never judged against the field in a hundred digits: off by
// no more than it promises wherever the place is and however wide the kernel.

#include "libfield/integral/triangle_sum.h"

#include <cstdio>

#include "libfield/integral/bulk.h"
#include "libfield/integral/cauchy_triangle.h"
#include "tests/unit/integral/cases.h"
#include "tests/unit/integral/packed_sum.h"

namespace cs2mesh {
namespace {

using cases::TriangleCase;

TEST(TriangleSum, IsOffByAPartOfTheKernelsStrengthAndByRoundedInputs) {
  double worst = 0.0;
  int tried = 0;
  for (int i = 0; tried < 400; ++i) {
    Random random(53, static_cast<std::uint64_t>(i));
    const TriangleCase sample(random);
    const Cauchy kernel{sample.per_width, random.uniform(0.5, 2.0)};
    if (sample.condition > 1e4 || !(kernel.s * sample.scale < 1e15)) continue;
    ++tried;
    SCOPED_TRACE(i);
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    const TriangleSource source =
        triangle_source(kernel, TriangleFrame<double>(sample.primitive), sign);
    const auto add = [&]<class Out>(const Vec3d& p, Out& sum) {
      const std::uint32_t index = 0;
      bulk_table().add_triangles<Out>()(&source, &index, 1, &p, &sum, 1);
      sum = sign * sum;
    };
    worst = std::max(worst, testing::check_rounding(sample, kernel, triangle_rounding(kernel),
                                                    sample.scale, add));
  }
  std::printf("worst: %.3f of what is promised\n", worst);
  EXPECT_GT(worst, 1e-4);  // there is something to get wrong
}

TEST(TriangleSum, AddsInOrderTheSameBitsForAPlaceInAnyCompany) {
  Random random(8);
  std::vector<TriangleSource> sources;
  for (int i = 0; i < 9; ++i) {
    const Vec3d corner = random.direction();
    const Triangle triangle{
        {corner, corner + 0.3 * random.direction(), corner + 0.5 * random.direction()}};
    sources.push_back(triangle_source(Cauchy{random.uniform(1.0, 30.0)},
                                      TriangleFrame<double>(triangle), i % 3 == 0 ? -1.0 : 1.0));
  }
  testing::check_company(sources, random, [] { return bulk_table().add_triangles<Jet>(); });
}

}  // namespace
}  // namespace cs2mesh
