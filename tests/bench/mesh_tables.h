// Tables of our meshers and the peers at the same measured distance.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tests/bench/trial.h"

namespace cs2mesh::bench {

struct TableRequest {
  Subject subject;
  double tolerance = 0.0;  ///< scene units; < 0: that share of the diagonal, negated
  int threads = 1;         ///< of meshing
  std::vector<const MeshMethod*> methods;  ///< a row each
  std::size_t samples = 200'000;           ///< each way
  double most_seconds = 60.0;              ///< of meshing, for each try of a row
};

/// Prints a table, a row as soon as it is known. Peers get the size with which their measured
/// distance is nearest below the tolerance, as far as a few tries tell; the time is that of this
/// try. False if the scene cannot be read.
bool print_table(const TableRequest& request);

}  // namespace cs2mesh::bench
