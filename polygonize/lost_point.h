// Where a mesh and its surface are too far apart.
#pragma once

#include <cstdint>

#include "libfield/base/vec.h"

namespace cs2mesh {

/// A point of the one and the nearest of the other.
struct LostPoint {
  Vec3d on_surface, on_mesh;
  double distance = 0.0;
  std::uint32_t triangle = 0;  ///< of the mesh's point
};

}  // namespace cs2mesh
