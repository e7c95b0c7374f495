#include "libfield/kernel/kernel.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

namespace cs2mesh {
namespace {

// h(r) of each kernel, written down anew from the thesis's definitions, for unit amplitude.
double definition(KernelKind kind, double width, double r) {
  const double y = r / width;
  switch (kind) {
    case KernelKind::cauchy:
      return std::pow(1.0 + width * width * r * r, -2.0);
    case KernelKind::gaussian:
      return std::exp(-width * width * r * r);
    case KernelKind::inverse:
      return 1.0 / r;
    case KernelKind::squared:
      return 1.0 / (r * r);
    case KernelKind::metaball:
      return y <= 1.0 / 3 ? 1.0 - 3.0 * y * y : y <= 1.0 ? 1.5 * (1.0 - y) * (1.0 - y) : 0.0;
    case KernelKind::soft:
      return y < 1.0 ? 1.0 - 4.0 / 9 * std::pow(y, 6) + 17.0 / 9 * std::pow(y, 4) - 22.0 / 9 * y * y
                     : 0.0;
    case KernelKind::quartic:
      return y < 1.0 ? std::pow(1.0 - y * y, 2) : 0.0;
  }
  return NAN;
}

class KernelTest : public ::testing::TestWithParam<KernelKind> {
 protected:
  static constexpr double kWidth = 1.7;
  static constexpr double kAmplitude = 3.0;
  Kernel kernel_ = make_kernel(GetParam(), kWidth, kAmplitude, std::log(kAmplitude), 0.0);

  long double profile(double r) const {
    const long double u = static_cast<long double>(r) * static_cast<long double>(r);
    return std::visit([&](const auto& k) { return k.profile(u); }, kernel_);
  }
  double slope(double r) const {
    return std::visit([&](const auto& k) { return k.slope(r * r); }, kernel_);
  }
  double envelope(int order, double r) const {
    return std::visit([&](const auto& k) { return k.derivative_envelope(order, r); }, kernel_);
  }
  // |D^order h| at r: h, |h'|, max(|h''|, |h'| / r).
  double truth(int order, double r) const {
    if (order == 0) return static_cast<double>(profile(r));
    const double first = 2.0 * r * slope(r);
    if (order == 1) return std::abs(first);
    const double step = 1e-5 * r;
    const double second =
        (2.0 * (r + step) * slope(r + step) - 2.0 * (r - step) * slope(r - step)) / (2.0 * step);
    return std::max(std::abs(second), std::abs(2.0 * slope(r)));
  }
};

TEST_P(KernelTest, ProfileIsTheDefinition) {
  for (double r = 0.01; r < 3.0; r += 0.0137) {
    const double expected = kAmplitude * definition(GetParam(), kWidth, r);
    EXPECT_NEAR(static_cast<double>(profile(r)), expected, 4e-15 * (kAmplitude + expected)) << r;
  }
}

TEST_P(KernelTest, SlopeIsTheDerivativeOfTheProfileBySquaredDistance) {
  for (double r = 0.03; r < 3.0; r += 0.0137) {
    const long double step = 1e-6L;
    const auto at = [&](long double u) {
      return std::visit([&](const auto& k) { return k.profile(u); }, kernel_);
    };
    const long double u = static_cast<long double>(r) * static_cast<long double>(r);
    const auto difference =
        static_cast<double>((at(u + step * u) - at(u - step * u)) / (2.0L * step * u));
    EXPECT_NEAR(slope(r), difference, 1e-6 * (std::abs(difference) + 0.01)) << r;
  }
}

TEST_P(KernelTest, EnvelopeIsTheLeastNonIncreasingUpperBound) {
  const bool inverse = GetParam() == KernelKind::inverse || GetParam() == KernelKind::squared;
  for (int order = 0; order <= 2; ++order) {
    // From far to near: the running maximum of the truth.
    double greatest = 0.0;
    double further = 0.0;
    for (double r = 3.0; r > 0.02; r -= 0.00137) {
      // Differences straddle the kinks of metaballs and of the edge of a support.
      const bool at_kink =
          order == 2 && (std::abs(r - kWidth) < 1e-4 || std::abs(3 * r - kWidth) < 1e-4);
      if (!at_kink) greatest = std::max(greatest, truth(order, r));
      const double bound = envelope(order, r);
      const double slack = order == 2 ? 1e-5 : 0.0;  // of the differences
      EXPECT_GE(bound * (1.0 + slack), greatest) << "order " << order << " at " << r;
      EXPECT_GE(bound, further) << "order " << order << " at " << r;
      // Tight up to the step, which matters where an edge or a peak lies between samples.
      if (!inverse && greatest > 0.0 && std::abs(r - kWidth) > 0.02) {
        EXPECT_LE(bound, greatest * 1.02 + 1e-12) << "order " << order << " at " << r;
      }
      further = bound;
    }
  }
}

/// |D^k h[e, ..., e]| at distance r, c the cosine between e and the ray: differences of step 1e-8
/// in fifty digits.
double derivative_along(const Kernel& kernel, int order, double r, double c) {
  using Wide = boost::multiprecision::cpp_bin_float_50;
  const Wide h = Wide("1e-8") * r;
  const auto at = [&](int steps) -> Wide {
    const Wide t = steps * h;
    return std::visit(
        [&](const auto& k) { return k.profile(Wide(Wide(r) * r + 2 * t * r * c + t * t)); },
        kernel);
  };
  const Wide third = (at(2) - 2 * at(1) + 2 * at(-1) - at(-2)) / (2 * h * h * h);
  if (order == 3) return std::abs(static_cast<double>(third));
  const Wide fourth = (at(2) - 4 * at(1) + 6 * at(0) - 4 * at(-1) + at(-2)) / (h * h * h * h);
  return std::abs(static_cast<double>(fourth));
}

TEST_P(KernelTest, HigherEnvelopesAreTheGreatestDerivativesInAnyDirection) {
  if (std::isfinite(std::visit([](const auto& k) { return k.support(); }, kernel_))) {
    for (const int order : {3, 4}) {  // the curvature jumps at the edge
      EXPECT_TRUE(std::isinf(envelope(order, 0.0)));
      EXPECT_TRUE(std::isinf(envelope(order, kWidth)));
      EXPECT_EQ(envelope(order, kWidth * 1.001), 0.0);
    }
    return;
  }
  for (const int order : {3, 4}) {
    double greatest = 0.0;  // from far to near
    for (double r = 8.0; r > 0.02; r *= 0.95) {
      for (int i = 0; i <= 10; ++i) {
        greatest = std::max(greatest, derivative_along(kernel_, order, r, 0.1 * i));
      }
      EXPECT_GE(envelope(order, r), greatest * (1 - 1e-11)) << "order " << order << " at " << r;
      if (r < 7.0) {
        EXPECT_LE(envelope(order, r), greatest * 1.03) << "order " << order << " at " << r;
      }
    }
  }
}

// The greatest of all, as published for unit width and amplitude.
TEST(KernelBounds, ReachTheKnownConstants) {
  EXPECT_NEAR(Gaussian{1.0}.derivative_envelope(2, 0.0), 2.0, 1e-9);
  EXPECT_NEAR(Gaussian{1.0}.derivative_envelope(4, 0.0), 12.0, 1e-9);
  EXPECT_NEAR(Cauchy{1.0}.derivative_envelope(2, 0.0), 4.0, 1e-9);
  EXPECT_NEAR(Cauchy{1.0}.derivative_envelope(4, 0.0), 72.0, 1e-9);
  EXPECT_NEAR(Inverse{}.derivative_envelope(4, 2.0), 24.0 / 32, 1e-9);
  EXPECT_NEAR(Squared{}.derivative_envelope(4, 2.0), 120.0 / 64, 1e-9);
}

TEST_P(KernelTest, SupportIsWhereTheProfileEnds) {
  const double support = std::visit([](const auto& k) { return k.support(); }, kernel_);
  if (std::isinf(support)) {
    EXPECT_GT(static_cast<double>(profile(4.0)), 0.0);
  } else {
    EXPECT_EQ(support, kWidth);
    EXPECT_GT(static_cast<double>(profile(support * (1 - 1e-6))), 0.0);
    EXPECT_EQ(static_cast<double>(profile(support)), 0.0);
    EXPECT_EQ(slope(support * (1 + 1e-9)), 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, KernelTest, ::testing::ValuesIn(kAllKernels),
                         [](const auto& kind) { return std::string(name_of(kind.param)); });

TEST(KernelNames, RoundTripAndSynonyms) {
  for (const KernelKind kind : kAllKernels) EXPECT_EQ(kernel_of(name_of(kind)), kind);
  EXPECT_EQ(kernel_of("invsquared"), KernelKind::squared);
  EXPECT_EQ(kernel_of("metaballs"), KernelKind::metaball);
  EXPECT_EQ(kernel_of("blob"), std::nullopt);
}

TEST(GaussianKernel, HugeAmplitudesStayFinite) {
  const Gaussian stiff{40.0, 1000.0};
  EXPECT_TRUE(std::isfinite(stiff.profile(0.0)));
  EXPECT_TRUE(std::isfinite(stiff.slope(0.0)));
  // Where a^2 r^2 = 1000 the surface passes.
  EXPECT_NEAR(stiff.profile(1000.0 / 1600.0), 1.0, 1e-12);
  double before = stiff.derivative_envelope(1, 0.0);
  for (double r = 0.0; r < 1.0; r += 0.01) {
    for (int order = 0; order <= 2; ++order) {
      EXPECT_TRUE(std::isfinite(stiff.derivative_envelope(order, r)));
    }
    EXPECT_LE(stiff.derivative_envelope(1, r), before * (1.0 + 1e-11));
    EXPECT_GE(stiff.derivative_envelope(1, r), std::abs(2.0 * r * stiff.slope(r * r)));
    before = stiff.derivative_envelope(1, r);
  }
  EXPECT_TRUE(std::isinf(stiff.derivative_envelope(3, 0.4)));  // the cut-off is at r = 0.5
  EXPECT_TRUE(std::isfinite(stiff.derivative_envelope(3, 0.501)));
}

TEST(InverseKernels, ClampHoldsTheValueAndDropsTheGradient) {
  const Inverse inverse{2.0, 0.25};
  EXPECT_EQ(inverse.profile(0.0), 8.0);
  EXPECT_EQ(inverse.slope(0.01), 0.0);
  EXPECT_EQ(inverse.profile(4.0), 1.0);
  const Squared squared{2.0, 0.25};
  EXPECT_EQ(squared.profile(0.0), 32.0);
  EXPECT_EQ(squared.slope(0.01), 0.0);
  // The gradient jumps at the clamp.
  EXPECT_TRUE(std::isfinite(squared.derivative_envelope(1, 0.0)));
  EXPECT_TRUE(std::isinf(squared.derivative_envelope(2, 0.0)));
  EXPECT_TRUE(std::isfinite(squared.derivative_envelope(4, 0.25)));
}

}  // namespace
}  // namespace cs2mesh
