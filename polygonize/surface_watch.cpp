#include "polygonize/surface_watch.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "libfield/base/check.h"
#include "polygonize/surface_samples.h"

namespace cs2mesh {

SurfaceWatch::SurfaceWatch(const ImplicitSurface& surface, const SurfaceWatchOptions& options)
    : options_(options) {
  require(options.enough > 0, "SurfaceWatch: the distance must be positive");
  blocks_ =
      surface_blocks(surface, surface.bounds(), options.samples, options.seed, options.progress);
  cells_ = cells_per_block(blocks_.size(), options.samples);
  patches_.resize(blocks_.size());
  tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t i) {
    if (!cancelled(options.progress)) append_crossings(blocks_[i], cells_, patches_[i]);
  });
}

bool SurfaceWatch::any() const {
  return std::any_of(patches_.begin(), patches_.end(),
                     [](const std::vector<Vec3d>& patch) { return !patch.empty(); });
}

std::vector<Vec3d> SurfaceWatch::some() const {
  std::vector<Vec3d> points;
  for (const std::vector<Vec3d>& patch : patches_) {
    if (!patch.empty()) points.push_back(patch.front());
  }
  return points;
}

SurfaceWatch::Look SurfaceWatch::look_at(const std::vector<Vec3d>& points,
                                         const ClosestPoint& tree) const {
  Look look;
  tree.nearest_each(points, [&](std::size_t k, const ClosestPoint::Hit& hit) {
    look.farthest = std::max(look.farthest, hit.distance);
    if (hit.distance > options_.enough) {
      look.lost.push_back({points[k], hit.point, hit.distance, hit.triangle});
    }
  });
  return look;
}

/// The blocks whose samples are farthest from the mesh, of those where that is much: as many as
/// closer lines are worth.
std::vector<std::size_t> SurfaceWatch::farthest_blocks(const std::vector<Look>& looks) const {
  constexpr double kMuch = 0.6;          // of what is enough
  constexpr std::size_t kOneOutOf = 18;  // of blocks, with nine times the samples
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (looks[i].farthest > kMuch * options_.enough) chosen.push_back(i);
  }
  std::stable_sort(chosen.begin(), chosen.end(), [&](std::size_t a, std::size_t b) {
    return looks[a].farthest > looks[b].farthest;
  });
  chosen.resize(std::min(chosen.size(), 1 + looks.size() / kOneOutOf));
  return chosen;
}

SurfaceWatch::Look SurfaceWatch::look(const ClosestPoint& tree) const {
  constexpr int kCloser = 3;
  std::vector<Look> looks(patches_.size());
  tbb::parallel_for(std::size_t{0}, patches_.size(),
                    [&](std::size_t i) { looks[i] = look_at(patches_[i], tree); });
  const std::vector<std::size_t> far = farthest_blocks(looks);
  std::vector<Look> closer(far.size());
  tbb::parallel_for(std::size_t{0}, far.size(), [&](std::size_t i) {
    if (cancelled(options_.progress)) return;
    std::vector<Vec3d> points;
    append_crossings(blocks_[far[i]], kCloser * cells_, points);
    closer[i] = look_at(points, tree);
  });
  looks.insert(looks.end(), closer.begin(), closer.end());
  Look all;
  for (const Look& look : looks) {
    all.farthest = std::max(all.farthest, look.farthest);
    all.lost.insert(all.lost.end(), look.lost.begin(), look.lost.end());
  }
  return all;
}

}  // namespace cs2mesh
