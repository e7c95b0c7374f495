// What of a surface a mesh misses, looked at again and again while the mesh changes.
#pragma once

#include <cstdint>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/closest_point.h"
#include "polygonize/lost_point.h"
#include "polygonize/surface_samples.h"

namespace cs2mesh {

struct SurfaceWatchOptions {
  std::size_t samples = 100'000;  ///< all over the surface, roughly
  double enough = 0.0;            ///< distance beyond which a point is lost, > 0
  std::uint64_t seed = 1;
  Progress* progress = nullptr;  ///< cancelled: samples are missing
};

/// Samples of a surface, found without a mesh and once for all looks: crossings with a lattice.
class SurfaceWatch {
 public:
  /// `surface` outlives the watch and has finite bounds.
  SurfaceWatch(const ImplicitSurface& surface, const SurfaceWatchOptions& options);

  struct Look {
    double farthest = 0.0;
    std::vector<LostPoint> lost;  ///< samples too far from the mesh, in no order but a fixed one
  };
  /// `tree` is that of the mesh. About 2 us a sample. In the blocks whose samples are farthest from
  /// it, three times as close lines are looked along too, for half as many more samples.
  Look look(const ClosestPoint& tree) const;
  /// Whether there is any surface.
  bool any() const;
  /// One sample of each block that has any.
  std::vector<Vec3d> some() const;

 private:
  Look look_at(const std::vector<Vec3d>& points, const ClosestPoint& tree) const;
  std::vector<std::size_t> farthest_blocks(const std::vector<Look>& looks) const;

  SurfaceWatchOptions options_;
  std::vector<SurfaceBlock> blocks_;         ///< of the lattice
  int cells_ = 1;                            ///< along the edge of one
  std::vector<std::vector<Vec3d>> patches_;  ///< samples, by block
};

}  // namespace cs2mesh
