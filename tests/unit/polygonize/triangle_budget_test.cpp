#include "polygonize/triangle_budget.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "libfield/base/check.h"
#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

struct Outcome {
  std::optional<double> tolerance;
  std::vector<double> tried;
};

Outcome search(const TriangleBudget& budget, const TrianglesAt& law) {
  Outcome outcome;
  outcome.tolerance = finest_within(budget, [&](double tolerance) {
    outcome.tried.push_back(tolerance);
    return law(tolerance);
  });
  for (const double t : outcome.tried) {
    EXPECT_GE(t, budget.finest);
    EXPECT_LE(t, budget.coarsest);
    // The finest of those that fit.
    if (law(t) <= budget.most_triangles) {
      EXPECT_LE(outcome.tolerance.value_or(std::numeric_limits<double>::infinity()), t);
    }
  }
  if (outcome.tolerance) {
    EXPECT_LE(law(*outcome.tolerance), budget.most_triangles);
  }
  return outcome;
}

std::size_t smooth(double tolerance) {
  return static_cast<std::size_t>(20 + 300 / tolerance);
}

TEST(TriangleBudget, TheLawOfSmoothSurfacesTakesFewMeshings) {
  for (const std::size_t most : {500U, 5000U, 77777U, 1000000U}) {
    const Outcome found = search({most, 1e-6, 25.0, 2.0}, smooth);
    ASSERT_TRUE(found.tolerance);
    EXPECT_GE(smooth(*found.tolerance), 0.9 * static_cast<double>(most));
    EXPECT_LE(found.tried.size(), 4U) << most;
  }
}

TEST(TriangleBudget, WhatFitsAnywayIsNotMadeCoarser) {
  const Outcome found = search({1000000, 0.01, 25.0, 2.0}, smooth);
  EXPECT_EQ(found.tolerance, 0.01);
  EXPECT_EQ(found.tried.size(), 2U);
  EXPECT_EQ(search({1000000, 3.0, 25.0, 2.0}, smooth).tried, std::vector<double>{3.0});
}

TEST(TriangleBudget, WhatNeverFits) {
  const Outcome found = search({19, 0.01, 25.0, 2.0}, smooth);
  EXPECT_FALSE(found.tolerance);
  EXPECT_EQ(found.tried.back(), 25.0);
  EXPECT_LE(found.tried.size(), 5U);
  // At the very end it does.
  EXPECT_TRUE(search({32, 0.01, 25.0, 2.0}, smooth).tolerance);
}

TEST(TriangleBudget, AJumpIsClosedInOn) {
  const auto jump = [](double tolerance) { return tolerance < 0.7 ? 5000U : 100U; };
  const Outcome found = search({1000, 0.001, 25.0, 2.0, 0.9, 40}, jump);
  ASSERT_TRUE(found.tolerance);
  EXPECT_LE(*found.tolerance, 0.7 * 1.02);
}

TEST(TriangleBudget, OddLawsEndSoonAndFit) {
  Random random(11);
  for (int round = 0; round < 300; ++round) {
    const double power = 2 * random.uniform(), floor = std::exp(8 * random.uniform());
    const double noise = random.uniform();
    const auto law = [&](double tolerance) {
      const double wobble = 1 + noise * std::sin(40 * std::log(tolerance));
      return static_cast<std::size_t>((floor + 500 * std::pow(tolerance, -power)) * wobble);
    };
    const TriangleBudget budget{1 + random.bits() % 20000, 0.001, 25.0, 2.0};
    EXPECT_LE(search(budget, law).tried.size(), 16U);
  }
}

TEST(TriangleBudget, Contracts) {
  EXPECT_THROW(finest_within({10, 0.0, 1.0, 1.0}, smooth), ContractViolation);
  EXPECT_THROW(finest_within({10, 2.0, 1.0, 1.0}, smooth), ContractViolation);
  EXPECT_THROW(finest_within({0, 0.1, 1.0, 1.0}, smooth), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
