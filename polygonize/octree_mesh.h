// A first mesh of a surface from an octree that follows it: closed, oriented and 2-manifold, its
// vertices near the surface.
#pragma once

#include <vector>

#include "polygonize/surface_octree.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct OctreeMesh {
  TriangleMesh mesh;
  std::vector<Octree::Index> leaf_of;  ///< for each vertex a leaf it is near, not an empty one
  /// Points of the surface, to the rounding of F, in leaves that it only bulges into, so that no
  /// vertex is near them.
  std::vector<Vec3d> bulges;
  std::size_t evaluations = 0;  ///< jets
};

/// Marching cubes on the dual grid of the octree; a vertex is where F seems to vanish between the
/// centres of two leaves, by the jets at them alone: no better than an estimate.
OctreeMesh mesh_octree(const ImplicitSurface& surface, const SurfaceOctree& tree);

}  // namespace cs2mesh
