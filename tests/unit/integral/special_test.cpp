// Number tables and special functions against 100 digits.

#include "libfield/integral/special.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>

#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/gauss_legendre.h"

namespace cs2mesh {
namespace {

using Wide = boost::multiprecision::cpp_bin_float_100;

TEST(Erfcx, IsExactToAFewUlpOverTheHalfLine) {
  double worst = 0.0;
  for (int i = -400; i <= 160; ++i) {
    const double x = std::pow(10.0, 0.01 * i);
    const Wide exact = exp(Wide(x) * Wide(x)) * erfc(Wide(x));
    worst = std::max(worst, std::abs(static_cast<double>((erfcx(x) - exact) / exact)));
  }
  EXPECT_LT(worst, 7e-16);
}

TEST(Erfcx, IsFiniteAtTheEndsOfItsRange) {
  EXPECT_NEAR(erfcx(0.0), 1.0, 4e-16);
  EXPECT_GT(erfcx(1e300), 0.0);
  EXPECT_NEAR(erfcx(1e300) * 1e300, 0.5641895835477563, 1e-15);
  EXPECT_GE(erfcx(std::numeric_limits<double>::max()), 0.0);
}

TEST(CauchyTail, IsExactToAFewUlpOverItsRange) {
  double worst = 0.0;
  for (int i = 0; i <= 98; ++i) {
    const double y = 0.005 * i;
    const auto integrand = [&](const Wide& u) -> Wide {
      const Wide v = 1 + Wide(y) * u * u;
      return u * u * u * u / (v * v * v);
    };
    const Wide exact =
        boost::math::quadrature::gauss<Wide, 30>::integrate(integrand, Wide(0), Wide(1));
    worst =
        std::max(worst, std::abs(static_cast<double>((detail::cauchy_tail(y) - exact) / exact)));
  }
  EXPECT_LT(worst, 5e-16);
}

template <int N>
void expect_exact_rule() {
  for (int degree = 0; degree < 2 * N; ++degree) {
    long double sum = 0.0L;
    for (std::size_t i = 0; i < N; ++i) {
      sum += static_cast<long double>(kUnitRule<N>.weight[i]) *
             std::pow(static_cast<long double>(kUnitRule<N>.node[i]), degree);
    }
    EXPECT_NEAR(static_cast<double>(sum * (degree + 1)), 1.0, 1e-15 * (degree + 1))
        << N << " nodes, degree " << degree;
  }
}

TEST(GaussLegendre, IntegratesPolynomialsExactly) {
  expect_exact_rule<4>();
  expect_exact_rule<8>();
  expect_exact_rule<14>();
  expect_exact_rule<16>();
  expect_exact_rule<20>();
}

}  // namespace
}  // namespace cs2mesh
