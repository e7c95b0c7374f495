#include "polygonize/surface_samples.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "libfield/base/random.h"
#include "polygonize/edge_root.h"

namespace cs2mesh {
namespace {

/// Crossings of a block with c x c lines in each of three directions, over c^2: 1.5 for a random
/// plane that cuts it, times the share of blocks that truly hold surface.
constexpr double kCrossingsPerSquare = 0.9;
constexpr int kMostHalvings = 20;
/// Newton steps along an edge before its root is left to bracketing.
constexpr int kNewtonSteps = 4;
/// The longest step, in edges, that is left out at the end.
constexpr double kResolution = 1e-10;
/// Blocks that have a restriction of their own; smaller ones share that of the block they came
/// from, so that memory stays small.
constexpr std::size_t kMostRestrictions = 8000;

bool may_hold_surface(const Interval& range) {
  // F = 0 counts as inside, so a box where F >= 0 throughout holds no boundary of {F >= 0}.
  return range.lo < 0 && range.hi >= 0;
}

std::vector<SurfaceBlock> root_blocks(const ImplicitSurface& surface, const Aabb& region,
                                      std::uint64_t seed, const Progress* progress) {
  constexpr double kAcross = 8;
  const Vec3d extent = region.extent();
  const double size = std::max({extent.x, extent.y, extent.z}) / kAcross;
  // A shift at random, so that lattice and scene, which likes round numbers, are not aligned.
  Random random(seed, 0x6c617474696365);
  Vec3d origin = region.min;
  for (std::size_t axis = 0; axis < 3; ++axis) origin[axis] -= random.uniform() * size;
  std::vector<SurfaceBlock> blocks;
  std::array<int, 3> count{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    count[axis] = static_cast<int>(std::floor((region.max[axis] - origin[axis]) / size)) + 1;
  }
  for (int k = 0; k < count[2]; ++k) {
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < count[0]; ++i) {
        const Vec3d low = origin + size * Vec3d(i, j, k);
        const Aabb box{low, low + Vec3d{size, size, size}};
        if (cancelled(progress)) return {};
        if (!may_hold_surface(surface.enclose(box))) continue;
        blocks.push_back({box, surface.restrict_to(box)});
      }
    }
  }
  return blocks;
}

std::vector<SurfaceBlock> halved(const std::vector<SurfaceBlock>& blocks,
                                 const Progress* progress) {
  std::vector<std::vector<SurfaceBlock>> parts(blocks.size());
  const bool restrict_more = blocks.size() <= kMostRestrictions;
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
    if (!cancelled(progress)) parts[i] = cs2mesh::halved(blocks[i], restrict_more);
  });
  std::vector<SurfaceBlock> out;
  for (auto& some : parts) out.insert(out.end(), some.begin(), some.end());
  return out;
}

/// Replaces roots[e] for each e of `hard` by the root that bracketing finds on that edge.
void replace_by_bracketing(const SurfaceBlock& block, const std::vector<Vec3d>& points,
                           const std::vector<std::pair<std::size_t, std::size_t>>& crossed,
                           const std::vector<std::size_t>& hard, std::vector<Vec3d>& roots) {
  if (hard.empty()) return;
  std::vector<Vec3d> ends;
  for (const std::size_t e : hard) {
    ends.insert(ends.end(), {points[crossed[e].first], points[crossed[e].second]});
  }
  std::vector<Jet> jets(ends.size());
  block.surface->jets(ends, jets);
  std::vector<CrossedEdge> edges;
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < hard.size(); ++k) {
    const Jet &a = jets[2 * k], &b = jets[2 * k + 1];
    if ((a.value >= 0) == (b.value >= 0)) {
      // Values and jets round to different signs only where an end is on the surface.
      roots[hard[k]] = std::abs(a.value) < std::abs(b.value) ? ends[2 * k] : ends[2 * k + 1];
    } else {
      edges.push_back({ends[2 * k], ends[2 * k + 1], a, b});
      found.push_back(hard[k]);
    }
  }
  std::vector<Vec3d> exact(edges.size());
  EdgeRootCounts counts;
  find_roots(*block.surface, edges, exact, counts);
  for (std::size_t k = 0; k < found.size(); ++k) roots[found[k]] = exact[k];
}

/// Moves the roots along their edges by Newton's method. The edges for which that fails, in order.
std::vector<std::size_t> move_by_newton(
    const SurfaceBlock& block, const std::vector<Vec3d>& points,
    const std::vector<std::pair<std::size_t, std::size_t>>& crossed, std::vector<Vec3d>& roots) {
  std::vector<std::size_t> open(roots.size()), hard;
  std::iota(open.begin(), open.end(), std::size_t{0});
  std::vector<double> last_change(roots.size(), 1.0);
  for (int step = 0; step < kNewtonSteps && !open.empty(); ++step) {
    std::vector<Vec3d> at;
    at.reserve(open.size());
    for (const std::size_t e : open) at.push_back(roots[e]);
    std::vector<Jet> jets(at.size());
    block.surface->jets(at, jets);
    std::vector<std::size_t> still;
    for (std::size_t k = 0; k < open.size(); ++k) {
      const std::size_t e = open[k];
      const Vec3d way = points[crossed[e].second] - points[crossed[e].first];
      const double change = -jets[k].value / dot(jets[k].gradient, way);
      const double shrinking = std::abs(change) / last_change[e];
      const Vec3d next = roots[e] + change * way;
      if (!(shrinking < 0.5 && block.box.contains(next))) {
        hard.push_back(e);  // short steps alone tell nothing: where F falls like exp(-t) all are
        continue;
      }
      roots[e] = next;
      last_change[e] = std::abs(change);
      // Steps of a method that converges quadratically shrink by c, c^2, c^4 ...; the first of them
      // does not tell by what.
      const double next_change = std::abs(change) * shrinking * shrinking;
      if (step == 0 || !(next_change <= kResolution)) still.push_back(e);
    }
    open = std::move(still);
  }
  hard.insert(hard.end(), open.begin(), open.end());
  std::sort(hard.begin(), hard.end());
  return hard;
}

}  // namespace

std::vector<SurfaceBlock> halved(const SurfaceBlock& block, bool restrict_more) {
  std::array<Aabb, 8> parts;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const Vec3d center = block.box.center(), end = block.box.corner(static_cast<int>(corner));
    parts[corner] = {min(center, end), max(center, end)};
  }
  std::array<Interval, 8> ranges;
  block.surface->enclose_each(parts, ranges);
  std::vector<SurfaceBlock> out;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    if (!may_hold_surface(ranges[corner])) continue;
    out.push_back(
        {parts[corner], restrict_more ? block.surface->restrict_to(parts[corner]) : block.surface});
  }
  return out;
}

std::vector<SurfaceBlock> surface_blocks(const ImplicitSurface& surface, const Aabb& region,
                                         std::size_t samples, std::uint64_t seed,
                                         const Progress* progress) {
  if (region.empty() || !region.finite() || !(region.diagonal() > 0)) return {};
  std::vector<SurfaceBlock> blocks = root_blocks(surface, region, seed, progress);
  const double enough = static_cast<double>(samples) /
                        (kCrossingsPerSquare * kMostCellsPerBlock * kMostCellsPerBlock);
  for (int halvings = 0; halvings < kMostHalvings; ++halvings) {
    if (blocks.empty() || static_cast<double>(blocks.size()) >= enough) break;
    blocks = halved(blocks, progress);
  }
  return blocks;
}

int cells_per_block(std::size_t blocks, std::size_t samples) {
  const double squares =
      static_cast<double>(samples) /
      (kCrossingsPerSquare * static_cast<double>(std::max<std::size_t>(blocks, 1)));
  return std::clamp(static_cast<int>(std::lround(std::sqrt(squares))), 2, kMostCellsPerBlock);
}

void append_crossings(const SurfaceBlock& block, int cells, std::vector<Vec3d>& out) {
  const int nodes = cells + 1;
  const auto index = [nodes](int i, int j, int k) {
    return static_cast<std::size_t>((k * nodes + j) * nodes + i);
  };
  // Evaluate the nodes.
  std::vector<Vec3d> points;
  const Vec3d& low = block.box.min;
  const Vec3d step = block.box.extent() / static_cast<double>(cells);
  for (int k = 0; k < nodes; ++k) {
    for (int j = 0; j < nodes; ++j) {
      for (int i = 0; i < nodes; ++i) {
        // The far faces exactly: a rounded product could lie outside of the box.
        points.push_back({i == cells ? block.box.max.x : low.x + i * step.x,
                          j == cells ? block.box.max.y : low.y + j * step.y,
                          k == cells ? block.box.max.z : low.z + k * step.z});
      }
    }
  }
  std::vector<double> values(points.size());
  block.surface->values(points, values);

  // Collect the edges with a change of sign; those on the far faces belong to the next block, which
  // holds surface too then.
  std::vector<std::pair<std::size_t, std::size_t>> crossed;
  for (int k = 0; k < cells; ++k) {
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) {
        const std::size_t a = index(i, j, k);
        for (const std::size_t b : {index(i + 1, j, k), index(i, j + 1, k), index(i, j, k + 1)}) {
          if ((values[a] >= 0) != (values[b] >= 0)) crossed.emplace_back(a, b);
        }
      }
    }
  }
  if (crossed.empty()) return;

  // From where the values' chord crosses 0.
  std::vector<Vec3d> roots;
  roots.reserve(crossed.size());
  for (const auto& [a, b] : crossed) {
    roots.push_back(points[a] + (values[a] / (values[a] - values[b])) * (points[b] - points[a]));
  }
  const std::vector<std::size_t> hard = move_by_newton(block, points, crossed, roots);
  replace_by_bracketing(block, points, crossed, hard, roots);
  out.insert(out.end(), roots.begin(), roots.end());
}

}  // namespace cs2mesh
