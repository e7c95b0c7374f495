// An element of a far field as a few weighted points, the nodes of a Gauss-Legendre rule.
#pragma once

#include <array>
#include <vector>

#include "libfield/field/source_tree.h"
#include "libfield/integral/point_sum.h"

namespace cs2mesh {

/// The numbers of nodes that a segment may be replaced by.
inline constexpr std::array<int, 4> kFarNodes = {2, 4, 6, 8};

/// The error of n nodes on a segment of length L and weight 1 at squared distance s, relative to
/// L s^-nu (L^2 / s)^n: (n!)^4 / ((2n + 1) (2n)!^2) binomial(2n + 2 nu - 1, 2n), rounded up.
double node_factor(double two_nu, int n);

/// Appends the element as that many points of the law `law`, which is that of a point of length 1;
/// 1 for a point itself, else one of kFarNodes.
void append_nodes(const FarElement& element, const PointSource& law, int nodes,
                  std::vector<PointSource>& points);

}  // namespace cs2mesh
