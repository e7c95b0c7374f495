// What is proven of a surface's topology by the octree that follows it.
#pragma once

#include <cstddef>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/octree_mesh.h"
#include "polygonize/surface_octree.h"

namespace cs2mesh {

/// Where every cell and every dual cell of an octree holds one sheet of the surface or nothing, the
/// mesh of the dual grid has a component of the same genus for each of the surface's.
struct TopologyProof {
  std::size_t components = 0;  ///< of that mesh
  long long genus = 0;         ///< of all of them together
  /// The cells of which that could not be shown.
  std::vector<Aabb> open;
};

/// What a tree that was built with proof, and its mesh, say.
TopologyProof topology_of(const SurfaceOctree& tree, const OctreeMesh& mesh);

/// Builds an octree for no other purpose, with cells no smaller than `smallest` > 0, in scene
/// units. Errors: those of SurfaceOctree::build.
Result<TopologyProof> prove_topology(const ImplicitSurface& surface, double smallest,
                                     Progress* progress = nullptr);

}  // namespace cs2mesh
