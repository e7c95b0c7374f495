// Where the surface can be: the blocks of the lattice that an enclosure of F cannot clear, and F at
// their nodes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/lattice.h"

namespace cs2mesh {

struct NarrowBandOptions {
  double cell = 0.0;                    ///< side of a lattice cell, > 0
  Vec3d origin{};                       ///< a node of the lattice
  std::size_t max_nodes = 400'000'000;  ///< beyond, Failure::limit; 8 bytes each
  Progress* progress = nullptr;
};

/// Blocks of 8^3 cells in which {F = 0} may be ("active"), and F at all of their nodes.
///
/// Promise: F has no zero in the closed box of a block that is not active (as far as
/// ImplicitSurface::enclose is an enclosure), and every node of the closed box of every active
/// block is sampled exactly once. Blocks are numbered the same way for any number of threads: the
/// active ones first (in octree order), then those that merely hold nodes on the upper faces of
/// active ones.
class NarrowBand {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;
  /// Nodes may be moved by this many cells and still be evaluated through the band.
  static constexpr double kMargin = 0.5;

  struct Counts {
    std::size_t blocks_tested = 0;  ///< enclosures asked for, on all levels down to blocks
    std::size_t cubes_tested = 0;   ///< enclosures asked for inside blocks
    std::size_t blocks_active = 0;
    std::size_t nodes_evaluated = 0;
  };

  /// `surface` has finite or empty bounds (else ContractViolation) and outlives the band. Errors:
  /// Failure::limit, Failure::interrupted.
  static Result<NarrowBand> build(const ImplicitSurface& surface, const NarrowBandOptions& options);

  NarrowBand(NarrowBand&&) noexcept;
  NarrowBand& operator=(NarrowBand&&) noexcept;
  ~NarrowBand();

  const Lattice& lattice() const { return lattice_; }
  const Counts& counts() const { return counts_; }
  std::size_t block_count() const { return coords_.size(); }
  /// Blocks 0 .. active_count() - 1 are active.
  std::size_t active_count() const { return counts_.blocks_active; }
  const Int3& coord(std::size_t block) const { return coords_[block]; }
  /// The block at a step of -1, 0 or 1 along each axis, or kNone.
  std::uint32_t neighbour(std::size_t block, const Int3& step) const {
    return neighbours_[block][static_cast<std::size_t>(9 * step.x + 3 * step.y + step.z + 13)];
  }
  bool active(std::uint32_t block) const { return block < counts_.blocks_active; }
  /// F at the 512 nodes that belong to a block, or an infinity of its sign where enclosures tell
  /// that; meaningful for members of sampled(block).
  std::span<const double> values(std::size_t block) const;
  NodeSet sampled(std::size_t block) const;
  Vec3d node_position(std::size_t block, int offset) const {
    return lattice_.node(Lattice::kBlockCells * coords_[block] + local_node(offset));
  }
  /// The active block through whose restriction of F a sampled node is evaluated.
  std::uint32_t evaluator(std::size_t block, int offset) const;
  /// F restricted to the closed box of an active block grown by kMargin cells.
  const ImplicitSurface& surface(std::size_t active_block) const {
    return *surfaces_[active_block];
  }
  /// Jets at `points`, the i-th of which is at most kMargin cells from sampled node offsets[i].
  void jets(std::size_t block, std::span<const std::uint16_t> offsets,
            std::span<const Vec3d> points, std::span<Jet> out) const;
  /// Whether every block whose closed box contains the node is active.
  bool surrounded(std::size_t block, int offset) const;

 private:
  /// The 4^3 cubes of 2^3 cells of an active block, a bit each: whether the enclosure of F over it
  /// excludes 0, and if so, whether F is positive there.
  static constexpr int kCubes = 64;
  struct Clearance {
    std::uint64_t cleared = 0;
    std::uint64_t inside = 0;
  };
  struct Tree;
  struct Candidate;
  struct Kept;
  NarrowBand();
  std::vector<Kept> uncleared(const Candidate& parent, int level) const;
  void collect_blocks();
  void find_neighbours();
  bool sample(Progress* progress);
  void mark_sampled(std::size_t block);
  void clear_cubes(std::size_t active_block);
  double known_sign(std::size_t block, int offset) const;
  void evaluate(std::size_t block, const std::vector<std::uint16_t>& offsets);

  Lattice lattice_;
  Counts counts_;
  std::unique_ptr<Tree> tree_;
  std::vector<Int3> coords_;
  std::vector<std::array<std::uint32_t, 27>> neighbours_;
  std::vector<std::shared_ptr<const ImplicitSurface>> surfaces_;
  std::vector<Clearance> clearances_;  ///< of the active blocks
};

}  // namespace cs2mesh
