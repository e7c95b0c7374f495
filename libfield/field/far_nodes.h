// The error of taking an element of a far field for a few weighted points, the nodes of a
// Gauss-Legendre rule.
#pragma once

namespace cs2mesh {

/// The error of n nodes on a segment of length L and weight 1 at squared distance s, relative to
/// L s^-nu (L^2 / s)^n: (n!)^4 / ((2n + 1) (2n)!^2) binomial(2n + 2 nu - 1, 2n), rounded up.
double node_factor(double two_nu, int n);

/// A number of nodes that an element may be taken as.
struct NodeCount {
  int nodes = 0;
  double factor = 0.0;  ///< node_factor()
};

}  // namespace cs2mesh
