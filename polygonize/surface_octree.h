// An octree that follows a surface: its leaves are free of the surface, or small enough for the
// tolerance where they hold it and simple there.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/crossing_count.h"
#include "polygonize/octree.h"

namespace cs2mesh {

struct SurfaceOctreeOptions {
  double tolerance = 0.0;  ///< of the mesh to come; scene units, > 0
  /// Cells are not cut below this side, times two; scene units, > 0. Those between whose centres
  /// the surface comes and goes, or seems to have several pieces, a quarter of it.
  double smallest = 0.0;
  /// Cells that may hold surface are cut above this side; scene units, > 0.
  double largest = std::numeric_limits<double>::infinity();
  /// Whether to prove the surface simple. If not, cells are cut by the estimate of the curvature
  /// alone, and leaves are empty or open: for surfaces whose bounds are too dear or too wide.
  bool prove = true;
  /// A cell's side squared, times how much normals turn a length there, is at most so many
  /// tolerances: with 6, an equilateral triangle with such sides stays within the tolerance.
  double coarseness = 6.0;
  /// Once more slopes were asked for than these, and more than eight for each leaf that was shown
  /// simple, proofs fail more than they succeed: cells are not cut below `fair_side` any more,
  /// times two, and what is not proven then is left open. `fair_side`: scene units, > 0.
  std::size_t most_slopes = std::numeric_limits<std::size_t>::max();
  double fair_side = std::numeric_limits<double>::infinity();
  std::size_t max_cells = 200'000'000;
  Progress* progress = nullptr;
};

/// What the surface may be in a leaf.
enum class LeafKind : std::uint8_t {
  empty,   ///< F has no zero in it: proven, or without proof by the look of it
  simple,  ///< proven: F grows all along one direction in it, so the surface is one sheet, a graph
  open,    ///< neither could be shown at the smallest side, or not of a dual cell around it
};

/// An octree over the bounds of a surface, each leaf on the side of F at its centre.
class SurfaceOctree {
 public:
  using Index = Octree::Index;

  using Counts = FieldCounts;

  /// `surface` has finite bounds that are not empty (else ContractViolation) and outlives this.
  /// Errors: Failure::limit, Failure::interrupted. The same octree for any number of threads.
  ///
  /// A cell is cut unless it is empty, or simple and no larger than triangles may be that stay
  /// within the tolerance where the normals turn as they do between it and its siblings. Then cells
  /// are cut between whose centres, that is in dual cells, the surface is not simple or the mesh of
  /// the dual grid would have several pieces, those between whose centres it crosses the straight
  /// way more often than their sides tell, as far as F falls towards zero at both, and those around
  /// which it would have none; so that neither pieces nor gaps thinner than a cell are lost. Not
  /// promised: that the curvature is the largest in the cell, nor a proof of the topology as a
  /// whole (topology_proof.h and certificate.h have that).
  static Result<SurfaceOctree> build(const ImplicitSurface& surface,
                                     const SurfaceOctreeOptions& options);

  /// Cuts the leaves that may hold surface at or near these points in eight each, unless they are
  /// as small as cells may be, and what else is needed for what build() says. Returns how many
  /// leaves near the points were cut. Errors: as build().
  Result<std::size_t> cut_near(std::span<const Vec3d> points);

  const Octree& octree() const { return octree_; }
  const Counts& counts() const { return counts_; }
  /// Whether proofs took too many slopes: then nothing is known of dual cells.
  bool gave_up() const { return gave_up_; }
  LeafKind kind(Index leaf) const { return kinds_[leaf]; }
  /// F at the centre of a leaf that is not empty.
  const Jet& jet(Index leaf) const { return jets_[leaf]; }
  /// F restricted to a box that holds the leaf with a margin of half its side all around.
  const ImplicitSurface& surface_at(Index leaf) const { return *surfaces_[surface_of_[leaf]]; }
  const Aabb& surface_box(Index leaf) const { return surface_boxes_[surface_of_[leaf]]; }
  std::uint32_t surface_number(Index leaf) const { return surface_of_[leaf]; }

 private:
  struct Child;
  struct Opened;
  SurfaceOctree(Octree octree, const SurfaceOctreeOptions& options)
      : options_(options), octree_(std::move(octree)) {}
  Result<Done> settle(std::vector<Index> open, const SurfaceOctreeOptions& options);
  void find_near(Index cell, const Vec3d& point, std::vector<bool>& chosen) const;
  Opened look_into(Index cell, const SurfaceOctreeOptions& options) const;
  void clear_by_enclosure(Index cell, Opened& opened) const;
  void clear_by_distance(Index cell, Opened& opened) const;
  void judge(Index cell, Opened& opened, const SurfaceOctreeOptions& options) const;
  bool refine(std::vector<Index> cells, const SurfaceOctreeOptions& options);
  bool proves_little() const;
  void take(std::span<const Index> cells, std::span<Opened> opened, std::vector<Index>& open);
  std::vector<bool> with_leaves_from(std::size_t first) const;
  std::vector<Index> unclear(std::size_t first_new, const SurfaceOctreeOptions& options);
  void choose_largest(std::span<const Index> leaves, double smallest, std::vector<bool>& chosen);
  std::vector<Index> crowded(std::size_t first_new, const SurfaceOctreeOptions& options);
  bool holds_one_simple_leaf(const DualCell& cell) const;
  bool is_simple(const DualCell& cell, std::size_t& slopes) const;
  bool looks_crossed_as_told(const DualEdge& edge) const;
  bool is_crossed_as_told(const DualEdge& edge, Counts& counts) const;

  SurfaceOctreeOptions options_;
  Octree octree_;
  Counts counts_;
  bool gave_up_ = false;
  std::size_t shown_simple_ = 0;  ///< leaves, also those that were cut later
  std::vector<LeafKind> kinds_;
  std::vector<Jet> jets_;
  std::vector<std::uint32_t> surface_of_;
  std::vector<std::shared_ptr<const ImplicitSurface>> surfaces_;
  std::vector<Aabb> surface_boxes_;
};

}  // namespace cs2mesh
