// What a closed form that is never judged (line_sum.h, triangle_sum.h) promises of sums over many
// elements, in checks for each of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "libfield/base/jet.h"
#include "libfield/base/random.h"
#include "libfield/kernel/cauchy.h"
#include "tests/unit/integral/wide.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh::testing {

/// The field of one element against that in a hundred digits: off by `rounding` and by what inputs
/// rounded to places of the size `scale` make of it. `add(point, sum)` adds value or jet. Returns
/// the error of the value as a part of that.
template <class Sample, class Add>
double check_rounding(const Sample& sample, const Cauchy& kernel, double rounding, double scale,
                      const Add& add) {
  constexpr double kInputs = 64 * std::numeric_limits<double>::epsilon();
  const reference::Exact exact =
      wide::exact_field(kernel, sample.primitive, sample.point, sample.scale, sample.condition);
  const double value = static_cast<double>(exact.value);
  const Vec3d gradient{static_cast<double>(exact.gradient[0]),
                       static_cast<double>(exact.gradient[1]),
                       static_cast<double>(exact.gradient[2])};
  const double inputs = kInputs * sample.condition;
  const double value_error = rounding + inputs * (value + norm(gradient) * scale);
  const double slope_error =
      10 * kernel.s * rounding + inputs * (norm(gradient) + exact.hessian_norm * scale);
  double worst = 0.0;
  with_every_isa([&](Isa) {
    Jet jet;
    double alone = 0.0;
    add(sample.point, jet);
    add(sample.point, alone);
    EXPECT_LE(std::abs(jet.value - value), value_error);
    EXPECT_LE(norm(jet.gradient - gradient), slope_error);
    EXPECT_EQ(alone, jet.value);
    worst = std::max(worst, std::abs(jet.value - value) / value_error);
  });
  return worst;
}

/// The sum over a list is that of its elements, and the same bits for a place in any company.
/// `bulk()` is the sum's entry in the table.
template <class Source, class Bulk>
void check_company(const std::vector<Source>& sources, Random& random, const Bulk& bulk) {
  const std::vector<std::uint32_t> list{7, 0, 3, 4, 8};
  std::vector<Vec3d> places;
  for (int i = 0; i < 37; ++i) places.push_back(1.5 * random.uniform() * random.direction());
  with_every_isa([&](Isa) {
    const auto add = bulk();
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

}  // namespace cs2mesh::testing
