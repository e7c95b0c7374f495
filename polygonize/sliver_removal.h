// Flat triangles along a crease are removed, so that the mesh outlives the rounding of files.
#pragma once

#include <cstddef>
#include <vector>

#include "polygonize/corefinement.h"

namespace cs2mesh {

/// Removes triangles that are flatter than `height` (the least of their three) and have a vertex
/// marked in `is_open`: their shortest edge is collapsed, or the longest one flipped. No vertex is
/// moved: one that goes is taken for another nearer than two heights, a crease (where tags meet)
/// running through that of the two that is on it. A triangle whose longest edge is flipped takes
/// the tag of its neighbour there.
///
/// `mesh` is closed, oriented and 2-manifold, and stays so; `is_open` has a mark for each vertex
/// and is kept up with the vertices. Returns how many such triangles are left: those that could
/// not go without turning others over. O(n) and O(k log k) for k of them.
std::size_t remove_slivers(TaggedMesh& mesh, std::vector<char>& is_open, double height);

}  // namespace cs2mesh
