#include "polygonize/pareto_front.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libfield/base/check.h"
#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

/// The definition, word by word.
std::vector<bool> by_definition(const std::vector<double>& cost, const std::vector<double>& error) {
  std::vector<bool> front;
  for (std::size_t i = 0; i < cost.size(); ++i) {
    bool beaten = !std::isfinite(cost[i]) || !std::isfinite(error[i]);
    for (std::size_t k = 0; k < cost.size(); ++k) {
      beaten = beaten || (cost[k] <= cost[i] && error[k] <= error[i] &&
                          (cost[k] < cost[i] || error[k] < error[i]));
    }
    front.push_back(!beaten);
  }
  return front;
}

TEST(ParetoFront, IsWhatItsDefinitionSays) {
  for (std::uint64_t draw = 0; draw < 300; ++draw) {
    Random random(3, draw);
    std::vector<double> cost, error;
    for (int i = 0; i < 12; ++i) {
      // Few different numbers, so that many are equal.
      cost.push_back(std::floor(6 * random.uniform()));
      error.push_back(std::floor(6 * random.uniform()));
      if (random.uniform() < 0.1) error.back() = std::numeric_limits<double>::infinity();
      if (random.uniform() < 0.1) cost.back() = std::nan("");
    }
    EXPECT_EQ(pareto_front(cost, error), by_definition(cost, error)) << draw;
  }
}

TEST(ParetoFront, OfNothing) {
  const std::vector<double> none, one = {1};
  EXPECT_TRUE(pareto_front(none, none).empty());
  EXPECT_THROW((void)pareto_front(one, none), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
