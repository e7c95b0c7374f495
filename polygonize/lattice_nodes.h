// Signs, jets and places of the lattice nodes next to the surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libfield/base/jet.h"
#include "libfield/base/progress.h"
#include "polygonize/lattice.h"
#include "polygonize/narrow_band.h"

namespace cs2mesh {

/// A block's nodes and one more on every side, as bits: row(x, y) has node z at bit z + 1, for
/// x, y, z in -1 .. 8.
struct PaddedNodes {
  std::uint16_t rows[10][10] = {};
  std::uint16_t row(int x, int y) const { return rows[x + 1][y + 1]; }
  bool contains(int x, int y, int z) const { return (row(x, y) >> (z + 1)) & 1; }
};

/// First-order distance |F| / |grad F| of a node from the surface; 0 where F and its gradient
/// vanish or are not numbers.
double clearance(const Jet& jet);

/// Moves a point that the surface all but passes through to a clear place nearby. Distances are in
/// units of `cell`: a point closer than kNear is moved to about kClear.
class NodeMover {
 public:
  static constexpr double kNear = 0.15;
  static constexpr double kClear = 0.25;
  static constexpr double kFarthest = 0.3;
  /// How many places are tried besides the first.
  static constexpr int kTrials = 16;

  static bool near(const Jet& jet, double cell) { return !(clearance(jet) >= kNear * cell); }
  /// Away from the surface along the gradient.
  static Vec3d first_place(const Vec3d& p, const Jet& jet, double cell);
  /// The i-th of the other places: along the gradient, the axes and the diagonals.
  static Vec3d other_place(const Vec3d& p, const Jet& jet, double cell, int i);
};

/// What the mesher knows of the nodes of a band. A node is *known* if an edge that the surface
/// crosses ends there, or it is a corner of a cell with an ambiguous face; each known node has a
/// jet, and a known node too close to the surface has been moved and its sign taken anew, so that
/// no crossing comes to lie within about kNear cells of a node. A sign changes only where all cells
/// around the node are in active blocks, so every cell at a crossed edge is.
class LatticeNodes {
 public:
  struct Counts {
    std::size_t jets = 0;
    std::size_t moved = 0;
    std::size_t flipped = 0;  ///< whose sign changed with the move
    std::size_t stuck = 0;    ///< for which no clear place was found
  };

  /// `band` outlives the nodes.
  explicit LatticeNodes(const NarrowBand& band);
  /// Finds the known nodes; false if cancelled.
  bool settle(Progress* progress);

  const NarrowBand& band() const { return band_; }
  const Counts& counts() const { return counts_; }
  /// The signs around a block.
  PaddedNodes padded_inside(std::size_t block) const;
  /// Place of any node, known or not.
  Vec3d position(std::size_t block, int offset) const;
  /// Jet of a known node; its value agrees with the sign of the node.
  const Jet& jet(std::size_t block, int offset) const;

 private:
  struct Block {
    NodeSet inside, sampled, known, moved;
    NodeSet wanted;  ///< to become known in this round
    bool changed = true;
    std::vector<Jet> jets;         ///< by rank in known
    std::vector<Vec3d> positions;  ///< by rank in moved
    Counts counts;
  };
  struct Fresh;

  PaddedNodes padded(std::size_t block, NodeSet Block::*set) const;
  NodeSet find_wanted(std::size_t block) const;
  void make_known(std::size_t block, bool may_move);
  void move_near(std::size_t block, Fresh& fresh);
  void merge(Block& block, const Fresh& fresh);

  const NarrowBand& band_;
  std::vector<Block> blocks_;
  Counts counts_;
};

}  // namespace cs2mesh
