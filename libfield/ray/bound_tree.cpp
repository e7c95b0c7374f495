#include "libfield/ray/bound_tree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cs2mesh {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Cells are no smaller than the root over 2^10.
constexpr int kDeepest = 10;
/// Where F has creases there is no |D^2 F| to wait for, only empty cells to find.
constexpr int kDeepestCreased = 6;

}  // namespace

BoundTree::BoundTree(const ImplicitSurface& surface, std::size_t most_cells) : surface_(surface) {
  const Aabb bounds = surface.bounds();
  if (bounds.empty() || !bounds.finite()) return;
  // A ray solver begins and ends a little outside bounds that the surface may touch.
  bounds_ = bounds.grown(2e-6 * bounds.diagonal());
  margin_ = 1e-6 * bounds.diagonal();
  const Vec3d extent = bounds_.extent();
  root_ = {0, bounds_.center(), 0.5 * std::max({extent.x, extent.y, extent.z})};
  const Interval range = surface.enclose(bounds_);
  scale_ = std::isfinite(range.lo) ? std::abs(range.lo) : 0.0;
  cells_.resize(1);

  // Level by level: all cells of a level are examined at once, then those that need it are divided,
  // in their order.
  std::vector<Place> level{root_};
  for (int depth = 0; !level.empty(); ++depth) {
    std::vector<char> unfit(level.size());
    tbb::parallel_for(std::size_t{0}, level.size(), [&](std::size_t i) {
      unfit[i] = examine(level[i], cells_[level[i].cell]) ? 1 : 0;
    });
    for (const Place& place : level) bounds_taken_ += cells_[place.cell].empty ? 1 : 2;
    std::vector<Place> next;
    for (std::size_t i = 0; i < level.size() && depth < kDeepest; ++i) {
      if (!unfit[i] || cells_.size() + 8 > most_cells) continue;
      const bool creased = !std::isfinite(cells_[level[i].cell].hessian);
      if (creased && depth >= kDeepestCreased) continue;
      const std::size_t first = cells_.size();
      cells_[level[i].cell].first_child = static_cast<std::int32_t>(first);
      cells_.resize(first + 8);
      for (int child = 0; child < 8; ++child) {
        next.push_back({first + static_cast<std::size_t>(child), child_center(level[i], child),
                        0.5 * level[i].half});
      }
    }
    level = std::move(next);
  }
}

Vec3d BoundTree::child_center(const Place& parent, int child) {
  const double step = 0.5 * parent.half;
  return parent.center +
         Vec3d{child & 1 ? step : -step, child & 2 ? step : -step, child & 4 ? step : -step};
}

/// Takes the bounds of a cell. True if it should be divided.
bool BoundTree::examine(const Place& place, Cell& cell) const {
  const double reach = place.half + margin_;
  Aabb box = Aabb{place.center, place.center}.grown(reach);
  box.min = max(box.min, bounds_.min);
  box.max = min(box.max, bounds_.max);
  if (box.empty()) {
    cell.empty = true;
    return false;
  }
  Interval range;  // whose sign matters
  surface_.enclose_each({&box, 1}, {&range, 1});
  cell.empty = range.lo > 0.0 || range.hi < 0.0;
  if (cell.empty) return false;
  cell.hessian = surface_.derivative_bound(2, box);
  // Smaller cells would be too many; of what is left to decide, rays divide their own way.
  const double edge = 2.0 * place.half;
  const double variation = std::max(std::abs(range.lo), std::abs(range.hi));
  return !(cell.hessian * edge * edge <= 8.0 * variation);
}

bool BoundTree::serves(const Ray& ray, double t1) const {
  if (cells_.empty()) return false;
  const Vec3d& o = ray.origin;
  const double reach = std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) + std::abs(t1);
  return 16.0 * kEpsilon * reach < margin_;
}

void BoundTree::walk(const Ray& ray, RayRange range, std::vector<Stretch>& stretches) const {
  stretches.clear();
  range = clip(ray, bounds_, range);
  if (!range.empty()) descend(ray, root_, range, stretches);
}

void BoundTree::descend(const Ray& ray, const Place& place, RayRange range,
                        std::vector<Stretch>& stretches) const {
  const Cell& cell = cells_[place.cell];
  if (cell.empty) return;
  if (cell.first_child < 0) {
    stretches.push_back({range.t0, range.t1, cell.hessian, 2.0 * place.half});
    return;
  }
  // Cut the range where the ray crosses the cell's middle planes; each part lies in one child. A
  // part on the wrong side of a plane by rounding is covered by the margin.
  std::array<double, 5> cut{range.t0, range.t0, range.t0, range.t0, range.t1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double t = (place.center[axis] - ray.origin[axis]) / ray.direction[axis];
    if (t > range.t0 && t < range.t1) cut[axis + 1] = t;
  }
  std::sort(cut.begin() + 1, cut.begin() + 4);
  for (std::size_t i = 0; i + 1 < cut.size(); ++i) {
    if (!(cut[i] < cut[i + 1])) continue;
    const Vec3d middle = ray.at(0.5 * (cut[i] + cut[i + 1]));
    const int child = (middle.x > place.center.x ? 1 : 0) | (middle.y > place.center.y ? 2 : 0) |
                      (middle.z > place.center.z ? 4 : 0);
    descend(ray,
            {static_cast<std::size_t>(cell.first_child + child), child_center(place, child),
             0.5 * place.half},
            {cut[i], cut[i + 1]}, stretches);
  }
}

}  // namespace cs2mesh
