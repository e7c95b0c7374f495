#include "polygonize/octree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <span>
#include <utility>

#include "libfield/base/check.h"

namespace cs2mesh {

Octree::Octree(const Vec3d& origin, double side) : origin_(origin), cells_(1) {
  for (double& s : sides_) s = std::exchange(side, 0.5 * side);
}

/// Makes eight cells that are there its children.
void Octree::set_children(Index leaf, Index first) {
  Cell& parent = cells_[leaf];
  Cell child = parent;
  ++child.level;
  const std::int32_t width = std::int32_t{1} << (kMostLevels - child.level);
  for (int i = 0; i < 8; ++i) {
    child.corner = parent.corner + width * corner_step(i);
    cells_[first + static_cast<Index>(i)] = child;
  }
  parent.children = first;
}

Octree::Index Octree::leaf_at(const Vec3d& p) const {
  Index cell = 0;
  while (!is_leaf(cell)) {
    const Vec3d middle = center(cell);
    const int corner =
        (p.x >= middle.x ? 1 : 0) | (p.y >= middle.y ? 2 : 0) | (p.z >= middle.z ? 4 : 0);
    cell = child(cell, corner);
  }
  return cell;
}

Octree::Index Octree::split(Index leaf) {
  const auto first = static_cast<Index>(cells_.size());
  require(is_leaf(leaf) && cells_[leaf].level < kMostLevels, "Octree: no leaf to split");
  cells_.resize(cells_.size() + 8);
  set_children(leaf, first);
  return first;
}

Octree::Index Octree::split(std::span<const Index> leaves) {
  const auto first = static_cast<Index>(cells_.size());
  for (const Index leaf : leaves) {
    require(is_leaf(leaf) && cells_[leaf].level < kMostLevels, "Octree: no leaf to split");
  }
  cells_.resize(cells_.size() + 8 * leaves.size());
  tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t k) {
    set_children(leaves[k], first + static_cast<Index>(8 * k));
  });
  return first;
}

void Octree::settle_sides() {
  // Children come after their parents.
  for (std::size_t i = cells_.size(); i-- > 0;) {
    Cell& cell = cells_[i];
    cell.uniform = true;
    if (cell.children == 0) continue;
    const auto first = cells_.begin() + cell.children;
    cell.inside = first->inside;
    cell.uniform = std::all_of(first, first + 8, [&](const Cell& child) {
      return child.uniform && child.inside == cell.inside;
    });
  }
}

unsigned inside_corners(const Octree& octree, const DualCell& cell) {
  unsigned inside = 0;
  for (std::size_t i = 0; i < 8; ++i) inside |= (octree[cell[i]].inside ? 1U : 0U) << i;
  return inside;
}

Int3 meeting_point(const Octree& octree, const DualCell& cell) {
  // Of the leaves on the low side some end there, and none before.
  constexpr std::int32_t kFar = std::int32_t{1} << Octree::kMostLevels;
  Int3 point{kFar, kFar, kFar};
  for (int i = 0; i < 8; ++i) {
    const Octree::Cell& leaf = octree[cell[static_cast<std::size_t>(i)]];
    const std::int32_t width = std::int32_t{1} << (Octree::kMostLevels - leaf.level);
    if ((i & 1) == 0) point.x = std::min(point.x, leaf.corner.x + width);
    if ((i & 2) == 0) point.y = std::min(point.y, leaf.corner.y + width);
    if ((i & 4) == 0) point.z = std::min(point.z, leaf.corner.z + width);
  }
  return point;
}

namespace {

/// The walk of Ju, Losasso, Schaefer and Warren ("Dual contouring of Hermite data", 2002, figure 3)
/// down to the corners and faces of leaves. Skips groups of cells between which none is wanted, as
/// skip(cells) tells. What is found in a cell of a few levels down is handed to take(found), which
/// may leave it or clear it.
template <class Skip, class Take>
class DualWalk {
 public:
  using Index = Octree::Index;
  DualWalk(const Octree& octree, const Skip& skip, const Take& take)
      : octree_(octree), skip_(skip), take_(take) {}

  DualGrid found;

  void inside(Index cell) {
    if (octree_.is_leaf(cell) || skip_(std::span(&cell, 1))) return;
    DualCell children;
    for (int i = 0; i < 8; ++i) children[static_cast<std::size_t>(i)] = octree_.child(cell, i);
    if (octree_[cell].level < kParallelLevels) {
      each_aside(children);
    } else {
      for (const Index child : children) inside(child);
    }
    for (unsigned axis = 0; axis < 3; ++axis) {
      const Axes a(axis);
      for (unsigned uv = 0; uv < 4; ++uv) {
        across_face(a, children[a.bits(0, uv)], children[a.bits(1, uv)]);
      }
      for (unsigned s = 0; s < 2; ++s) {
        around_edge(a, {children[a.bits(s, 0)], children[a.bits(s, 1)], children[a.bits(s, 2)],
                        children[a.bits(s, 3)]});
      }
    }
    at_corner(children);
    if (octree_[cell].level == kParallelLevels) take_(found);
  }

 private:
  using Four = std::array<Index, 4>;
  static constexpr int kParallelLevels = 3;

  /// Walks through these cells side by side, and takes over what was found in their order.
  void each_aside(const DualCell& cells) {
    std::array<DualGrid, 8> parts;
    tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
      DualWalk walk(octree_, skip_, take_);
      walk.inside(cells[i]);
      parts[i] = std::move(walk.found);
    });
    for (const DualGrid& part : parts) {
      found.cells.insert(found.cells.end(), part.cells.begin(), part.cells.end());
      found.edges.insert(found.edges.end(), part.edges.begin(), part.edges.end());
    }
  }

  /// An axis and the two after it.
  struct Axes {
    explicit Axes(unsigned axis) : w(axis), u((axis + 1) % 3), v((axis + 2) % 3) {}
    /// The corner at `s` along the axis and at bits 0 and 1 of `uv` along the others.
    unsigned bits(unsigned s, unsigned uv) const {
      return (s << w) | ((uv & 1U) << u) | ((uv >> 1U) << v);
    }
    unsigned w, u, v;
  };

  template <class Cells>
  bool all_leaves(const Cells& cells) const {
    return std::all_of(cells.begin(), cells.end(), [&](Index c) { return octree_.is_leaf(c); });
  }
  Index child(Index cell, unsigned corner) const {
    return octree_.child(cell, static_cast<int>(corner));
  }

  /// Two cells that share a face; `high` follows `low` along the axis.
  void across_face(const Axes& a, Index low, Index high) {
    const std::array<Index, 2> both{low, high};
    if (skip_(std::span<const Index>(both))) return;
    if (all_leaves(both)) {
      found.edges.push_back(both);
      return;
    }
    DualCell around;  // by corner, as seen from the middle of the face
    for (unsigned uv = 0; uv < 4; ++uv) {
      around[a.bits(0, uv)] = child(low, a.bits(1, uv));
      around[a.bits(1, uv)] = child(high, a.bits(0, uv));
      across_face(a, around[a.bits(0, uv)], around[a.bits(1, uv)]);
    }
    for (const unsigned along : {a.u, a.v}) {
      const Axes e(along);
      for (unsigned s = 0; s < 2; ++s) {
        around_edge(e, {around[e.bits(s, 0)], around[e.bits(s, 1)], around[e.bits(s, 2)],
                        around[e.bits(s, 3)]});
      }
    }
    at_corner(around);
  }

  /// Four cells that share an edge along the axis.
  void around_edge(const Axes& a, const Four& cells) {
    if (all_leaves(cells) || skip_(std::span<const Index>(cells))) return;
    DualCell around;
    for (unsigned s = 0; s < 2; ++s) {
      Four half;
      for (unsigned uv = 0; uv < 4; ++uv) half[uv] = child(cells[uv], a.bits(s, 3 - uv));
      for (unsigned uv = 0; uv < 4; ++uv) around[a.bits(s, uv)] = half[uv];
      around_edge(a, half);
    }
    at_corner(around);
  }

  void at_corner(DualCell cells) {
    while (!skip_(std::span<const Index>(cells))) {
      if (all_leaves(cells)) {
        found.cells.push_back(cells);
        return;
      }
      for (unsigned i = 0; i < 8; ++i) cells[i] = child(cells[i], 7 - i);
    }
  }

  const Octree& octree_;
  const Skip& skip_;
  const Take& take_;
};

/// What is not taken on the way.
template <class Skip, class Take>
DualGrid walk(const Octree& octree, const Skip& skip, const Take& take) {
  DualWalk<Skip, Take> walk(octree, skip, take);
  walk.inside(0);
  return std::move(walk.found);
}

void leave(const DualGrid& /*found*/) {}

/// Hands over items in parts of a few, side by side.
template <class Item>
void take_in_parts(const std::vector<Item>& items, std::vector<Item> DualGrid::*kind,
                   const std::function<void(const DualGrid&)>& take) {
  constexpr std::size_t kPart = 1024;
  tbb::parallel_for(std::size_t{0}, (items.size() + kPart - 1) / kPart, [&](std::size_t part) {
    const std::size_t first = kPart * part, last = std::min(first + kPart, items.size());
    DualGrid some;
    (some.*kind)
        .assign(items.begin() + static_cast<std::ptrdiff_t>(first),
                items.begin() + static_cast<std::ptrdiff_t>(last));
    take(some);
  });
}

}  // namespace

namespace {

bool on_one_side(const Octree& octree, std::span<const Octree::Index> cells) {
  const bool side = octree[cells[0]].inside;
  return std::all_of(cells.begin(), cells.end(), [&](Octree::Index c) {
    return octree[c].uniform && octree[c].inside == side;
  });
}

bool none_marked(const std::vector<bool>& marked, std::span<const Octree::Index> cells) {
  return std::none_of(cells.begin(), cells.end(), [&](Octree::Index c) { return marked[c]; });
}

}  // namespace

std::vector<DualCell> mixed_dual_cells(const Octree& octree) {
  return walk(
             octree, [&](auto cells) { return on_one_side(octree, cells); }, leave)
      .cells;
}

std::vector<DualCell> mixed_dual_cells(const Octree& octree, const std::vector<bool>& marked) {
  const auto skip = [&](auto cells) {
    return none_marked(marked, cells) || on_one_side(octree, cells);
  };
  return walk(octree, skip, leave).cells;
}

void for_dual_grid_around(const Octree& octree, const std::vector<bool>& marked,
                          const std::function<void(const DualGrid&)>& take) {
  const auto take_and_clear = [&](DualGrid& found) {
    take(found);
    found = {};
  };
  const DualGrid rest = walk(
      octree, [&](auto cells) { return none_marked(marked, cells); }, take_and_clear);
  take_in_parts(rest.cells, &DualGrid::cells, take);
  take_in_parts(rest.edges, &DualGrid::edges, take);
}

}  // namespace cs2mesh
