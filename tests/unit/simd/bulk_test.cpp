// Batches of points: what a point gets depends neither on the instructions nor on its neighbours.

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "libfield/base/check.h"
#include "libfield/integral/bulk.h"
#include "tests/property/random_primitives.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

using testing::accumulated;
using testing::log_uniform;
using testing::plain_term;
using testing::with_every_isa;

static_assert(kHasBulk<Gaussian, ArcFrame<double>> && !kHasBulk<Gaussian, TriangleFrame<double>>);

bool same_bits(const Jet& a, const Jet& b) {
  const auto bits = [](const Jet& jet) {
    return std::array{
        std::bit_cast<std::uint64_t>(jet.value), std::bit_cast<std::uint64_t>(jet.gradient.x),
        std::bit_cast<std::uint64_t>(jet.gradient.y), std::bit_cast<std::uint64_t>(jet.gradient.z)};
  };
  return bits(a) == bits(b);
}

/// One term and points in all regimes: near, far, on the axis of the primitive.
struct Batch {
  Term term;
  std::vector<Vec3d> points;
};

Batch random_batch(std::uint64_t stream, std::size_t count) {
  Random random(11, stream);
  const double length = log_uniform(random, 0.01, 30.0);
  const KernelKind kind = kAllKernels[stream % 7];
  constexpr std::size_t kShapes = 4;
  const Primitive primitive = testing::random_primitive(random, stream / 7 % kShapes, 1.0);
  Batch batch{plain_term(testing::random_kernel(random, kind, length), primitive), {}};
  for (std::size_t i = 0; i < count; ++i) {
    const double away = log_uniform(random, 1e-3, 1e3);
    batch.points.push_back(testing::random_near(random, primitive, 0.5, away));
  }
  batch.points[count / 2] =
      std::visit([](const auto& shape) { return middle(shape); }, batch.term.primitive);
  return batch;
}

/// But for points, where multiply and add are fused on machines that can.
TEST(Bulk, APointGetsTheSameBitsAloneInAnyBatchAndWithAnyInstructions) {
  for (std::uint64_t stream = 0; stream < 420; ++stream) {
    const Batch batch = random_batch(stream, 21);
    const bool fused = std::holds_alternative<Point>(batch.term.primitive);
    std::vector<Jet> alone;
    with_every_isa([&](Isa) {
      if (fused) alone.clear();
      if (alone.empty()) {
        for (const Vec3d& point : batch.points) alone.push_back(accumulated(batch.term, point));
      }
      for (std::size_t first = 0; first < 9; ++first) {
        for (std::size_t count = 1; first + count <= batch.points.size(); ++count) {
          const std::span<const Vec3d> part(batch.points.data() + first, count);
          std::vector<Jet> sums(count);
          accumulate(batch.term, part, sums);
          for (std::size_t i = 0; i < count; ++i) {
            ASSERT_TRUE(same_bits(sums[i], alone[first + i]))
                << "stream " << stream << ", point " << first + i << " of " << count;
          }
        }
      }
    });
  }
}

TEST(Bulk, AddsToWhatIsThereAndLeavesTheRestAlone) {
  const Term term = plain_term(Cauchy{2.0}, Point{{0, 0, 0}});
  Term less = term;
  less.sign = -1.0;
  with_every_isa([&](Isa) {
    const std::vector<Vec3d> points(13, Vec3d{0.25, 0, 0});
    std::vector<Jet> sums(14, Jet{1.0, {1.0, 2.0, 3.0}});
    accumulate(term, points, {sums.data(), 13});
    const double field = 1.0 / (1.25 * 1.25);
    for (std::size_t i = 0; i < 13; ++i) EXPECT_DOUBLE_EQ(sums[i].value, 1.0 + field);
    EXPECT_EQ(sums[13].value, 1.0);
    accumulate(less, points, std::span(sums.data(), 13));
    for (const Jet& sum : sums) {
      EXPECT_DOUBLE_EQ(sum.value, 1.0);
      EXPECT_DOUBLE_EQ(sum.gradient.x, 1.0);
      EXPECT_EQ(sum.gradient.z, 3.0);
    }
    accumulate(term, {}, std::span<Jet>());
  });
}

TEST(Bulk, FarAndHugePointsAreFinite) {
  const std::array<Vec3d, 5> points = {
      Vec3d{0, 0, 0}, {1e70, 0, 0}, {0, 1e150, 1e150}, {1e300, 1e300, 0}, {1, 0, 0}};
  for (std::uint64_t stream = 0; stream < 140; ++stream) {
    const Batch batch = random_batch(stream, 1);
    with_every_isa([&](Isa) {
      std::array<Jet, 5> sums;
      accumulate(batch.term, points, sums);
      for (const Jet& sum : sums) {
        EXPECT_TRUE(std::isfinite(sum.value) && is_finite(sum.gradient)) << stream;
      }
    });
  }
}

TEST(Isa, ChoosesTheWidestAndRefusesWhatIsNotThere) {
  const std::vector<Isa>& isas = available_isas();
  EXPECT_EQ(isas.front(), Isa::portable);
  EXPECT_EQ(active_isa(), isas.back());
  if (isas.back() != Isa::avx512) {
    EXPECT_THROW(use_isa(Isa::avx512), ContractViolation);
  }
}

}  // namespace
}  // namespace cs2mesh
