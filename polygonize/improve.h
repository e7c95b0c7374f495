// A mesh that is within a tolerance, with fewer triangles and without thin ones where measuring
// allows.
//
// Edges are collapsed and flipped; before any of them, the triangles that would come of it are
// measured, as refine() measures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct ImproveOptions {
  double tolerance = 0.0;  ///< scene units, > 0
  double small = 0.0;      ///< as of RefineOptions
  int most_rounds = 8;
  Progress* progress = nullptr;  ///< cancelled: what is done so far is returned
};

struct ImproveStatistics {
  std::size_t collapses = 0, flips = 0, moves = 0;
  std::size_t refused = 0;  ///< measured, and too far
  /// The keys (triangle_set.h) of triangles that were made and are near as they were measured. Some
  /// may be gone or have been moved since, and have other keys then.
  std::vector<std::uint64_t> near;
};

/// `mesh` is closed, oriented and 2-manifold (else ContractViolation), without attributes, its
/// vertices near the surface. The topology stays as it is, and so do vertices that are kept, but
/// for some of thin triangles, which come to lie on the surface. No triangle is made that is
/// measured to be farther than the tolerance, nor one with an angle below kThinAngle where all were
/// better. The surface around a vertex that is taken out, as the normals tell it, is within the
/// tolerance of the new triangles. Not promised: that the mesh does not cross itself afterwards,
/// nor that no thin triangle is left. Deterministic for any number of threads. Some three
/// jets for each triangle that is tried, more where it is nearly too far.
TriangleMesh improve(const ImplicitSurface& surface, TriangleMesh mesh,
                     const ImproveOptions& options, ImproveStatistics* statistics = nullptr);

}  // namespace cs2mesh
