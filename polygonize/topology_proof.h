// How many components a surface can have at most, proven by an octree.
//
// In each leaf F either keeps its sign, or grows all over it along some direction, so that it has
// no critical point there; leaves too small to be cut for which neither is shown are open. A
// bounded region in which F keeps its sign has an extremum of F inside, so it holds all of some
// leaf of the first kind, or reaches into an open one. Leaves of one sign that touch lie in one
// region; and so does what a path leads to along which F grows, leaf by leaf in the direction of
// each. So, but for what is in open leaves, there are no more regions than classes of leaves
// joined that way (and by whatever else is known), and one component of the surface less than
// regions: closed surfaces part space so.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/disjoint_sets.h"
#include "polygonize/octree.h"

namespace cs2mesh {

class TopologyProof {
 public:
  struct Options {
    double smallest = 0.0;  ///< cells are not cut below this side, times two; scene units, > 0
    std::size_t max_cells = 50'000'000;
    Progress* progress = nullptr;
  };

  /// Points where F does not vanish, and pairs of them that are known to be in one region.
  struct KnownPoints {
    std::vector<Vec3d> points;
    std::vector<bool> inside;  ///< F > 0
    std::vector<std::array<std::uint32_t, 2>> together;
  };

  /// Where one region may be, for all that is known apart from the others.
  struct Region {
    Aabb leaf;             ///< its largest
    bool known = false;    ///< one of the known points is in it
    bool outside = false;  ///< it reaches beyond the bounds of the surface
  };

  /// The surface has finite bounds. Errors: Failure::limit, Failure::interrupted. Some 2 us a leaf
  /// near the surface for sums with bounds in the exponent.
  static Result<TopologyProof> build(const ImplicitSurface& surface, const Options& options);

  /// All regions there can be, but for those within open leaves; `outside` comes first. Paths step
  /// over faces by 1e-12 of the root's side, which is taken to change no sign.
  std::vector<Region> regions(const KnownPoints& known) const;
  /// The open leaves.
  const std::vector<Aabb>& open() const { return open_; }

 private:
  using Index = Octree::Index;
  enum class Kind : std::uint8_t { keeps_sign, grows, open };

  explicit TopologyProof(Octree octree) : octree_(std::move(octree)) {}
  bool cut(Index cell, const ImplicitSurface& part, const Options& options);
  bool keeps_sign(Index leaf) const {
    return octree_.is_leaf(leaf) && kinds_[leaf] == Kind::keeps_sign;
  }
  std::optional<Index> neighbour(Index leaf, const Int3& step) const;
  std::optional<Index> leaf_around(const Vec3d& point) const;
  std::uint32_t climb(Vec3d point, bool inside) const;
  void join_leaves(DisjointSets& sets) const;
  std::uint32_t outside() const { return static_cast<std::uint32_t>(octree_.size()); }
  static constexpr std::uint32_t kNowhere = ~std::uint32_t{0};

  Octree octree_;
  std::vector<Kind> kinds_;
  std::vector<Vec3d> directions_;  ///< along which F grows in a leaf
  std::vector<Aabb> open_;
};

}  // namespace cs2mesh
