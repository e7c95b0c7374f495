// A cube cut in eight again and again, and the cells of its dual grid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "libfield/base/aabb.h"
#include "polygonize/lattice.h"

namespace cs2mesh {

/// Cells by number; the root is 0 and the eight children of a cell follow each other, child i at
/// corner_step(i) of it. A leaf is a cell without children. Each cell has a side: that of the
/// sample in it, if it is a leaf.
class Octree {
 public:
  using Index = std::uint32_t;
  /// Corners are whole multiples of the root's side over 2^kMostLevels.
  static constexpr int kMostLevels = 28;

  struct Cell {
    Index children = 0;  ///< the first; 0 for a leaf
    Int3 corner;         ///< the lowest, in the smallest units there are
    std::uint8_t level = 0;
    bool inside = false;
    bool uniform = true;  ///< every leaf below is on the side of `inside`; see settle_sides()
  };

  Octree(const Vec3d& origin, double side);

  std::size_t size() const { return cells_.size(); }
  const Cell& operator[](Index cell) const { return cells_[cell]; }
  bool is_leaf(Index cell) const { return cells_[cell].children == 0; }
  /// The child at a corner; of a leaf, itself.
  Index child(Index cell, int corner) const {
    const Index first = cells_[cell].children;
    return first == 0 ? cell : first + static_cast<Index>(corner);
  }
  double side(int level) const { return sides_[static_cast<std::size_t>(level)]; }
  /// A corner or other point in the smallest units; rounded to nearest, hence monotone.
  Vec3d point(const Int3& at) const {
    const double unit = side(kMostLevels);
    return {origin_.x + unit * at.x, origin_.y + unit * at.y, origin_.z + unit * at.z};
  }
  Aabb box(Index cell) const {
    const Int3& low = cells_[cell].corner;
    const std::int32_t width = std::int32_t{1} << (kMostLevels - cells_[cell].level);
    return {point(low), point(low + Int3{width, width, width})};
  }
  Vec3d center(Index cell) const { return box(cell).center(); }
  /// The leaf that a point of the root lies in; of others, one as near as its face.
  Index leaf_at(const Vec3d& p) const;

  /// Cuts a leaf above kMostLevels in eight leaves on its side; returns the first.
  Index split(Index leaf);
  /// Cuts leaves, each of them once; returns the first of the first, which those of the others
  /// follow in order. In parallel.
  Index split(std::span<const Index> leaves);
  void set_inside(Index leaf, bool inside) { cells_[leaf].inside = inside; }
  /// Tells all cells above the leaves whether they are uniform. Linear.
  void settle_sides();

 private:
  void set_children(Index leaf, Index first);

  Vec3d origin_;
  std::array<double, kMostLevels + 1> sides_;  ///< by level
  std::vector<Cell> cells_;
};

/// The leaves around a corner of leaves: i lies at corner_step(i) from it. A leaf on whose face or
/// edge the corner lies stands in two or four places.
using DualCell = std::array<Octree::Index, 8>;

/// Bit i tells whether leaf i is inside.
unsigned inside_corners(const Octree& octree, const DualCell& cell);

/// The point that the leaves of a dual cell meet in, in the octree's smallest units.
Int3 meeting_point(const Octree& octree, const DualCell& cell);

/// Every corner of leaves within the root at which not all leaves are on one side, once each, in an
/// order that depends on the octree alone. After settle_sides(). The dual grid is conforming: a
/// face of a dual cell is a face of its neighbour (Schaefer and Warren, "Dual marching cubes:
/// primal contouring of dual grids", 2004).
std::vector<DualCell> mixed_dual_cells(const Octree& octree);
/// Those around which one of the marked cells lies, as for_dual_grid_around() has it.
std::vector<DualCell> mixed_dual_cells(const Octree& octree, const std::vector<bool>& marked);

/// Two leaves that share a part of a face: the ends of an edge of the dual grid.
using DualEdge = std::array<Octree::Index, 2>;

/// A part of the dual grid.
struct DualGrid {
  std::vector<DualCell> cells;
  std::vector<DualEdge> edges;
};

/// Hands over every corner of leaves within the root around which one of the marked cells lies, and
/// every edge of the dual grid of which one is an end, once each, in parts, from any thread and in
/// any order; `marked` holds for each cell whether a leaf in it is marked. The grid as a whole
/// takes more room than the octree.
void for_dual_grid_around(const Octree& octree, const std::vector<bool>& marked,
                          const std::function<void(const DualGrid&)>& take);

}  // namespace cs2mesh
