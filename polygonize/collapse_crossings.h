// Triangles that cross others, got rid of by collapsing or flipping edges of theirs.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "polygonize/editable_mesh.h"

namespace cs2mesh {

/// Of each pair of triangles that cross, in order, collapses or flips the edge that leaves the
/// fewest crossings around: fewer than there are or, by a collapse, as many. There are no more
/// triangles than before that are folded onto a neighbour. The mesh stays closed, oriented and
/// 2-manifold, and its vertices where they are. Returns how many edges were changed; 0 in a build
/// that cannot tell what crosses. O(n log n) for the mesh and some hundred tests of triangles a
/// pair.
///
/// Not promised: that nothing crosses afterwards, nor that the mesh is as near to the surface as it
/// was.
std::size_t collapse_crossings(EditableMesh& mesh);
/// The same for these pairs of its triangles.
std::size_t collapse_crossings(EditableMesh& mesh,
                               std::span<const std::array<TriangleMesh::Index, 2>> pairs);

}  // namespace cs2mesh
