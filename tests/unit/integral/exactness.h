// The worst backward error of a field over random configurations: one point at a time, and in packs
// with every instruction set.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>

#include "libfield/base/random.h"
#include "libfield/integral/integral.h"
#include "tests/unit/integral/wide.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh::wide {

/// In ulp.
struct Limits {
  double value = 16.0, gradient = 16.0;
};

struct Worst {
  Limits limit;
  double value = 0.0, gradient = 0.0;

  void include(const Jet& jet, const reference::Exact& exact) {
    const reference::BackwardError error = reference::backward_error(jet, exact);
    EXPECT_LE(error.value, limit.value);
    EXPECT_LE(error.gradient, limit.gradient);
    value = std::max(value, error.value);
    gradient = std::max(gradient, error.gradient);
  }
};

/// A Case is drawn from a Random; make_kernel(case) is the kernel and exact(kernel, case) the
/// truth.
template <class Case, class MakeKernel, class MakeExact>
void expect_exact_for(const char* name, int count, const MakeKernel& make_kernel,
                      const MakeExact& make_exact, const Limits& limits = {}) {
  Worst plain{limits}, packed{limits};
  for (int i = 0; i < count; ++i) {
    Random random(7, static_cast<std::uint64_t>(i));
    Case sample(random);
    const auto kernel = make_kernel(sample);
    const reference::Exact exact = make_exact(kernel, sample);
    SCOPED_TRACE(std::string(name) + ", configuration " + std::to_string(i));
    plain.include(integral(kernel, sample.primitive, sample.point), exact);
    const Term term = testing::plain_term(kernel, sample.primitive);
    testing::with_every_isa(
        [&](Isa) { packed.include(testing::accumulated(term, sample.point), exact); });
  }
  std::printf("%s: worst value %.2f, gradient %.2f ulp; in packs %.2f, %.2f\n", name, plain.value,
              plain.gradient, packed.value, packed.gradient);
}

}  // namespace cs2mesh::wide
