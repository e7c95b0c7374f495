// Closed meshes in which sheets touch along edges or at vertices, taken apart into 2-manifold ones.
#pragma once

#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Takes sheets of a closed, oriented mesh apart where more than two triangles meet at an edge,
/// each direction of which has as many: the triangles are joined in pairs, and each pair gets a
/// vertex in the middle of the edge. Vertices around which triangles do not form one ring are
/// doubled, each copy at the same place. Returns for each appended vertex one that was there
/// before, beside it. The surface stays as it is, point for point; which pairs are joined is not
/// promised. Attributes are not kept. O(n); O(1) beyond a look at the edges if there is nothing to
/// do.
std::vector<TriangleMesh::Index> make_manifold(TriangleMesh& mesh);

}  // namespace cs2mesh
