#include "polygonize/surface_octree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <span>
#include <utility>

#include "libfield/base/check.h"
#include "polygonize/cell_table.h"
#include "polygonize/crossing_count.h"
#include "polygonize/grower.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

/// Leaves that may hold surface are of this level at least, so that the centres of the outermost
/// leaves are in the air around the bounds.
constexpr int kLeastLevel = 4;
/// Restrictions reach this far beyond their cell, in its sides: a hair more than to the centres of
/// neighbours as large as its children, so that dual cells lie within.
constexpr double kMargin = 0.25 * (1 + 1e-9);

/// Of the smallest side: how far cells are cut between whose centres the surface comes and goes, or
/// seems to have several pieces. A channel through an edge is thinner than a cell, and they are
/// few.
constexpr double kBelow = 0.25;

/// Not "lo <= 0 && 0 <= hi": an enclosure that is not a number clears nothing.
bool may_hold_zero(const Interval& f) {
  return !(f.lo > 0 || f.hi < 0);
}

/// Whether a cell of that side suits normals that turn by `turn` a length. (The triangles of the
/// first mesh have shorter edges. Where the surface turns within less than a side, as in a groove,
/// `turn` is an average, and so is this.)
bool fits(double side, double turn, const SurfaceOctreeOptions& options) {
  return turn * side * side <= options.coarseness * options.tolerance;
}

/// The cube in which the octree begins: the bounds with room for a leaf of air around, and off
/// their middle, for symmetric shapes have their singular places there.
Octree root_around(const Aabb& box) {
  const Vec3d extent = box.extent();
  const double width = std::max({extent.x, extent.y, extent.z});
  const double side = 1.2 * width;
  const Vec3d shift{0.5 * (side - extent.x) - 0.0137 * side,
                    0.5 * (side - extent.y) - 0.0219 * side,
                    0.5 * (side - extent.z) - 0.0171 * side};
  return {box.min - shift, side};
}

}  // namespace

/// A child of a cell that was cut.
struct SurfaceOctree::Child {
  Jet jet;
  LeafKind kind = LeafKind::empty;
  bool inside = false;
  bool cut = false;
};

/// A cell that was cut.
struct SurfaceOctree::Opened {
  std::array<Child, 8> children;
  std::shared_ptr<const ImplicitSurface> surface;
  Aabb surface_box;
  Counts counts;
};

namespace {

/// The boxes of the children.
std::array<Aabb, 8> parts(const Octree& octree, Octree::Index cell) {
  const Octree::Cell& parent = octree[cell];
  const std::int32_t width = std::int32_t{1} << (Octree::kMostLevels - parent.level - 1);
  std::array<Aabb, 8> boxes;
  for (int i = 0; i < 8; ++i) {
    const Int3 low = parent.corner + width * corner_step(i);
    boxes[static_cast<std::size_t>(i)] = {octree.point(low),
                                          octree.point(low + Int3{width, width, width})};
  }
  return boxes;
}

/// The direction in which F grows; zero where it is level.
Vec3d way_up(const Jet& jet) {
  const double slope = norm_of_any(jet.gradient);
  return slope > 0 ? jet.gradient / slope : Vec3d{};
}

/// The direction in which F grows in the middle of a box, whose jet that is. Where it is level
/// there, as beyond the edge of a finite support, the one in which it grows at the corners all
/// together; zero where it is level at all of them.
Vec3d way_up(const ImplicitSurface& surface, const Aabb& box, const Jet& middle) {
  const Vec3d direction = way_up(middle);
  if (direction != Vec3d{}) return direction;
  std::array<Vec3d, 8> corners;
  for (int i = 0; i < 8; ++i) corners[static_cast<std::size_t>(i)] = box.corner(i);
  std::array<Jet, 8> jets;
  surface.jets(corners, jets);
  Vec3d sum{};
  for (const Jet& jet : jets) sum += way_up(jet);
  const double length = norm(sum);
  return length > 0 ? sum / length : Vec3d{};
}

/// How much normals turn a length between the centre of one child and those of the others, or that
/// of the parent; nothing where one is not known.
double turn_between(const Vec3d& normal, const Vec3d& at, const Vec3d& other_normal,
                    const Vec3d& other) {
  if (normal == Vec3d{} || other_normal == Vec3d{}) return 0.0;
  return norm(normal - other_normal) / norm(at - other);
}

}  // namespace

SurfaceOctree::Opened SurfaceOctree::look_into(Index cell,
                                               const SurfaceOctreeOptions& options) const {
  Opened opened;
  const Aabb whole = octree_.box(cell);
  const double side = octree_.side(octree_[cell].level);
  opened.surface_box = whole.grown(kMargin * side);
  opened.surface = surface_at(cell).restrict_to(opened.surface_box);
  // Without proof, the jets alone tell of small cells which the surface seems to be far from.
  if (options.prove || side > 4 * options.largest) {
    clear_by_enclosure(cell, opened);
  } else {
    clear_by_distance(cell, opened);
  }
  judge(cell, opened, options);
  return opened;
}

void SurfaceOctree::clear_by_enclosure(Index cell, Opened& opened) const {
  const std::array<Aabb, 8> boxes = parts(octree_, cell);
  std::array<Interval, 8> ranges;
  opened.surface->enclose_each(boxes, ranges);
  opened.counts.enclosures = 8;
  std::array<Vec3d, 8> centers;
  std::array<std::size_t, 8> active{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    if (may_hold_zero(ranges[i])) {
      centers[count] = boxes[i].center();
      active[count++] = i;
    } else {
      opened.children[i].inside = ranges[i].lo > 0;
    }
  }
  std::array<Jet, 8> jets;
  opened.surface->jets(std::span(centers).first(count), std::span(jets).first(count));
  opened.counts.values = opened.counts.gradients = count;
  for (std::size_t k = 0; k < count; ++k) {
    opened.children[active[k]] = {jets[k], LeafKind::open, jets[k].value >= 0};
  }
}

void SurfaceOctree::clear_by_distance(Index cell, Opened& opened) const {
  constexpr double kFar = 1.5;  // half diagonals
  const std::array<Aabb, 8> boxes = parts(octree_, cell);
  std::array<Vec3d, 8> centers;
  for (std::size_t i = 0; i < 8; ++i) centers[i] = boxes[i].center();
  std::array<Jet, 8> jets;
  opened.surface->jets(centers, jets);
  opened.counts.values = opened.counts.gradients = 8;
  for (std::size_t i = 0; i < 8; ++i) {
    const double distance = first_order_distance(jets[i], std::numeric_limits<double>::infinity());
    const bool far = distance > 0.5 * kFar * boxes[i].diagonal();
    opened.children[i] = {jets[i], far ? LeafKind::empty : LeafKind::open, jets[i].value >= 0};
  }
}

/// Decides which of the children that may hold surface are to be cut.
void SurfaceOctree::judge(Index cell, Opened& opened, const SurfaceOctreeOptions& options) const {
  const std::array<Aabb, 8> boxes = parts(octree_, cell);
  const double side = octree_.side(octree_[cell].level + 1);
  const bool may_cut =
      side >= 2 * options.smallest && octree_[cell].level + 1 < Octree::kMostLevels;
  if (octree_[cell].level + 1 < kLeastLevel && may_cut) {
    for (Child& child : opened.children) child.cut = child.kind != LeafKind::empty;
    return;
  }
  const Vec3d middle = octree_.center(cell);
  const Vec3d parent_normal = way_up(*opened.surface, octree_.box(cell), jets_[cell]);
  std::array<Vec3d, 8> normals{};
  for (std::size_t i = 0; i < 8; ++i) {
    const Child& child = opened.children[i];
    if (child.kind != LeafKind::empty) normals[i] = way_up(*opened.surface, boxes[i], child.jet);
  }
  for (std::size_t i = 0; i < 8; ++i) {
    Child& child = opened.children[i];
    if (child.kind == LeafKind::empty) continue;
    const Vec3d& normal = normals[i];
    const Vec3d at = boxes[i].center();
    double turn = turn_between(normal, at, parent_normal, middle);
    for (std::size_t j = 0; j < 8; ++j) {
      if (j != i) turn = std::max(turn, turn_between(normal, at, normals[j], boxes[j].center()));
    }
    const bool small = octree_[cell].level + 1 >= kLeastLevel && side <= options.largest &&
                       fits(side, turn, options);
    // Along its normal at the centre, so that the surface turns by less than a right angle from
    // there: triangles across a groove would be too hard to mend.
    const bool prove = options.prove && !gave_up_;
    if (prove && (small || !may_cut)) {
      Grower grower{*opened.surface, normal};
      if (grower.grows_along(boxes[i])) child.kind = LeafKind::simple;
      opened.counts.slopes += grower.slopes;
    }
    const bool done = !prove || child.kind == LeafKind::simple;
    child.cut = may_cut && !(small && done);
  }
}

/// Cuts these leaves as they were opened; appends those of their children that are to be cut. Takes
/// over what was opened.
void SurfaceOctree::take(std::span<const Index> cells, std::span<Opened> opened,
                         std::vector<Index>& open) {
  const auto number = static_cast<std::uint32_t>(surfaces_.size());
  const Index first = octree_.split(cells);
  kinds_.resize(octree_.size());
  jets_.resize(octree_.size());
  surface_of_.resize(octree_.size());
  surfaces_.resize(number + cells.size());
  surface_boxes_.resize(number + cells.size());
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t k) {
    surfaces_[number + k] = std::move(opened[k].surface);
    surface_boxes_[number + k] = opened[k].surface_box;
    for (std::size_t i = 0; i < 8; ++i) {
      const Child& child = opened[k].children[i];
      const Index index = first + static_cast<Index>(8 * k + i);
      octree_.set_inside(index, child.inside);
      kinds_[index] = child.kind;
      jets_[index] = child.jet;
      surface_of_[index] = number + static_cast<std::uint32_t>(k);
    }
  });
  for (std::size_t k = 0; k < cells.size(); ++k) {
    for (std::size_t i = 0; i < 8; ++i) {
      const Child& child = opened[k].children[i];
      if (child.kind == LeafKind::simple) ++shown_simple_;
      if (child.cut) open.push_back(first + static_cast<Index>(8 * k + i));
    }
    counts_ += opened[k].counts;
  }
}

bool SurfaceOctree::proves_little() const {
  constexpr std::size_t kMostEach = 8;
  return counts_.slopes > std::max(options_.most_slopes, kMostEach * shown_simple_);
}

/// Cuts these leaves and what is to be cut of them; false if cancelled or too many.
bool SurfaceOctree::refine(std::vector<Index> cells, const SurfaceOctreeOptions& options) {
  constexpr std::size_t kAtOnce = 8192;
  while (!cells.empty()) {
    if (octree_.size() + 8 * cells.size() > options.max_cells) return false;
    std::vector<Index> next;
    std::vector<Opened> opened(std::min(kAtOnce, cells.size()));
    for (std::size_t first = 0; first < cells.size(); first += kAtOnce) {
      const auto some =
          std::span<const Index>(cells).subspan(first, std::min(kAtOnce, cells.size() - first));
      tbb::parallel_for(std::size_t{0}, some.size(), [&](std::size_t i) {
        if (!cancelled(options.progress)) opened[i] = look_into(some[i], options);
      });
      if (cancelled(options.progress)) return false;
      take(some, std::span(opened).first(some.size()), next);
    }
    if (proves_little()) {
      gave_up_ = true;
      options_.smallest = std::max(options_.smallest, options_.fair_side);
      std::erase_if(next, [this](Index leaf) {
        return octree_.side(octree_[leaf].level) < 2 * options_.smallest;
      });
    }
    cells = std::move(next);
  }
  return true;
}

namespace {

/// The numbers that are chosen.
std::vector<Octree::Index> numbers_of(const std::vector<bool>& chosen) {
  std::vector<Octree::Index> found;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (chosen[i]) found.push_back(static_cast<Octree::Index>(i));
  }
  return found;
}

}  // namespace

/// Chooses the largest of these leaves, of those that may hold surface, to be cut. If they may not
/// be, all are open.
void SurfaceOctree::choose_largest(std::span<const Index> leaves, double smallest,
                                   std::vector<bool>& chosen) {
  int level = Octree::kMostLevels;
  for (const Index leaf : leaves) {
    if (kinds_[leaf] != LeafKind::empty) level = std::min<int>(level, octree_[leaf].level);
  }
  const bool small = level >= Octree::kMostLevels || octree_.side(level) < 2 * smallest;
  for (const Index leaf : leaves) {
    if (kinds_[leaf] == LeafKind::empty) continue;
    if (small) kinds_[leaf] = LeafKind::open;
    if (!small && octree_[leaf].level == level) chosen[leaf] = true;
  }
}

/// For each cell whether a leaf in it has that number, the first of some siblings, or a higher one.
std::vector<bool> SurfaceOctree::with_leaves_from(std::size_t first) const {
  std::vector<bool> marked(octree_.size(), true);
  // Children come after their parents.
  for (std::size_t i = first; i-- > 0;) {
    const auto cell = static_cast<Index>(i);
    marked[i] = false;
    if (octree_.is_leaf(cell)) continue;
    const Index child = octree_.child(cell, 0);
    for (Index c = child; c < child + 8 && !marked[i]; ++c) marked[i] = marked[c];
  }
  return marked;
}

/// The largest leaves of dual cells that the surface seems to cut in several pieces, of those
/// around leaves from `first_new` on; without proof also leaves that may hold surface while all
/// leaves around are on their side. (A sheet leaves such a leaf as it came, so the mesh misses a
/// bump, not a piece.)
std::vector<SurfaceOctree::Index> SurfaceOctree::unclear(std::size_t first_new,
                                                         const SurfaceOctreeOptions& options) {
  std::vector<bool> chosen(octree_.size(), false);
  const std::vector<DualCell> mixed = options.prove
                                          ? mixed_dual_cells(octree_, with_leaves_from(first_new))
                                          : mixed_dual_cells(octree_);
  for (const DualCell& cell : mixed) {
    const CellCase& cut = cube_table().cases[inside_corners(octree_, cell)];
    if (cut.ambiguous || cut.cycle_count > 1) {
      choose_largest(cell, kBelow * options.smallest, chosen);
    }
  }
  if (options.prove) return numbers_of(chosen);
  std::vector<bool> seen(octree_.size(), false);
  for (const DualCell& cell : mixed) {
    for (const Index leaf : cell) seen[leaf] = true;
  }
  for (Index i = 0; i < octree_.size(); ++i) {
    const bool small = octree_.side(octree_[i].level) < 2 * options.smallest;
    if (octree_.is_leaf(i) && kinds_[i] == LeafKind::open && !seen[i] && !small) chosen[i] = true;
  }
  return numbers_of(chosen);
}

/// Whether the surface in a dual cell is in one leaf at most, which is known to hold one sheet.
bool SurfaceOctree::holds_one_simple_leaf(const DualCell& cell) const {
  Index found = 0;
  for (const Index leaf : cell) {
    if (kinds_[leaf] == LeafKind::empty || leaf == found) continue;
    if (found != 0 || kinds_[leaf] != LeafKind::simple) return false;
    found = leaf;
  }
  return true;
}

/// Whether the surface in a dual cell is a graph or nothing, as far as can be proven: in a box
/// around what of the cell lies in leaves that may hold surface.
bool SurfaceOctree::is_simple(const DualCell& cell, std::size_t& slopes) const {
  if (holds_one_simple_leaf(cell)) return true;
  Aabb centers, leaves;
  Vec3d direction{};
  Index largest = 0;
  for (const Index leaf : cell) {
    const Aabb box = octree_.box(leaf);
    centers.include(box.center());
    if (kinds_[leaf] == LeafKind::empty) continue;
    leaves.include(box);
    direction += way_up(surface_at(leaf), box, jets_[leaf]);
    if (largest == 0 || octree_[leaf].level < octree_[largest].level) largest = leaf;
  }
  const Aabb box{max(centers.min, leaves.min), min(centers.max, leaves.max)};
  std::unique_ptr<const ImplicitSurface> own;
  if (!surface_box(largest).contains(box)) own = surfaces_.front()->restrict_to(box);
  Grower grower{own ? *own : surface_at(largest), direction};
  const bool grows = grower.grows_somehow(box);
  slopes += grower.slopes;
  return grows;
}

/// Whether F, seen from the ends of an edge of the dual grid, seems to pass through zero just as
/// their sides tell: whether it grows away from zero at one end at least if they are on one side,
/// and towards zero at both if not. Ends in empty leaves, on whose part of the edge F has no zero,
/// say nothing.
bool SurfaceOctree::looks_crossed_as_told(const DualEdge& edge) const {
  const bool same_side = octree_[edge[0]].inside == octree_[edge[1]].inside;
  bool as_told = !same_side;
  bool known = false;
  for (const std::size_t i : {0U, 1U}) {
    const Index leaf = edge[i];
    if (kinds_[leaf] == LeafKind::empty) continue;
    known = true;
    const Vec3d way = octree_.center(edge[1 - i]) - octree_.center(leaf);
    const bool towards = (dot(jets_[leaf].gradient, way) < 0) == octree_[leaf].inside;
    as_told = same_side ? as_told || !towards : as_told && towards;
  }
  return as_told || !known;
}

/// Whether the surface crosses an edge of the dual grid as often as the sides of its ends tell:
/// once, or not at all. One sheet in each cell does not say so: where normals turn by nearly half a
/// turn in each, a channel through edges may be a tunnel in the end. (Plantinga and Vegter,
/// "Isotopic meshing of implicit surfaces", 2007, have less than a quarter of a turn.) Proven where
/// the jets at the ends leave doubts.
bool SurfaceOctree::is_crossed_as_told(const DualEdge& edge, Counts& counts) const {
  if (looks_crossed_as_told(edge)) return true;
  int crossings = 0;
  for (const std::size_t i : {0U, 1U}) {
    const Index leaf = edge[i], other = edge[1 - i];
    if (kinds_[leaf] == LeafKind::empty) continue;
    const double side = octree_.side(octree_[leaf].level);
    const double share = side / (side + octree_.side(octree_[other].level));
    const Vec3d center = octree_.center(leaf);
    const Vec3d on_face = center + share * (octree_.center(other) - center);
    crossings += count_crossings(surface_at(leaf), center, jets_[leaf], on_face, counts);
  }
  return crossings == (octree_[edge[0]].inside == octree_[edge[1]].inside ? 0 : 1);
}

/// The largest leaves of dual cells that are not simple, of those around leaves from `first_new`
/// on, and of edges of theirs that the surface may cross too often.
std::vector<SurfaceOctree::Index> SurfaceOctree::crowded(std::size_t first_new,
                                                         const SurfaceOctreeOptions& options) {
  DualGrid failed;
  std::mutex mutex;
  for_dual_grid_around(octree_, with_leaves_from(first_new), [&](const DualGrid& part) {
    Counts counts;
    DualGrid open;
    for (const DualCell& cell : part.cells) {
      if (cancelled(options.progress)) return;
      if (!is_simple(cell, counts.slopes)) open.cells.push_back(cell);
    }
    for (const DualEdge& edge : part.edges) {
      if (cancelled(options.progress)) return;
      if (!is_crossed_as_told(edge, counts)) open.edges.push_back(edge);
    }
    const std::lock_guard lock(mutex);
    counts_ += counts;
    failed.cells.insert(failed.cells.end(), open.cells.begin(), open.cells.end());
    failed.edges.insert(failed.edges.end(), open.edges.begin(), open.edges.end());
  });
  // The same leaves in any order.
  std::vector<bool> chosen(octree_.size(), false);
  for (const DualCell& cell : failed.cells) choose_largest(cell, options.smallest, chosen);
  for (const DualEdge& edge : failed.edges) {
    choose_largest(edge, kBelow * options.smallest, chosen);
  }
  return numbers_of(chosen);
}

/// Cuts these leaves, and then whatever is neither small nor clear enough.
Result<Done> SurfaceOctree::settle(std::vector<Index> open, const SurfaceOctreeOptions& options) {
  double progress = 0.0;
  std::size_t first_unclear = octree_.size();
  while (!open.empty()) {
    const std::size_t first_new = octree_.size();
    if (options.progress != nullptr) options.progress->report("octree", progress);
    progress = 1 - 0.7 * (1 - progress);  // how many rounds there will be is not known
    if (!refine(open, options)) {
      if (cancelled(options.progress)) return error_at({}, "interrupted", Failure::interrupted);
      return error_at({},
                      "the mesh needs more than " + std::to_string(options.max_cells) +
                          " cells; use a larger tolerance",
                      Failure::limit);
    }
    open = options.prove && !gave_up_ ? crowded(first_new, options) : std::vector<Index>{};
    if (!open.empty()) continue;
    octree_.settle_sides();
    open = unclear(std::exchange(first_unclear, octree_.size()), options);
  }
  return Done{};
}

Result<SurfaceOctree> SurfaceOctree::build(const ImplicitSurface& surface,
                                           const SurfaceOctreeOptions& options) {
  require(options.tolerance > 0 && options.smallest > 0, "SurfaceOctree: lengths must be positive");
  const Aabb box = surface.bounds();
  require(!box.empty() && box.finite(), "SurfaceOctree: the surface must have finite bounds");
  SurfaceOctree tree(root_around(box), options);
  SurfaceOctreeOptions& own = tree.options_;
  own.smallest = std::min(own.smallest, std::ldexp(tree.octree_.side(0), -kLeastLevel - 1));
  tree.surfaces_.emplace_back(std::shared_ptr<const ImplicitSurface>(), &surface);
  tree.surface_boxes_.push_back(tree.octree_.box(0));
  tree.surface_of_.push_back(0);
  tree.kinds_.push_back(LeafKind::open);
  tree.jets_.push_back(surface.jet(tree.octree_.center(0)));
  const Result<Done> settled = tree.settle({0}, own);
  if (!settled) return Result<SurfaceOctree>::failure(settled.diagnostics());
  return tree;
}

/// The leaves that may be cut, a cell or below it, which a point is in or near.
void SurfaceOctree::find_near(Index cell, const Vec3d& point, std::vector<bool>& chosen) const {
  constexpr double kNear = 0.25;  // sides
  const double side = octree_.side(octree_[cell].level);
  if (!octree_.box(cell).grown(kNear * side).contains(point)) return;
  if (octree_.is_leaf(cell)) {
    if (kinds_[cell] != LeafKind::empty && side >= 2 * options_.smallest) chosen[cell] = true;
    return;
  }
  for (int i = 0; i < 8; ++i) find_near(octree_.child(cell, i), point, chosen);
}

Result<std::size_t> SurfaceOctree::cut_near(std::span<const Vec3d> points) {
  std::vector<bool> chosen(octree_.size(), false);
  for (const Vec3d& p : points) find_near(0, p, chosen);
  const std::vector<Index> leaves = numbers_of(chosen);
  const Result<Done> settled = settle(leaves, options_);
  if (!settled) return Result<std::size_t>::failure(settled.diagnostics());
  return leaves.size();
}

}  // namespace cs2mesh
