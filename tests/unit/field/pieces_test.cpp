// A term is the sum of its halves.
#include "libfield/field/pieces.h"

#include <gtest/gtest.h>

#include "tests/property/random_primitives.h"

namespace cs2mesh {
namespace {

Jet jet_of(const Term& term, const Vec3d& p) {
  Jet jet;
  accumulate(term, {&p, 1}, std::span<Jet>(&jet, 1));
  return jet;
}

TEST(Pieces, AddUpToTheTerm) {
  Random random(1, 1);
  for (int round = 0; round < 600; ++round) {
    Term term;
    const KernelKind kind = kAllKernels[random.bits() % kAllKernels.size()];
    term.kernel = testing::random_kernel(random, kind, testing::log_uniform(random, 0.3, 3.0));
    term.primitive = testing::random_primitive(random, 1 + random.bits() % 3, 1.0);
    term.frame = frame_of(term.primitive);
    if (round % 5 == 0) term.sign = -1;
    if (round % 3 == 0) term.to_local = std::make_shared<Affine>(Affine::scale({2.0, 0.5, 1.0}));
    ASSERT_TRUE(can_be_halved(term));
    const auto [first, second] = halves(term);
    const Vec3d p = testing::random_near(random, term.primitive, 1.0, 1.0);
    const Jet whole = jet_of(term, p), a = jet_of(first, p), b = jet_of(second, p);
    const double size = std::abs(a.value) + std::abs(b.value);
    EXPECT_NEAR(whole.value, a.value + b.value, 1e-9 * size + 1e-13);
    EXPECT_LT(norm(whole.gradient - (a.gradient + b.gradient)),
              1e-8 * (norm(a.gradient) + norm(b.gradient) + size) + 1e-13);
    const auto measure_of = [](const Term& t) {
      return std::visit([](const auto& q) { return measure(q); }, t.primitive);
    };
    EXPECT_NEAR(measure_of(first), measure_of(second), 1e-9 * measure_of(term));
  }
}

TEST(Pieces, AreNotOfPointsAndPlanes) {
  Term term;
  term.kernel = Cauchy{1.0};
  term.primitive = Point{};
  EXPECT_FALSE(can_be_halved(term));
  term.primitive = Plane{};
  EXPECT_FALSE(can_be_halved(term));
}

}  // namespace
}  // namespace cs2mesh
