// Which results are worth their price.
#pragma once

#include <span>
#include <vector>

namespace cs2mesh {

/// For each point whether it lies on the Pareto front: no other point costs no more and is no
/// farther off and better in one of the two. Equal points are on it together; points of which a
/// coordinate is not finite never are. `cost` and `error` are of one length (ContractViolation).
/// O(n log n).
std::vector<bool> pareto_front(std::span<const double> cost, std::span<const double> error);

}  // namespace cs2mesh
