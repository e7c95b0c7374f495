// Sets of vertices of a mesh, by number.
#pragma once

#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// The vertices that share a triangle with a marked one, and the marked ones. Linear in the mesh.
inline std::vector<bool> widened_by_ring(const TriangleMesh& mesh,
                                         const std::vector<bool>& marked) {
  std::vector<bool> wider = marked;
  for (const auto& t : mesh.triangles) {
    if (!marked[t[0]] && !marked[t[1]] && !marked[t[2]]) continue;
    for (const TriangleMesh::Index v : t) wider[v] = true;
  }
  return wider;
}

}  // namespace cs2mesh
