// Cutting triangles of a closed mesh through the middles of edges: with an edge the longest edge of
// each triangle at it, and so on (Rivara 1984), which keeps angles from shrinking. An edge is cut
// for both of its triangles, so the mesh stays closed, oriented and 2-manifold.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "polygonize/half_edges.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Which edges of a mesh to cut, and the triangles that come of it. The mesh outlives this, and its
/// triangles stay; vertices may be appended.
class LongestEdgeCuts {
 public:
  using Index = TriangleMesh::Index;
  static constexpr Index kNone = ~Index{0};

  /// Contract: the mesh is closed, oriented and manifold along its edges. O(n).
  explicit LongestEdgeCuts(const TriangleMesh& mesh);

  /// Each edge goes by the lower of its half-edges.
  HalfEdge edge_of(HalfEdge h) const { return std::min(h, opposite_[h]); }
  HalfEdge opposite(HalfEdge h) const { return opposite_[h]; }
  double squared_length(HalfEdge h) const;
  Vec3d middle(HalfEdge h) const;
  /// Of equals the same one for both triangles beside it.
  HalfEdge longest_edge(std::size_t triangle) const;

  /// Marks an edge to be cut.
  void mark(HalfEdge h) { marked_[edge_of(h)] = 1; }
  /// Marks the longest edge of each triangle that has a marked one, and so on. Returns all that are
  /// marked, ascending.
  std::vector<HalfEdge> close();

  /// The new vertices of marked edges, by edge; an edge that has none stays whole.
  std::vector<Index> middle_of;

  /// The triangles in the order of those that they are parts of, whose numbers come in `whole`.
  std::vector<std::array<Index, 3>> parts(std::vector<std::uint32_t>* whole = nullptr) const;

 private:
  struct Piece;
  template <class F>
  void for_each_part(const Piece& piece, const F& f) const;

  const TriangleMesh& mesh_;
  std::vector<HalfEdge> opposite_;
  std::vector<char> marked_;  ///< by edge
};

/// A mesh whose triangles are cut, but lie where they were: it is the same set of points, but for
/// the rounding of the new vertices.
struct FlatParts {
  TriangleMesh mesh;
  std::vector<std::uint32_t> whole;  ///< of each triangle, the one that it is a part of
};

/// Cuts the sides of these triangles in halves, and what else it takes. Vertices keep their
/// numbers, new ones come behind them; attributes are left out. Contract: as LongestEdgeCuts. O(n).
FlatParts cut_flat(const TriangleMesh& mesh, const std::vector<std::uint32_t>& triangles);

}  // namespace cs2mesh
