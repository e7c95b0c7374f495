#include "polygonize/narrow_band.h"

#include <openvdb/Types.h>
#include <openvdb/tree/Tree.h>
#include <openvdb/tree/ValueAccessor.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>

namespace cs2mesh {

/// Node values: one leaf of 8^3 nodes a block; its value mask tells which nodes are sampled, its
/// transient data is the number of the block.
struct NarrowBand::Tree {
  using Type = openvdb::tree::Tree4<double, 5, 4, 3>::Type;
  using Leaf = Type::LeafNodeType;
  Type tree{-1.0};
  std::vector<Leaf*> leaves;

  static openvdb::Coord coord(const Int3& block) {
    return {Lattice::kBlockCells * block.x, Lattice::kBlockCells * block.y,
            Lattice::kBlockCells * block.z};
  }
};

/// A cube that may hold surface, by its parts of 2^level blocks a side.
struct NarrowBand::Candidate {
  std::shared_ptr<const ImplicitSurface> surface;  ///< restricted to the cube
  std::vector<Int3> children;                      ///< in units of their own side
};

/// A child that the enclosure did not clear.
struct NarrowBand::Kept {
  Int3 coord;
  std::shared_ptr<const ImplicitSurface> surface;  ///< restricted to it
};

namespace {

struct BlockRange {
  Int3 lo, hi;  ///< both included
  bool overlaps(const Int3& coord, int level) const {
    const auto meets = [level](std::int32_t c, std::int32_t a, std::int32_t b) {
      return c >= (a >> level) && c <= (b >> level);
    };
    return meets(coord.x, lo.x, hi.x) && meets(coord.y, lo.y, hi.y) && meets(coord.z, lo.z, hi.z);
  }
  /// The smallest level whose cubes cover the range with at most two along each axis.
  int root_level() const {
    int level = 0;
    while ((hi.x >> level) - (lo.x >> level) > 1 || (hi.y >> level) - (lo.y >> level) > 1 ||
           (hi.z >> level) - (lo.z >> level) > 1) {
      ++level;
    }
    return level;
  }
};

Diagnostic limit(const std::string& message) {
  return error_at({}, message, Failure::limit);
}

/// The blocks that cover the box with at least one cell to spare on every side.
Result<BlockRange> block_range(const Aabb& box, const Lattice& lattice) {
  // Twice the range still fits 32 bits, and coordinates keep 22 bits below the cell.
  constexpr double kMostBlocks = 0x1p27;
  BlockRange range;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lo = std::floor(((box.min[axis] - lattice.origin[axis]) / lattice.cell - 1) / 8);
    const double hi = std::floor(((box.max[axis] - lattice.origin[axis]) / lattice.cell + 1) / 8);
    if (!(std::abs(lo) < kMostBlocks && std::abs(hi) < kMostBlocks)) {
      return limit("the cell is too small for the size of the shape");
    }
    (axis == 0 ? range.lo.x : axis == 1 ? range.lo.y : range.lo.z) = static_cast<std::int32_t>(lo);
    (axis == 0 ? range.hi.x : axis == 1 ? range.hi.y : range.hi.z) = static_cast<std::int32_t>(hi);
  }
  return range;
}

/// Not "lo <= 0 && 0 <= hi": an enclosure that is not a number clears nothing.
bool may_hold_zero(const Interval& f) {
  return !(f.lo > 0 || f.hi < 0);
}

/// Keeps `parent` alive without owning it: the root surface belongs to the caller.
std::shared_ptr<const ImplicitSurface> borrowed(const ImplicitSurface& parent) {
  return {std::shared_ptr<const ImplicitSurface>(), &parent};
}

}  // namespace

NarrowBand::NarrowBand() : tree_(std::make_unique<Tree>()) {}
NarrowBand::NarrowBand(NarrowBand&&) noexcept = default;
NarrowBand& NarrowBand::operator=(NarrowBand&&) noexcept = default;
NarrowBand::~NarrowBand() = default;

Result<NarrowBand> NarrowBand::build(const ImplicitSurface& surface,
                                     const NarrowBandOptions& options) {
  require(options.cell > 0 && std::isfinite(options.cell), "NarrowBand: cell must be positive");
  require(is_finite(options.origin), "NarrowBand: origin must be finite");
  NarrowBand band;
  band.lattice_ = {options.origin, options.cell};
  const Aabb box = surface.bounds();
  if (box.empty()) return band;
  require(box.finite(), "NarrowBand: the surface must have finite bounds");
  const Result<BlockRange> range = block_range(box, band.lattice_);
  if (!range) return Result<NarrowBand>::failure(range.diagnostics());

  // Start from the few cubes that cover the bounds.
  int level = range->root_level();
  std::vector<Candidate> parents(1);
  parents[0].surface = borrowed(surface);
  for (std::int32_t x = range->lo.x >> level; x <= range->hi.x >> level; ++x) {
    for (std::int32_t y = range->lo.y >> level; y <= range->hi.y >> level; ++y) {
      for (std::int32_t z = range->lo.z >> level; z <= range->hi.z >> level; ++z) {
        parents[0].children.push_back({x, y, z});
      }
    }
  }

  // Discard what the enclosure clears and cut the rest in eight, down to single blocks.
  const std::size_t most_blocks = options.max_nodes / Lattice::kBlockNodes;
  for (;; --level) {
    std::vector<std::vector<Kept>> kept(parents.size());
    tbb::parallel_for(std::size_t{0}, parents.size(), [&](std::size_t i) {
      if (cancelled(options.progress)) return;
      kept[i] = band.uncleared(parents[i], level);
    });
    if (cancelled(options.progress)) {
      return error_at({}, "interrupted", Failure::interrupted);
    }
    std::vector<Candidate> next;
    for (std::size_t i = 0; i < parents.size(); ++i) {
      band.counts_.blocks_tested += parents[i].children.size();
      for (Kept& cube : kept[i]) {
        if (level == 0) {
          band.coords_.push_back(cube.coord);
          band.surfaces_.push_back(std::move(cube.surface));
          continue;
        }
        Candidate candidate{std::move(cube.surface), {}};
        for (int child = 0; child < 8; ++child) {
          const Int3 coord = 2 * cube.coord + corner_step(child);
          if (range->overlaps(coord, level - 1)) candidate.children.push_back(coord);
        }
        next.push_back(std::move(candidate));
      }
    }
    if (band.coords_.size() > most_blocks || next.size() > most_blocks) {
      return limit("the lattice needs more than " + std::to_string(options.max_nodes) +
                   " nodes; use a larger cell or tolerance");
    }
    if (level == 0) break;
    parents = std::move(next);
  }

  band.collect_blocks();
  band.find_neighbours();
  if (!band.sample(options.progress)) return error_at({}, "interrupted", Failure::interrupted);
  return band;
}

std::vector<NarrowBand::Kept> NarrowBand::uncleared(const Candidate& parent, int level) const {
  const std::int32_t side = std::int32_t{1} << level;
  std::vector<Aabb> boxes;
  for (const Int3& child : parent.children) {
    boxes.push_back(lattice_.block_box(side * child, side));
  }
  std::vector<Interval> ranges(boxes.size());
  parent.surface->enclose_each(boxes, ranges);
  std::vector<Kept> kept;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!may_hold_zero(ranges[i])) continue;
    kept.push_back(
        {parent.children[i], parent.surface->restrict_to(boxes[i].grown(kMargin * lattice_.cell))});
  }
  return kept;
}

/// Makes the leaf of every active block, then those that hold the nodes on their upper faces.
void NarrowBand::collect_blocks() {
  counts_.blocks_active = coords_.size();
  const auto add = [this](const Int3& block) {
    Tree::Leaf* leaf = tree_->tree.touchLeaf(Tree::coord(block));
    leaf->setTransientData(static_cast<openvdb::Index32>(tree_->leaves.size()));
    tree_->leaves.push_back(leaf);
  };
  for (std::size_t i = 0; i < counts_.blocks_active; ++i) add(coords_[i]);
  for (std::size_t i = 0; i < counts_.blocks_active; ++i) {
    for (int step = 1; step < 8; ++step) {
      const Int3 block = coords_[i] + corner_step(step);
      if (tree_->tree.probeConstLeaf(Tree::coord(block)) != nullptr) continue;
      add(block);
      coords_.push_back(block);
    }
  }
}

void NarrowBand::find_neighbours() {
  neighbours_.resize(coords_.size());
  const tbb::blocked_range<std::size_t> all(0, coords_.size(), 64);
  tbb::parallel_for(all, [this](const tbb::blocked_range<std::size_t>& range) {
    openvdb::tree::ValueAccessor<const Tree::Type> accessor(tree_->tree);
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      std::size_t slot = 0;
      for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
          for (int z = -1; z <= 1; ++z) {
            const Int3 block = coords_[i] + Int3{x, y, z};
            const Tree::Leaf* leaf = accessor.probeConstLeaf(Tree::coord(block));
            neighbours_[i][slot++] = leaf == nullptr ? kNone : leaf->transientData();
          }
        }
      }
    }
  });
}

/// A node is sampled if any block whose closed box contains it is active.
void NarrowBand::mark_sampled(std::size_t block) {
  Tree::Leaf& leaf = *tree_->leaves[block];
  if (active(static_cast<std::uint32_t>(block))) {
    leaf.setValuesOn();
    return;
  }
  for (int offset = 0; offset < Lattice::kBlockNodes; ++offset) {
    if (evaluator(block, offset) != kNone) {
      leaf.setValueOn(static_cast<openvdb::Index>(offset));
    }
  }
}

std::uint32_t NarrowBand::evaluator(std::size_t block, int offset) const {
  if (active(static_cast<std::uint32_t>(block))) return static_cast<std::uint32_t>(block);
  const Int3 local = local_node(offset);
  const int on_lower_face =
      (local.x == 0 ? 1 : 0) | (local.y == 0 ? 2 : 0) | (local.z == 0 ? 4 : 0);
  for (int step = 1; step < 8; ++step) {
    if ((step & ~on_lower_face) != 0) continue;
    const std::uint32_t lower = neighbour(block, -1 * corner_step(step));
    if (active(lower)) return lower;
  }
  return kNone;
}

bool NarrowBand::surrounded(std::size_t block, int offset) const {
  if (!active(static_cast<std::uint32_t>(block))) return false;
  const Int3 local = local_node(offset);
  const int on_lower_face =
      (local.x == 0 ? 1 : 0) | (local.y == 0 ? 2 : 0) | (local.z == 0 ? 4 : 0);
  for (int step = 1; step < 8; ++step) {
    if ((step & ~on_lower_face) != 0) continue;
    if (!active(neighbour(block, -1 * corner_step(step)))) return false;
  }
  return true;
}

/// Encloses F over the cubes of a block.
void NarrowBand::clear_cubes(std::size_t active_block) {
  const Int3 base = Lattice::kBlockCells * coords_[active_block];
  std::array<Aabb, kCubes> boxes;
  for (int cube = 0; cube < kCubes; ++cube) {
    const Int3 corner = base + 2 * Int3{cube >> 4, (cube >> 2) & 3, cube & 3};
    boxes[static_cast<std::size_t>(cube)] = {lattice_.node(corner),
                                             lattice_.node(corner + Int3{2, 2, 2})};
  }
  std::array<Interval, kCubes> ranges;
  surfaces_[active_block]->enclose_each(boxes, ranges);
  Clearance& clearance = clearances_[active_block];
  for (std::size_t cube = 0; cube < kCubes; ++cube) {
    if (may_hold_zero(ranges[cube])) continue;
    clearance.cleared |= std::uint64_t{1} << cube;
    if (ranges[cube].lo > 0) clearance.inside |= std::uint64_t{1} << cube;
  }
}

/// An infinity of the sign that all cubes around the node agree on, or 0 where one is not cleared.
/// What lies in blocks that are not active is clear.
double NarrowBand::known_sign(std::size_t block, int offset) const {
  const Int3 local = local_node(offset);
  // Between two cubes along an axis where the coordinate is even.
  const int between =
      (local.x % 2 == 0 ? 1 : 0) | (local.y % 2 == 0 ? 2 : 0) | (local.z % 2 == 0 ? 4 : 0);
  double sign = 0;
  for (int step = 0; step < 8; ++step) {
    if ((step & ~between) != 0) continue;
    const Int3 cell = local + -1 * corner_step(step);
    const Int3 away{cell.x < 0 ? -1 : 0, cell.y < 0 ? -1 : 0, cell.z < 0 ? -1 : 0};
    const std::uint32_t home = neighbour(block, away);
    if (!active(home)) continue;
    const int cube = ((cell.x & 7) / 2 << 4) | ((cell.y & 7) / 2 << 2) | (cell.z & 7) / 2;
    const Clearance& clearance = clearances_[home];
    if (((clearance.cleared >> cube) & 1) == 0) return 0;
    const bool inside = ((clearance.inside >> cube) & 1) != 0;
    sign =
        inside ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
  }
  return sign;
}

/// F at these nodes of a block, each through the restriction of an active block that holds it.
void NarrowBand::evaluate(std::size_t block, const std::vector<std::uint16_t>& offsets) {
  std::vector<std::uint32_t> by(offsets.size());
  for (std::size_t i = 0; i < offsets.size(); ++i) by[i] = evaluator(block, offsets[i]);
  double* values = tree_->leaves[block]->buffer().data();
  std::vector<Vec3d> points;
  std::vector<double> out;
  std::vector<std::uint16_t> batch;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    if (by[i] == kNone) continue;
    const std::uint32_t owner = by[i];
    points.clear();
    batch.clear();
    for (std::size_t j = i; j < offsets.size(); ++j) {
      if (by[j] != owner) continue;
      by[j] = kNone;
      batch.push_back(offsets[j]);
      points.push_back(node_position(block, offsets[j]));
    }
    out.resize(points.size());
    surfaces_[owner]->values(points, out);
    for (std::size_t j = 0; j < batch.size(); ++j) values[batch[j]] = out[j];
  }
}

bool NarrowBand::sample(Progress* progress) {
  std::atomic<std::size_t> nodes{0};
  std::atomic<bool> stopped{false};
  const auto each_block = [&](std::size_t count, auto&& f) {
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t block) {
      if (cancelled(progress)) stopped = true;
      if (!stopped) f(block);
    });
  };
  clearances_.resize(counts_.blocks_active);
  each_block(counts_.blocks_active, [&](std::size_t block) { clear_cubes(block); });
  each_block(coords_.size(), [&](std::size_t block) {
    mark_sampled(block);
    double* values = tree_->leaves[block]->buffer().data();
    std::vector<std::uint16_t> unknown;
    sampled(block).for_each([&](int offset) {
      values[offset] = known_sign(block, offset);
      if (values[offset] == 0) unknown.push_back(static_cast<std::uint16_t>(offset));
    });
    evaluate(block, unknown);
    nodes += unknown.size();
  });
  counts_.nodes_evaluated = nodes;
  counts_.cubes_tested = kCubes * counts_.blocks_active;
  return !stopped;
}

std::span<const double> NarrowBand::values(std::size_t block) const {
  return {std::as_const(*tree_->leaves[block]).buffer().data(), Lattice::kBlockNodes};
}

NodeSet NarrowBand::sampled(std::size_t block) const {
  NodeSet set;
  for (openvdb::Index i = 0; i < 8; ++i) {
    set.word[i] = tree_->leaves[block]->getValueMask().getWord<openvdb::Index64>(i);
  }
  return set;
}

void NarrowBand::jets(std::size_t block, std::span<const std::uint16_t> offsets,
                      std::span<const Vec3d> points, std::span<Jet> out) const {
  require(points.size() == offsets.size() && out.size() == offsets.size(), "NarrowBand::jets");
  if (active(static_cast<std::uint32_t>(block))) {
    surfaces_[block]->jets(points, out);
    return;
  }
  std::vector<std::uint32_t> by(offsets.size());
  for (std::size_t i = 0; i < offsets.size(); ++i) by[i] = evaluator(block, offsets[i]);
  std::vector<std::size_t> batch;
  std::vector<Vec3d> batch_points;
  std::vector<Jet> batch_out;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    if (by[i] == kNone) continue;
    const std::uint32_t owner = by[i];
    batch.clear();
    batch_points.clear();
    for (std::size_t j = i; j < offsets.size(); ++j) {
      if (by[j] != owner) continue;
      by[j] = kNone;
      batch.push_back(j);
      batch_points.push_back(points[j]);
    }
    batch_out.resize(batch.size());
    surfaces_[owner]->jets(batch_points, batch_out);
    for (std::size_t j = 0; j < batch.size(); ++j) out[batch[j]] = batch_out[j];
  }
}

}  // namespace cs2mesh
