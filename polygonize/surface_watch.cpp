#include "polygonize/surface_watch.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "libfield/base/check.h"
#include "polygonize/surface_samples.h"

namespace cs2mesh {

SurfaceWatch::SurfaceWatch(const ImplicitSurface& surface, const SurfaceWatchOptions& options)
    : options_(options) {
  require(options.enough > 0, "SurfaceWatch: the distance must be positive");
  const std::vector<SurfaceBlock> blocks =
      surface_blocks(surface, surface.bounds(), options.samples, options.seed, options.progress);
  const int cells = cells_per_block(blocks.size(), options.samples);
  patches_.resize(blocks.size());
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
    if (!cancelled(options.progress)) append_crossings(blocks[i], cells, patches_[i]);
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

SurfaceWatch::Look SurfaceWatch::look(const ClosestPoint& tree) const {
  std::vector<Look> looks(patches_.size());
  tbb::parallel_for(std::size_t{0}, patches_.size(), [&](std::size_t i) {
    Look& look = looks[i];
    tree.nearest_each(patches_[i], [&](std::size_t k, const ClosestPoint::Hit& hit) {
      look.farthest = std::max(look.farthest, hit.distance);
      if (hit.distance > options_.enough) {
        look.lost.push_back({patches_[i][k], hit.point, hit.distance, hit.triangle});
      }
    });
  });
  Look all;
  for (const Look& look : looks) {
    all.farthest = std::max(all.farthest, look.farthest);
    all.lost.insert(all.lost.end(), look.lost.begin(), look.lost.end());
  }
  return all;
}

}  // namespace cs2mesh
