#include "polygonize/placed_mesh.h"

#include <cmath>
#include <utility>

#include "polygonize/place_order.h"

namespace cs2mesh {

Result<PlacedMesh> place_mesh(const ImplicitSurface& surface, TriangleMesh mesh, double cell,
                              std::size_t max_cells, Progress* progress) {
  SurfaceOctreeOptions options;
  options.prove = false;
  options.coarseness = HUGE_VAL;
  options.tolerance = options.largest = options.smallest = 2 * cell;
  options.max_cells = max_cells;
  options.progress = progress;
  Result<SurfaceOctree> tree = SurfaceOctree::build(surface, options);
  if (!tree) return Result<PlacedMesh>::failure(tree.diagnostics());
  sort_by_place(mesh);
  std::vector<Octree::Index> leaf_of;
  leaf_of.reserve(mesh.positions.size());
  for (const Vec3d& p : mesh.positions) leaf_of.push_back(tree->octree().leaf_at(p));
  return PlacedMesh{*std::move(tree), std::move(mesh), std::move(leaf_of)};
}

}  // namespace cs2mesh
