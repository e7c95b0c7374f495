// How time and memory grow with triangles and with primitives.
#pragma once

#include "tests/bench/trial.h"

namespace cs2mesh::bench {

struct GrowthRequest {
  const MeshMethod* method = nullptr;
  double most_triangles = 1e6;   ///< the ladder of tolerances ends about there
  double most_primitives = 1e4;  ///< and that of primitives there
  /// Of meshing, for each run; a ladder ends where a run takes longer.
  double most_seconds = 60.0;
};

/// A scene at finer and finer tolerances, with one thread and with two; time as a power of
/// triangles.
void print_growth_by_triangles(const Subject& subject, const GrowthRequest& request);

/// Surfaces that stay the same while more and more primitives make them; time, compilation
/// included, as a power of primitives.
void print_growth_by_primitives(const GrowthRequest& request);

}  // namespace cs2mesh::bench
