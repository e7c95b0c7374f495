// The unbounded plane; its measure is infinite.
#pragma once

#include "libfield/base/vec.h"

namespace cs2mesh {

struct Plane {
  static constexpr int kDimension = 2;
  Vec3d point;
  Vec3d normal{0, 0, 1};  ///< unit
};

}  // namespace cs2mesh
