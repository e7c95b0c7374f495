// The surface that separates the leaves of an octree on its two sides: marching cubes on the dual
// grid, without a position.
//
// A dual cell with an ambiguous face is cut into pyramids and tetrahedra around its middle, as the
// lattice mesher's are (cell_table.h). Leaves that stand in several places make edges and faces of
// length 0, which drop out of the polygons: they are on one side, so nothing crosses them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "polygonize/cell_table.h"
#include "polygonize/octree.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Built in steps: construct, ask F at middles(), cross(), place the crossings, triangulate().
class DualSurface {
 public:
  using Index = TriangleMesh::Index;

  /// Where the surface passes between the sample of a leaf and that of another, or a middle.
  struct Crossing {
    static constexpr Index kNone = std::numeric_limits<Index>::max();
    Index leaf = 0;
    Index other = 0;       ///< a leaf of a higher number, if middle is kNone
    Index middle = kNone;  ///< a number into middles()
  };

  /// `octree` has its sides settled and outlives this.
  explicit DualSurface(const Octree& octree);

  /// The points at which the side of F is needed.
  std::span<const Vec3d> middles() const { return middles_; }
  /// Finds the crossings; `inside` holds for each of middles() whether it is inside. Each becomes
  /// the vertex of its number.
  void cross(const std::vector<bool>& inside);
  std::span<const Crossing> crossings() const { return crossings_; }
  /// Triangles over the crossings, counter-clockwise seen from outside; `positions` holds their
  /// places, which decide how polygons are cut. Where every chord of a polygon is an edge already,
  /// a vertex in its middle is appended to `positions`, and to `beside` a crossing of that polygon.
  ///
  /// Closed, oriented and 2-manifold for all sides of leaves, as long as those at the boundary of
  /// the root are outside.
  std::vector<std::array<Index, 3>> triangulate(std::vector<Vec3d>& positions,
                                                std::vector<Index>& beside) const;

 private:
  class Cutting;
  void add_plain(const DualCell& cell, const CellCase& cut);
  void add_split(const DualCell& cell, unsigned inside, Index middle);
  Index vertex_between(Index a, Index b);
  Index vertex_at_middle(Index leaf, Index middle);
  void add_polygon(std::span<const Index> vertices);

  const Octree& octree_;
  std::vector<DualCell> cells_;
  std::vector<Vec3d> middles_;
  std::vector<Crossing> crossings_;
  std::vector<Index> first_of_;  ///< the last crossing found of each leaf
  std::vector<Index> next_;      ///< the one before it, for each crossing
  std::vector<Index> corners_;   ///< of the polygons, one after the other
  std::vector<std::uint8_t> lengths_;
};

}  // namespace cs2mesh
