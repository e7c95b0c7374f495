// A sum of four kernels over four primitives at 1,000 points against mixed_sum.py, which integrates
// in 33 digits and shares no code with the library.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "libfield/integral/integral.h"
#include "libfield/kernel/kernel.h"
#include "libfield/primitive/primitive.h"
#include "tests/oracle/reference.h"

namespace cs2mesh {
namespace {

/// The parts of mixed_sum.py.
Jet mixed_sum(const Vec3d& p) {
  const Arc arc =
      make_arc({0.25, -0.125, 0.5}, 0.875, {1.0, 2.0, 2.0}, {1.0, 0.0, 0.0}, 20.0, 130.0);
  const Segment segment{{-0.5, 0.25, -0.75}, {0.625, 1.0, 0.375}};
  const Triangle triangle{{Vec3d{-1.0, -0.75, 0.25}, {0.5, -1.0, -0.25}, {0.0, 0.375, 0.125}}};
  Jet sum = integral(Cauchy{2.5, 1.5}, arc, p);
  sum += integral(Gaussian{1.75, 0.75}, segment, p);
  sum += integral(Quartic{1.25, 2.0}, Point{{0.125, 0.25, -0.375}}, p);
  sum += integral(Cauchy{0.75, 0.75}, triangle, p);
  return sum;
}

TEST(MixedSum, AgreesWithQuadratureIn33DigitsAtAThousandPoints) {
  const auto table = reference::read_csv(CS2MESH_SOURCE_DIR "/tests/oracle/mixed_sum.csv");
  ASSERT_EQ(table.size(), 1000u);
  double worst_value = 0.0, worst_gradient = 0.0;
  for (const auto& cell : table) {
    ASSERT_EQ(cell.size(), 9u);
    const auto number = [&](std::size_t i) { return std::strtod(cell[i].c_str(), nullptr); };
    reference::Exact exact;
    exact.value = std::strtold(cell[3].c_str(), nullptr);
    for (std::size_t i = 0; i < 3; ++i) {
      exact.gradient[i] = std::strtold(cell[4 + i].c_str(), nullptr);
    }
    // Summed over the parts already, each with its own scale.
    const reference::Conditioning conditioning{number(7), number(8)};
    const reference::BackwardError error = reference::backward_error(
        mixed_sum({number(0), number(1), number(2)}), exact, conditioning);
    EXPECT_LE(error.value, 64.0) << "at " << cell[0] << ", " << cell[1] << ", " << cell[2];
    EXPECT_LE(error.gradient, 64.0) << "at " << cell[0] << ", " << cell[1] << ", " << cell[2];
    worst_value = std::max(worst_value, error.value);
    worst_gradient = std::max(worst_gradient, error.gradient);
  }
  std::printf("mixed sum: worst value %.2f, gradient %.2f ulp\n", worst_value, worst_gradient);
}

}  // namespace
}  // namespace cs2mesh
