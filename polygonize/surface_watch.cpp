#include "polygonize/surface_watch.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

/// From this share of what is too far on, a block is sampled more closely.
constexpr double kCloser = 0.7;
constexpr int kCloserCells = 3;

double look_at(const ClosestPoint& tree, std::span<const Vec3d> points, double enough,
               std::vector<LostPoint>& lost) {
  double farthest = 0;
  tree.nearest_each(points, [&](std::size_t i, const ClosestPoint::Hit& hit) {
    farthest = std::max(farthest, hit.distance);
    if (hit.distance > enough) {
      lost.push_back({points[i], hit.point, hit.distance, hit.triangle});
    }
  });
  return farthest;
}

}  // namespace

SurfaceWatch::SurfaceWatch(const ImplicitSurface& surface, const SurfaceWatchOptions& options)
    : options_(options) {
  require(options.enough > 0, "SurfaceWatch: the distance must be positive");
  blocks_ = surface_blocks(surface, surface.bounds(), options.samples, options.seed);
  cells_ = cells_per_block(blocks_.size(), options.samples);
  patches_.resize(blocks_.size());
  tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t i) {
    append_crossings(blocks_[i], cells_, patches_[i].points);
  });
}

SurfaceWatch::Look SurfaceWatch::look(const TriangleMesh& mesh) {
  Look all;
  if (mesh.empty()) {
    const bool any = std::any_of(patches_.begin(), patches_.end(),
                                 [](const Patch& patch) { return !patch.points.empty(); });
    if (any) all.farthest = std::numeric_limits<double>::infinity();
    return all;
  }
  const ClosestPoint tree(mesh);
  std::vector<Look> looks(patches_.size());
  tbb::parallel_for(std::size_t{0}, patches_.size(), [&](std::size_t i) {
    Patch& patch = patches_[i];
    looks[i].farthest = look_at(tree, patch.points, options_.enough, looks[i].lost);
    if (patch.closer || !(looks[i].farthest > kCloser * options_.enough)) return;
    patch.closer = true;
    patch.points.clear();
    append_crossings(blocks_[i], kCloserCells * cells_, patch.points);
    const double closer = look_at(tree, patch.points, options_.enough, looks[i].lost);
    looks[i].farthest = std::max(looks[i].farthest, closer);
  });
  for (const Look& look : looks) {
    all.farthest = std::max(all.farthest, look.farthest);
    all.lost.insert(all.lost.end(), look.lost.begin(), look.lost.end());
  }
  return all;
}

}  // namespace cs2mesh
