// Segments as a few nodes against the sum over these nodes.

#include "libfield/integral/segment_sum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/integral/bulk.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

/// w (|p - q|^2 + tau)^-nu.
Jet at_place(double two_nu, double weight, double tau, const Vec3d& from) {
  const double v = squared_norm(from) + tau, value = weight * std::pow(v, -0.5 * two_nu);
  return {value, (-two_nu * value / v) * from};
}

template <int N>
Jet by_nodes(double two_nu, const SegmentSource& source, const Vec3d& p) {
  Jet sum;
  for (std::size_t i = 0; i < N; ++i) {
    const double along = 2 * kUnitRule<N>.node[i] - 1;
    const Jet jet = at_place(two_nu, source.weight * kUnitRule<N>.weight[i], source.tau,
                             p - source.middle - along * source.half);
    sum.value += jet.value;
    sum.gradient = sum.gradient + jet.gradient;
  }
  return sum;
}

Jet by_rule(std::size_t which, double two_nu, const SegmentSource& source, const Vec3d& p) {
  switch (kFarNodes[which]) {
    case 2:
      return by_nodes<2>(two_nu, source, p);
    case 4:
      return by_nodes<4>(two_nu, source, p);
    case 6:
      return by_nodes<6>(two_nu, source, p);
    case 8:
      return by_nodes<8>(two_nu, source, p);
    case 14:
      return by_nodes<14>(two_nu, source, p);
    default:
      return by_nodes<20>(two_nu, source, p);
  }
}

TEST(SegmentSum, IsThatOfItsNodesWithEveryInstructionSet) {
  Random random(31);
  std::vector<SegmentSource> sources;
  for (int i = 0; i < 12; ++i) {
    sources.push_back({2.0 * random.direction(), random.uniform(0.01, 0.4) * random.direction(),
                       random.uniform(0.1, 1.0), random.uniform(0.0, 0.01)});
  }
  const std::vector<std::uint32_t> index = {3, 0, 11, 7, 5};
  std::vector<Vec3d> points;
  for (int i = 0; i < 19; ++i) points.push_back(random.uniform() * random.direction());
  testing::with_every_isa([&](Isa) {
    const BulkTable& table = bulk_table();
    for (const double two_nu : {1.0, 2.0, 4.0}) {
      for (std::size_t which = 0; which < kFarNodes.size(); ++which) {
        std::vector<Jet> jets(points.size());
        std::vector<double> values(points.size());
        table.segment_jets(two_nu, which, sources.data(), index.data(), index.size(), points.data(),
                           jets.data(), points.size());
        table.segment_values(two_nu, which, sources.data(), index.data(), index.size(),
                             points.data(), values.data(), points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
          Jet exact;
          double steepest = 0.0;
          for (const std::uint32_t k : index) {
            const Jet jet = by_rule(which, two_nu, sources[k], points[i]);
            exact.value += jet.value;
            exact.gradient = exact.gradient + jet.gradient;
            steepest += norm(jet.gradient);
          }
          EXPECT_NEAR(jets[i].value, exact.value, 1e-14 * exact.value);
          EXPECT_LE(norm(jets[i].gradient - exact.gradient), 1e-13 * steepest)
              << two_nu << ", nodes " << kFarNodes[which];
          EXPECT_EQ(values[i], jets[i].value);
        }
      }
    }
  });
}

}  // namespace
}  // namespace cs2mesh
