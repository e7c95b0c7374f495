// A closed mesh whose triangles can be divided and turned one at a time; connectivity is kept up to
// date.
#pragma once

#include <array>
#include <vector>

#include "polygonize/half_edges.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Closed, oriented and manifold before and after every operation. Operations are O(1),
/// for bounded valence.
class EditableMesh {
 public:
  using Index = TriangleMesh::Index;

  /// Contract: `mesh` is closed, oriented and manifold along its edges.
  explicit EditableMesh(TriangleMesh mesh)
      : mesh_(std::move(mesh)), opposite_(opposite_half_edges(mesh_)) {}

  const TriangleMesh& mesh() const { return mesh_; }
  TriangleMesh take() { return std::move(mesh_); }
  HalfEdge opposite(HalfEdge h) const { return opposite_[h]; }

  /// Puts a vertex at `p` and joins it to the corners of a triangle, which keeps its number for the
  /// part at its first edge; the other two parts are appended.
  void split_triangle(std::size_t triangle, const Vec3d& p);
  /// Puts a vertex at `p` and makes it the middle of an edge: both triangles at the edge are cut in
  /// two. Each keeps its number for the part at the start of its half-edge; two are appended.
  void split_edge(HalfEdge h, const Vec3d& p);
  /// Joins the other two corners of the triangles at an edge instead of its ends; both triangles
  /// keep their numbers. False, and nothing done, where those are joined already, or where a vertex
  /// would be left with two triangles.
  bool flip_edge(HalfEdge h);

 private:
  template <class F>
  void for_each_from(HalfEdge h, const F& f) const;
  HalfEdge append(Index a, Index b, Index c);
  void join(HalfEdge a, HalfEdge b);

  TriangleMesh mesh_;
  std::vector<HalfEdge> opposite_;
};

}  // namespace cs2mesh
