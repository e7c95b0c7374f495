#include "polygonize/pareto_front.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/base/check.h"

namespace cs2mesh {

std::vector<bool> pareto_front(std::span<const double> cost, std::span<const double> error) {
  require(cost.size() == error.size(), "pareto_front: as many costs as errors");
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < cost.size(); ++i) {
    if (std::isfinite(cost[i]) && std::isfinite(error[i])) order.push_back(i);
  }
  const auto same = [&](std::size_t a, std::size_t b) {
    return cost[a] == cost[b] && error[a] == error[b];
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cost[a] != cost[b] ? cost[a] < cost[b] : error[a] < error[b];
  });
  std::vector<bool> front(cost.size(), false);
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t i = order[k];
    const bool equal_to_last = k > 0 && same(i, order[k - 1]);
    front[i] = error[i] < best || (equal_to_last && front[order[k - 1]]);
    best = std::min(best, error[i]);
  }
  return front;
}

}  // namespace cs2mesh
