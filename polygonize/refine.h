// Local refinement of a mesh against its surface: edges are split where the mesh is too far away,
// and the new vertices put on the surface.
//
// Each round looks at every new triangle, as far_triangles() does: where bounds of F are cheap most
// are proven to be near, of the others a few points tell. The longest edge of each triangle that is
// too far is split, and with an edge the longest edge of each triangle at it (Rivara 1984),
// which keeps angles from shrinking. An edge is split for both of its triangles, so the mesh stays
// closed, oriented and 2-manifold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/lost_point.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct RefineOptions {
  double tolerance = 0.0;  ///< scene units, > 0
  int most_rounds = 10;
  /// Triangles smaller than this are looked at in more places, as where the surface has features
  /// not much larger than the tolerance.
  double small = 0.0;
  /// Triangles without a vertex of this number or above are known to be near enough, but for those
  /// that have to be nearer.
  TriangleMesh::Index first_new = 0;
  /// If set, the only triangles that the first round looks at; later ones at what is new.
  const std::vector<std::uint32_t>* first_looked_at = nullptr;
  /// If set, by number the vertices around which the mesh has to be nearer to the surface, as where
  /// its sheets come close: triangles between them within `closer`, scene units, > 0.
  const std::vector<bool>* close = nullptr;
  double closer = 0.0;
  std::size_t max_triangles = 50'000'000;  ///< no round begins above
  Progress* progress = nullptr;            ///< cancelled: what is done so far is returned
};

struct RefineStatistics {
  int rounds = 0;
  std::size_t splits = 0;
  /// Edges that were too far away but kept, since the mesh would have been folded there, or since
  /// no surface was found within their length of their middle.
  std::size_t kept = 0;
  /// The triangles that are too far for all that, among those that were looked at: all but the ones
  /// that the last of most_rounds made, which have a vertex of the number `first_unseen` or above.
  std::vector<LostPoint> far;
  TriangleMesh::Index first_unseen = std::numeric_limits<TriangleMesh::Index>::max();
};

/// `mesh` is closed, oriented and manifold along its edges (else ContractViolation, as soon as
/// anything is to be split), without
/// attributes, its vertices near the surface. Vertices of it stay as they are; new ones lie on the
/// surface to the rounding of F. Distances are those of the first order, |F| / |grad F|.
///
/// Not promised: that every triangle is within the tolerance (it is measured at points, and
/// rounds are limited), nor that no triangles intersect where the surface turns within an edge.
/// About three jets a triangle, or one and a value where it is proven, and six a new vertex.
TriangleMesh refine(const ImplicitSurface& surface, TriangleMesh mesh, const RefineOptions& options,
                    RefineStatistics* statistics = nullptr);

}  // namespace cs2mesh
