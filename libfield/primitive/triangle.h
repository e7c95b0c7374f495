// The flat triangle; its measure is its area.
#pragma once

#include <array>

#include "libfield/base/vec.h"

namespace cs2mesh {

struct Triangle {
  static constexpr int kDimension = 2;
  std::array<Vec3d, 3> vertex;
};

}  // namespace cs2mesh
