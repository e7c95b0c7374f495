#include "libfield/integral/far_nodes.h"

namespace cs2mesh {

NodeBound node_bound(double two_nu, int n) {
  double binomial = 1.0, leading = 1.0;
  for (int m = 1; m <= 2 * n; ++m) binomial *= (m + two_nu - 1) / m;
  for (int m = 1; m <= n; ++m) {
    const double ratio = 4.0 * m / (n + m);  // 2^2n (n!)^2 / (2n)!, squared
    leading *= ratio * ratio;
  }
  leading /= 2 * n + 1;
  return {n, leading * binomial * (1 + 1e-12), (2 * n + two_nu) / (2 * n + 1),
          32.0 / (15.0 * leading) - 1.0};
}

NodeBounds<kNodeRules.size() - 1> rule_bounds(double two_nu) {
  NodeBounds<kNodeRules.size() - 1> bounds;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    bounds[i] = node_bound(two_nu, static_cast<int>(kNodeRules[i + 1].size));
  }
  return bounds;
}

NodeBounds<kFarNodes.size()> sum_bounds(double two_nu) {
  NodeBounds<kFarNodes.size()> bounds;
  for (std::size_t i = 0; i < bounds.size(); ++i) bounds[i] = node_bound(two_nu, kFarNodes[i]);
  return bounds;
}

}  // namespace cs2mesh
