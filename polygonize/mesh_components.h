// The connected pieces of a mesh: how large they are, which way round, and what they go round.
#pragma once

#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// A piece of a mesh that is connected through vertices.
struct MeshComponent {
  std::vector<TriangleMesh::Index> triangles;  ///< ascending, at least one
  Aabb box;
  double area = 0.0;
  double volume = 0.0;  ///< enclosed, if it is closed; negative where it is wound inwards
  /// The volume is negative beyond what rounding can do to it: the wall of a void, where the mesh
  /// bounds a solid.
  bool inwards = false;
};

/// The components, in the order of their first triangles. Indices of triangles are in range;
/// vertices without a triangle are left out. Nearly O(n).
std::vector<MeshComponent> components(const TriangleMesh& mesh);

/// How often a closed mesh goes round a point, 0 or 1 for the boundary of a solid: the sum of the
/// solid angles of its triangles (van Oosterom and Strackee 1983) over 4 pi. A whole number to
/// rounding, unless the point lies on the mesh. O(n).
double winding_number(const TriangleMesh& mesh, const Vec3d& p);
/// The same of one of its components.
double winding_number(const TriangleMesh& mesh, const MeshComponent& component, const Vec3d& p);

/// Appends the triangles of `mesh` that are chosen, in that order, with the vertices they need and
/// without attributes. O(vertices of `mesh` + chosen).
void append_triangles(TriangleMesh& to, const TriangleMesh& mesh,
                      const std::vector<TriangleMesh::Index>& chosen);

/// Keeps the triangles that are marked, one mark a triangle, in their order, and the vertices they
/// need. Attributes are lost. O(n).
void keep_triangles(TriangleMesh& mesh, const std::vector<char>& kept);

}  // namespace cs2mesh
