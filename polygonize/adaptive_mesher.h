// The default mesher: an octree by the field's own bounds, a first mesh from its dual grid, then as
// few triangles as the tolerance allows.
#pragma once

#include <cstddef>

#include "polygonize/mesher.h"
#include "polygonize/surface_octree.h"

namespace cs2mesh {

/// What a run did.
struct AdaptiveStatistics {
  SurfaceOctree::Counts octree;
  std::size_t simple_leaves = 0;  ///< proven: one sheet
  std::size_t open_leaves = 0;    ///< not proven at the smallest side
  std::size_t first_triangles = 0;
  std::size_t jets = 0;  ///< after the octree
  int attempts = 0;
};

/// As Mesher::mesh. Where the octree leaves nothing open (statistics->open_leaves == 0), the
/// surface is one sheet in every cell and between cells, and the mesh has a sheet for each.
///
/// Where F jumps or bends by a profile, and where proofs or remeshing fail, the mesh comes from
/// lattices instead (tolerance.h), and is made coarse where that keeps the tolerance.
///
/// Not promised: a proof of the distance, which is measured at points of every triangle, as is that
/// of vertices that were taken out; nor the topology where leaves are open.
Result<MesherResult> mesh_adaptive(const ImplicitSurface& surface, const MesherRequest& request,
                                   AdaptiveStatistics* statistics = nullptr);

}  // namespace cs2mesh
