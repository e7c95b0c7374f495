// A mesh that did not come from an octree, and an octree that follows it: what remesh() needs to
// know where F is asked best.
#pragma once

#include <vector>

#include "polygonize/surface_octree.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct PlacedMesh {
  SurfaceOctree tree;
  TriangleMesh mesh;                   ///< in an order by place (place_order.h)
  std::vector<Octree::Index> leaf_of;  ///< for each vertex the leaf it is in
};

/// `mesh` has cells of that side, as of a lattice, in scene units, > 0, and no attributes; leaves
/// at the surface are one to two cells wide. Nothing is proven of them. Errors: as
/// SurfaceOctree::build(). Some ten evaluations a leaf.
Result<PlacedMesh> place_mesh(const ImplicitSurface& surface, TriangleMesh mesh, double cell,
                              std::size_t max_cells, Progress* progress = nullptr);

}  // namespace cs2mesh
