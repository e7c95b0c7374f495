#include "polygonize/topology_proof.h"

#include "libfield/base/check.h"
#include "polygonize/check.h"

namespace cs2mesh {

TopologyProof topology_of(const SurfaceOctree& tree, const OctreeMesh& mesh) {
  TopologyProof proof;
  const Octree& octree = tree.octree();
  for (Octree::Index i = 0; i < octree.size(); ++i) {
    if (octree.is_leaf(i) && tree.kind(i) == LeafKind::open) proof.open.push_back(octree.box(i));
  }
  proof.open.insert(proof.open.end(), tree.crowded_cells().begin(), tree.crowded_cells().end());
  CheckOptions options;
  options.self_intersections = false;
  const MeshReport report = check(mesh.mesh, options);
  proof.components = report.components;
  proof.genus = report.genus;
  return proof;
}

Result<TopologyProof> prove_topology(const ImplicitSurface& surface, double smallest,
                                     Progress* progress) {
  require(smallest > 0, "prove_topology: the smallest side must be positive");
  if (surface.bounds().empty()) return TopologyProof{};
  SurfaceOctreeOptions options;
  // No mesh is to come: cells of any size will do.
  options.tolerance = 1e3 * surface.bounds().diagonal();
  options.smallest = smallest;
  options.progress = progress;
  const Result<SurfaceOctree> tree = SurfaceOctree::build(surface, options);
  if (!tree) return Result<TopologyProof>::failure(tree.diagnostics());
  return topology_of(*tree, mesh_octree(surface, *tree));
}

}  // namespace cs2mesh
