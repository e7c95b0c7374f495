// What of a surface a mesh misses, looked at again and again while the mesh changes.
#pragma once

#include <cstdint>
#include <vector>

#include "libfield/field/implicit_surface.h"
#include "polygonize/closest_point.h"
#include "polygonize/surface_samples.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Where mesh and surface are too far apart: a point of the one and the nearest of the other.
struct LostPoint {
  Vec3d on_surface, on_mesh;
  double distance = 0.0;
  std::uint32_t triangle = 0;  ///< of the mesh's point
};

struct SurfaceWatchOptions {
  std::size_t samples = 100'000;  ///< all over the surface, roughly
  double enough = 0.0;            ///< distance beyond which a point is lost, > 0
  std::uint64_t seed = 1;
};

/// Samples of a surface, found without a mesh and once for all looks: crossings with a lattice, and
/// nine times as many where a mesh has once been far, though not yet too far, from one.
class SurfaceWatch {
 public:
  /// `surface` outlives the watch and has finite bounds.
  SurfaceWatch(const ImplicitSurface& surface, const SurfaceWatchOptions& options);

  struct Look {
    double farthest = 0.0;        ///< infinite if there is surface but no mesh
    std::vector<LostPoint> lost;  ///< samples too far from the mesh, in no order but a fixed one
  };
  /// About 2 us a sample, and the building of a tree over the mesh.
  Look look(const TriangleMesh& mesh);

 private:
  struct Patch {
    std::vector<Vec3d> points;
    bool closer = false;
  };
  SurfaceWatchOptions options_;
  std::vector<SurfaceBlock> blocks_;
  std::vector<Patch> patches_;  ///< one a block
  int cells_ = 0;
};

}  // namespace cs2mesh
