// Triangles that are too far from their surface, exchanged for others over the same corners.
#pragma once

#include <cstddef>
#include <span>

#include "polygonize/far_triangles.h"

namespace cs2mesh {

/// Flips edges of the triangles that are `lost` where that leaves none of the two at the edge too
/// far, as far_triangles() measures, or the farther of them nearer than before: one that spans a
/// groove from side to side becomes two along it. No triangle is made that faces away from the
/// surface at its middle. The mesh is closed, oriented and manifold along its edges, before and
/// after; triangles keep their numbers. Returns the number of edges flipped. Not promised: that no
/// triangles cross.
std::size_t flip_far(const ImplicitSurface& surface, TriangleMesh& mesh,
                     std::span<const LostPoint> lost, const FarOptions& options);

}  // namespace cs2mesh
