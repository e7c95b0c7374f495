// Triangles and vertices of a mesh in an order in which neighbours in number are near each other in
// space, so that runs of them are patches, and work along them finds its data in the cache.
#pragma once

#include <cstdint>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// The triangles in the Morton order of their centroids; equal ones in ascending order. Each
/// triangle's corners exist, else undefined. O(n log n).
std::vector<std::uint32_t> triangles_by_place(const TriangleMesh& mesh);

/// Gives the triangles that order, and the vertices the order in which these use them; what no
/// triangle uses follows. Attributes are not moved: the mesh has none (else ContractViolation).
/// Returns the former number of each vertex.
std::vector<TriangleMesh::Index> sort_by_place(TriangleMesh& mesh);

}  // namespace cs2mesh
