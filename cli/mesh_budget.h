// --max-triangles: how fine a mesh may be.
#pragma once

#include "cli/mesh_level.h"

namespace cs2mesh {

struct BudgetedMesh {
  Fineness fineness;   ///< as it was asked for, or coarser
  MeshedScene meshed;  ///< to it; united, if that was asked for
};

/// The finest mesh, no finer than `fineness`, that has no more triangles than the request allows,
/// as far as a few meshings find it. Throws Exit, everything having been said, where even a quarter
/// of the scene's diagonal takes more (kLimitReached), and as mesh_parts() and unite_parts() do.
BudgetedMesh mesh_within_budget(const MeshRun& run, const Fineness& fineness);

}  // namespace cs2mesh
