// A closed mesh whose triangles can be divided, merged and swapped one at a time; connectivity is
// kept up to date.
#pragma once

#include <array>
#include <vector>

#include "polygonize/half_edges.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Closed, oriented and manifold before and after every operation. Operations are O(1), for bounded
/// valence. Collapsed triangles stay in place until take(), and have no edges.
class EditableMesh {
 public:
  using Index = TriangleMesh::Index;
  /// Of vertices that edges are collapsed from, and into.
  static constexpr std::size_t kMostValence = 24;

  /// Contract: `mesh` is closed, oriented and manifold along its edges.
  explicit EditableMesh(TriangleMesh mesh)
      : mesh_(std::move(mesh)), opposite_(opposite_half_edges(mesh_)) {}

  const TriangleMesh& mesh() const { return mesh_; }
  /// Numbers triangles and their vertices anew, in their order, without what was collapsed and
  /// vertices of no triangle; returns the former number of each vertex. O(n).
  std::vector<Index> close_gaps();
  /// The mesh without gaps; nothing is left here.
  TriangleMesh take();
  HalfEdge opposite(HalfEdge h) const { return opposite_[h]; }
  bool alive(std::size_t triangle) const { return mesh_.triangles[triangle][0] != kGone; }
  void move_vertex(Index v, const Vec3d& p) { mesh_.positions[v] = p; }
  /// Calls f(h) for each half-edge from the vertex that h starts at.
  template <class F>
  void for_ring(HalfEdge h, const F& f) const {
    HalfEdge turn = h;
    do {
      f(turn);
      turn = opposite_[before_in_triangle(turn)];
    } while (turn != h);
  }

  /// Puts a vertex at `p` and joins it to the corners of a triangle, which keeps its number for the
  /// part at its first edge; the other two parts are appended.
  void split_triangle(std::size_t triangle, const Vec3d& p);
  /// Puts a vertex at `p` and makes it the middle of an edge: both triangles at the edge are cut in
  /// two. Each keeps its number for the part at the start of its half-edge; two are appended.
  void split_edge(HalfEdge h, const Vec3d& p);
  /// Whether h, from a to b, can be collapsed: a and b have no neighbours in common but the two
  /// apexes, and each of these and b keep three neighbours.
  bool can_collapse(HalfEdge h) const;
  /// Moves a into b: the two triangles at the edge and a are gone. Contract: can_collapse(h).
  void collapse_edge(HalfEdge h);
  /// Whether the other two corners of the triangles at an edge are not joined yet, and no vertex
  /// would be left with two triangles.
  bool can_flip(HalfEdge h) const;
  /// Joins the other two corners of the triangles at an edge instead of its ends; both triangles
  /// keep their numbers, and h runs along the new edge. False, and nothing done, unless
  /// can_flip(h).
  bool flip_edge(HalfEdge h);

 private:
  static constexpr Index kGone = ~Index{0};
  bool valence_above_three(HalfEdge h) const;
  HalfEdge append(Index a, Index b, Index c);
  void join(HalfEdge a, HalfEdge b);

  TriangleMesh mesh_;
  std::vector<HalfEdge> opposite_;
};

}  // namespace cs2mesh
