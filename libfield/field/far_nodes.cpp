#include "libfield/field/far_nodes.h"

namespace cs2mesh {

double node_factor(double two_nu, int n) {
  double factor = 1.0;
  for (int m = 1; m <= 2 * n; ++m) factor *= (m + two_nu - 1) / m;
  for (int m = 1; m <= n; ++m) {
    const double ratio = static_cast<double>(m) / (n + m);  // (n!)^2 / (2n)!, squared
    factor *= ratio * ratio;
  }
  return factor / (2 * n + 1) * (1 + 1e-12);
}

}  // namespace cs2mesh
