#include "polygonize/topology_proof.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

/// A cube with air around the bounds, off their middle, where symmetric shapes have their singular
/// places.
Octree root_around(const Aabb& box) {
  const Vec3d extent = box.extent();
  const double side = 1.2 * std::max({extent.x, extent.y, extent.z});
  const Vec3d shift{0.5 * (side - extent.x) - 0.0137 * side,
                    0.5 * (side - extent.y) - 0.0219 * side,
                    0.5 * (side - extent.z) - 0.0171 * side};
  return {box.min - shift, side};
}

/// A direction along which F grows all over the box; zero if none was found.
Vec3d growth_in(const ImplicitSurface& part, const Aabb& box) {
  const Vec3d gradient = part.jet(box.center()).gradient;
  if (!(norm(gradient) > 0) || !is_finite(gradient)) return {};
  const Vec3d direction = normalized(gradient);
  std::array<Vec3d, 8> corners;
  for (int i = 0; i < 8; ++i) corners[static_cast<std::size_t>(i)] = box.corner(i);
  const HullBound bound = part.hull_bound(corners, {&direction, 1});
  if (bound.slope > 0) return direction;
  if (std::isfinite(bound.bend) || !std::isfinite(bound.slope)) return {};
  // At kinks, between the gradients on both sides.
  const std::array<Interval, 3> slopes = part.enclose_gradient(box);
  Vec3d between;
  for (std::size_t i = 0; i < 3; ++i) between[i] = 0.5 * (slopes[i].lo + slopes[i].hi);
  if (!(norm(between) > 0) || !is_finite(between)) return {};
  between = normalized(between);
  return least_along(slopes, between) > 0 ? between : Vec3d{};
}

}  // namespace

/// Cuts a cell, and its children where nothing is shown of them; false if there are too many or the
/// user wants to stop.
bool TopologyProof::cut(Index cell, const ImplicitSurface& part, const Options& options) {
  if (octree_.size() + 8 > options.max_cells || cancelled(options.progress)) return false;
  const Index first = octree_.split(cell);
  kinds_.resize(octree_.size(), Kind::open);
  directions_.resize(octree_.size());
  std::array<Aabb, 8> boxes;
  std::array<Interval, 8> ranges;
  for (Index i = 0; i < 8; ++i) boxes[i] = octree_.box(first + i);
  part.enclose_each(boxes, ranges);
  const double side = octree_.side(octree_[first].level);
  for (Index i = 0; i < 8; ++i) {
    const Index child = first + i;
    if (ranges[i].lo > 0 || ranges[i].hi < 0) {
      kinds_[child] = Kind::keeps_sign;
      octree_.set_inside(child, ranges[i].lo > 0);
      continue;
    }
    directions_[child] = growth_in(part, boxes[i]);
    if (norm(directions_[child]) > 0) {
      kinds_[child] = Kind::grows;
    } else if (side >= 2 * options.smallest && octree_[child].level < Octree::kMostLevels) {
      if (!cut(child, *part.restrict_to(boxes[i]), options)) return false;
    } else {
      open_.push_back(boxes[i]);
    }
  }
  return true;
}

Result<TopologyProof> TopologyProof::build(const ImplicitSurface& surface, const Options& options) {
  require(options.smallest > 0, "TopologyProof: the smallest side must be positive");
  const Aabb bounds = surface.bounds();
  if (bounds.empty()) {
    TopologyProof nothing(Octree({}, 1.0));
    nothing.kinds_ = {Kind::keeps_sign};
    nothing.directions_.resize(1);
    return nothing;
  }
  require(bounds.finite(), "TopologyProof: the surface must have finite bounds");
  TopologyProof proof(root_around(bounds));
  proof.kinds_ = {Kind::open};
  proof.directions_.resize(1);
  if (options.progress != nullptr) options.progress->report("topology", 0.0);
  if (!proof.cut(0, surface, options)) {
    if (cancelled(options.progress)) return error_at({}, "interrupted", Failure::interrupted);
    return error_at(
        {},
        "the proof of the topology needs more than " + std::to_string(options.max_cells) + " cells",
        Failure::limit);
  }
  return proof;
}

/// The leaf, or the cell of the same size, a step of its own size away; none outside of the root.
std::optional<Octree::Index> TopologyProof::neighbour(Index leaf, const Int3& step) const {
  const Octree::Cell& cell = octree_[leaf];
  const auto width = std::int32_t{1} << (Octree::kMostLevels - cell.level);
  const Int3 at = cell.corner + width * step;
  constexpr std::int32_t kAll = std::int32_t{1} << Octree::kMostLevels;
  if (std::min({at.x, at.y, at.z}) < 0 || std::max({at.x, at.y, at.z}) >= kAll) return {};
  Index found = 0;
  while (!octree_.is_leaf(found) && octree_[found].level < cell.level) {
    const int bit = Octree::kMostLevels - octree_[found].level - 1;
    found =
        octree_.child(found, (at.x >> bit & 1) | (at.y >> bit & 1) << 1 | (at.z >> bit & 1) << 2);
  }
  return found;
}

/// None outside of the root. Near a face it may be the leaf beyond, by the rounding of the face.
std::optional<Octree::Index> TopologyProof::leaf_around(const Vec3d& point) const {
  Index found = 0;
  if (!octree_.box(found).contains(point)) return std::nullopt;
  while (!octree_.is_leaf(found)) {
    const Vec3d middle = octree_.center(found);
    found = octree_.child(found, (point.x > middle.x ? 1 : 0) | (point.y > middle.y ? 2 : 0) |
                                     (point.z > middle.z ? 4 : 0));
  }
  return found;
}

/// From a point where F has that sign uphill, or downhill, to a leaf of that sign, or the outside:
/// its number, or kNowhere. Where the ways in two leaves lead to their common face from both sides,
/// F grows along the sum of the two that stays in the face.
std::uint32_t TopologyProof::climb(Vec3d point, bool inside) const {
  constexpr int kMostSteps = 100;
  const double hair = 1e-12 * octree_.side(0);
  Aabb last;
  Vec3d last_way{};
  std::size_t face = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    const std::optional<Index> leaf = leaf_around(point);
    if (!leaf) return inside ? kNowhere : outside();
    if (kinds_[*leaf] == Kind::keeps_sign) {
      return octree_[*leaf].inside == inside ? *leaf : kNowhere;
    }
    if (kinds_[*leaf] == Kind::open) return kNowhere;
    Aabb box = octree_.box(*leaf);
    Vec3d way = inside ? directions_[*leaf] : -directions_[*leaf];
    const Aabb own = box;
    const Vec3d own_way = way;
    if (last_way[face] * way[face] < 0) {
      way = std::abs(way[face]) * last_way + std::abs(last_way[face]) * way;
      way[face] = 0.0;
      box = {max(box.min, last.min), min(box.max, last.max)};
    }
    double length = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (way[axis] == 0) continue;
      const double end = way[axis] > 0 ? box.max[axis] : box.min[axis];
      const double t = std::max((end - point[axis]) / way[axis], 0.0);
      if (t < length) length = t, face = axis;
    }
    if (!std::isfinite(length)) return kNowhere;
    point += length * way;
    // A hair beyond the face.
    point[face] = way[face] > 0 ? box.max[face] + hair : box.min[face] - hair;
    last = own, last_way = own_way;
  }
  return kNowhere;
}

/// Joins leaves of one sign that touch, be it in a corner, and those that paths lead to from the
/// middles of their faces.
void TopologyProof::join_leaves(DisjointSets& sets) const {
  const double hair = 1e-12 * octree_.side(0);
  for (Index leaf = 0; leaf < octree_.size(); ++leaf) {
    if (!keeps_sign(leaf)) continue;
    const bool inside = octree_[leaf].inside;
    for (int code = 0; code < 27; ++code) {
      const Int3 step{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
      const std::optional<Index> other = neighbour(leaf, step);
      if (!other) {
        if (!inside) sets.join(leaf, outside());
      } else if (keeps_sign(*other)) {
        if (octree_[*other].inside == inside) sets.join(leaf, *other);
      } else if (std::abs(step.x) + std::abs(step.y) + std::abs(step.z) == 1) {
        const Aabb box = octree_.box(leaf);
        const Vec3d way{double(step.x), double(step.y), double(step.z)};
        const Vec3d half = 0.5 * box.extent();
        const Vec3d face{half.x * way.x, half.y * way.y, half.z * way.z};
        const std::uint32_t end = climb(box.center() + face + hair * way, inside);
        if (end != kNowhere) sets.join(leaf, end);
      }
    }
  }
}

std::vector<TopologyProof::Region> TopologyProof::regions(const KnownPoints& known) const {
  // Numbers: the cells, the outside, the points.
  const std::uint32_t first_point = outside() + 1;
  DisjointSets sets(first_point + known.points.size());
  join_leaves(sets);
  for (std::uint32_t p = 0; p < known.points.size(); ++p) {
    if (!is_finite(known.points[p])) continue;
    const std::uint32_t end = climb(known.points[p], known.inside[p]);
    if (end != kNowhere) sets.join(first_point + p, end);
  }
  for (const auto& [a, b] : known.together) sets.join(first_point + a, first_point + b);

  std::vector<std::uint32_t> number(first_point, 0);  // by root, from 1 on
  std::vector<Region> regions{{octree_.box(0), false, true}};
  number[sets.root(outside())] = 1;
  for (Index leaf = 0; leaf < outside(); ++leaf) {
    if (!keeps_sign(leaf)) continue;
    std::uint32_t& n = number[sets.root(leaf)];
    if (n == 0) {
      regions.push_back({octree_.box(leaf), false, false});
      n = static_cast<std::uint32_t>(regions.size());
    } else if (octree_.box(leaf).diagonal() > regions[n - 1].leaf.diagonal()) {
      regions[n - 1].leaf = octree_.box(leaf);
    }
  }
  for (std::uint32_t p = 0; p < known.points.size(); ++p) {
    const std::uint32_t root = sets.root(first_point + p);
    if (root < first_point && number[root] != 0) regions[number[root] - 1].known = true;
  }
  return regions;
}

}  // namespace cs2mesh
