// Bounds of sums in the exponent hold for random quadratic exponents, of either curvature.
#include "libfield/field/exponent_sum.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

/// phi0 + g . d + 1/2 d^T A d with the eigenvalues of A between -most and -least.
struct Quadratic {
  Exponent exponent;
  Symmetric3 bend;

  double value(const Vec3d& d) const {
    return exponent.phi + dot(exponent.gradient, d) + 0.5 * dot(bend * d, d);
  }
  Vec3d gradient(const Vec3d& d) const { return exponent.gradient + bend * d; }
};

Quadratic random_quadratic(Random& random) {
  Quadratic q;
  const double scale = std::pow(10.0, random.uniform(-1, 2));
  q.exponent.phi = random.uniform(-10, 10);
  q.exponent.gradient = scale * random.uniform() * random.direction();
  q.exponent.most = random.uniform(-0.5, 1) * scale;
  q.exponent.least = q.exponent.most - random.uniform(0, 2) * scale;
  // Three orthogonal axes with eigenvalues at or between the ends.
  const Vec3d a = random.direction(), b = normalized(cross(a, random.direction())), c = cross(a, b);
  const auto eigenvalue = [&] {
    const double t =
        random.bits() % 2 == 0 ? static_cast<double>(random.bits() % 2) : random.uniform();
    return -(q.exponent.least + t * (q.exponent.most - q.exponent.least));
  };
  q.bend = eigenvalue() * squared(a) + eigenvalue() * squared(b) + eigenvalue() * squared(c);
  return q;
}

Vec3d random_in(Random& random, const Aabb& box) {
  return {random.uniform(box.min.x, box.max.x), random.uniform(box.min.y, box.max.y),
          random.uniform(box.min.z, box.max.z)};
}

TEST(ExponentSum, HoldsWhatIsSampled) {
  Random random(1, 1);
  int convex = 0, rising = 0;
  for (int round = 0; round < 4000; ++round) {
    std::vector<Quadratic> terms;
    const auto count = 1 + random.bits() % 5;
    for (std::size_t i = 0; i < count; ++i) terms.push_back(random_quadratic(random));
    const double half = std::pow(10.0, random.uniform(-3, -0.5));
    const Vec3d edges = half * Vec3d{random.uniform(0.2, 1), random.uniform(0.2, 1), 1.0};
    const BatchBox box(Aabb{-1.0 * edges, edges});
    const Vec3d direction = 2.0 * random.uniform() * random.direction();
    std::vector<Exponent> exponents;
    std::vector<double> slopes;
    for (const Quadratic& term : terms) {
      exponents.push_back(term.exponent);
      slopes.push_back(term.exponent.least_slope(box, direction));
      if (term.exponent.least < 0) ++convex;
    }
    const Interval range = log_range(exponents, box);
    const double least = least_mean_slope(exponents, slopes, box);
    if (least > 0) ++rising;
    for (int k = 0; k < 20; ++k) {
      const Vec3d p = k < 8 ? box.box.corner(k) : random_in(random, box.box);
      double sum = 0.0, slope = 0.0;
      for (std::size_t i = 0; i < terms.size(); ++i) {
        const double value = terms[i].value(p), own = dot(terms[i].gradient(p), direction);
        const double f = std::exp(value);
        sum += f;
        slope += f * own;
        ASSERT_TRUE(exponents[i].range(box).contains(value));
        ASSERT_LE(slopes[i], own + 1e-9 * (1 + std::abs(own)));
      }
      const double slack = 1e-12 * (1 + std::abs(std::log(sum)));
      ASSERT_LE(range.lo, std::log(sum) + slack);
      ASSERT_GE(range.hi, std::log(sum) - slack);
      ASSERT_LE(least, slope / sum + 1e-9 * (1 + std::abs(slope / sum)));
    }
  }
  EXPECT_GT(convex, 1000);
  EXPECT_GT(rising, 300);
}

TEST(ExponentSum, IsOfSecondOrder) {
  Random random(2, 1);
  for (int round = 0; round < 200; ++round) {
    std::vector<Exponent> terms;
    Vec3d mean{};
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      Exponent term;
      term.phi = random.uniform(-2, 2);
      term.gradient = 10.0 * random.direction();
      term.most = 20.0;
      term.least = -20.0;
      mean += std::exp(term.phi) * term.gradient;
      sum += std::exp(term.phi);
      terms.push_back(term);
    }
    mean = mean / sum;
    const double half = 1e-4;
    const BatchBox box(Aabb{{-half, -half, -half}, {half, half, half}});
    const double linear = 2 * half * (std::abs(mean.x) + std::abs(mean.y) + std::abs(mean.z));
    EXPECT_LT(log_range(terms, box).width(), linear + 1e4 * half * half);
  }
}

TEST(ExponentSum, OfNothingIsNothing) {
  const BatchBox box(Aabb{{-1, -1, -1}, {1, 1, 1}});
  EXPECT_EQ(log_range({}, box).hi, -HUGE_VAL);
  EXPECT_EQ(least_mean_slope({}, {}, box), HUGE_VAL);
}

}  // namespace
}  // namespace cs2mesh
