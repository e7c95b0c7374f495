// The connectivity of a closed mesh: half-edge 3 t + k runs from corner k of triangle t to corner
// (k + 1) % 3.
#pragma once

#include <cstdint>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

using HalfEdge = std::uint32_t;

inline std::size_t triangle_of(HalfEdge h) {
  return h / 3;
}
inline HalfEdge next_in_triangle(HalfEdge h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
inline HalfEdge before_in_triangle(HalfEdge h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}
inline TriangleMesh::Index start_of(const TriangleMesh& mesh, HalfEdge h) {
  return mesh.triangles[h / 3][h % 3];
}
inline TriangleMesh::Index end_of(const TriangleMesh& mesh, HalfEdge h) {
  return start_of(mesh, next_in_triangle(h));
}

/// For each half-edge the one that runs the other way between the same vertices. Contract: the mesh
/// is closed, oriented and manifold along its edges. O(n) for bounded valence.
std::vector<HalfEdge> opposite_half_edges(const TriangleMesh& mesh);

}  // namespace cs2mesh
