// The closed form of triangles that is never judged against the field in a hundred digits: off by
// no more than it promises wherever the place is and however wide the kernel.

#include "libfield/integral/triangle_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/integral/bulk.h"
#include "libfield/integral/cauchy_triangle.h"
#include "tests/unit/integral/cases.h"
#include "tests/unit/integral/wide.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

using cases::TriangleCase;

TEST(TriangleSum, IsOffByAPartOfTheKernelsStrengthAndByRoundedInputs) {
  constexpr double kInputs = 64 * std::numeric_limits<double>::epsilon();
  double worst = 0.0;
  int tried = 0;
  for (int i = 0; tried < 400; ++i) {
    Random random(53, static_cast<std::uint64_t>(i));
    const TriangleCase sample(random);
    const Cauchy kernel{sample.per_width, random.uniform(0.5, 2.0)};
    if (sample.condition > 1e4 || !(kernel.s * sample.scale < 1e15)) continue;
    ++tried;
    const reference::Exact exact =
        wide::exact_field(kernel, sample.primitive, sample.point, sample.scale, sample.condition);
    const double value = static_cast<double>(exact.value);
    const Vec3d gradient{static_cast<double>(exact.gradient[0]),
                         static_cast<double>(exact.gradient[1]),
                         static_cast<double>(exact.gradient[2])};
    const double inputs = kInputs * sample.condition;
    const double rounding = triangle_rounding(kernel);
    const double value_error = rounding + inputs * (value + norm(gradient) * sample.scale);
    const double slope_error =
        10 * kernel.s * rounding + inputs * (norm(gradient) + exact.hessian_norm * sample.scale);
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    const TriangleSource source =
        triangle_source(kernel, TriangleFrame<double>(sample.primitive), sign);
    const std::uint32_t index = 0;
    testing::with_every_isa([&](Isa) {
      Jet jet;
      double alone = 0.0;
      bulk_table().add_triangles<Jet>()(&source, &index, 1, &sample.point, &jet, 1);
      bulk_table().add_triangles<double>()(&source, &index, 1, &sample.point, &alone, 1);
      EXPECT_LE(std::abs(sign * jet.value - value), value_error) << "configuration " << i;
      EXPECT_LE(norm(sign * jet.gradient - gradient), slope_error) << "configuration " << i;
      EXPECT_EQ(alone, jet.value);
      worst = std::max(worst, std::abs(sign * jet.value - value) / value_error);
    });
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
  const std::vector<std::uint32_t> list{7, 0, 3, 4, 8};
  std::vector<Vec3d> places;
  for (int i = 0; i < 37; ++i) places.push_back(1.5 * random.uniform() * random.direction());
  testing::with_every_isa([&](Isa) {
    const auto add = bulk_table().add_triangles<Jet>();
    std::vector<Jet> together(places.size());
    add(sources.data(), list.data(), list.size(), places.data(), together.data(), places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      Jet alone;
      for (const std::uint32_t source : list) {
        Jet one;
        add(sources.data(), &source, 1, &places[i], &one, 1);
        alone.value += one.value;
      }
      EXPECT_NEAR(together[i].value, alone.value, 1e-14 * (1 + std::abs(alone.value)));
      Jet single;
      add(sources.data(), list.data(), list.size(), &places[i], &single, 1);
      EXPECT_EQ(single.value, together[i].value);
      EXPECT_EQ(single.gradient, together[i].gradient);
    }
  });
}

}  // namespace
}  // namespace cs2mesh
