// A mesh of a surface made to fit a tolerance with few and well-shaped triangles: edges collapsed
// and flipped, vertices moved along the surface.
//
// How far a triangle is from the surface is told by the normals at its corners, to second order
// (sagitta.h), so that most of the work asks nothing of F. Lengths are measured by how the surface
// bends (shape_operator.h): there, triangles are to be equilateral, of the size that has the middle
// of each the tolerance off (Botsch and Kobbelt, "A remeshing approach to multiresolution
// modeling", 2004; lengths after Alliez et al., "Anisotropic polygonal remeshing", 2003). Those
// that are too far at last are split, and the error is spread (spread_error.h).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libfield/base/progress.h"
#include "polygonize/surface_octree.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct RemeshOptions {
  double tolerance = 0.0;  ///< scene units, > 0
  int rounds = 3;          ///< of collapsing, flipping and moving
  /// Whether to look for triangles that cross and take them apart, at first and last.
  bool untangle = false;
  /// Whether vertices may be off the surface, by up to 0.8 tolerances, so that it is as far above
  /// triangles as below: outside where it is convex, inside where it is hollow.
  bool balance = false;
  Progress* progress = nullptr;
};

struct RemeshStatistics {
  std::size_t collapses = 0, flips = 0;
  std::size_t jets = 0;
  /// The vertices there were at first, on the surface to a hundredth of the tolerance.
  std::vector<Vec3d> on_surface;
};

/// `mesh` is closed, oriented and 2-manifold (else ContractViolation), without attributes; it comes
/// from `tree`, whose leaf_of[v] is a leaf vertex v is near. Vertices are on the surface of the
/// tree afterwards, as far as Newton's method along the gradient takes them, unless balanced. The
/// topology of the mesh stays as it is. Not promised: that every triangle is within the tolerance.
TriangleMesh remesh(const ImplicitSurface& surface, const SurfaceOctree& tree, TriangleMesh mesh,
                    std::span<const Octree::Index> leaf_of, const RemeshOptions& options,
                    RemeshStatistics* statistics = nullptr);

}  // namespace cs2mesh
