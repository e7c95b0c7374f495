// The point primitive; its measure is 1.
#pragma once

#include "libfield/base/vec.h"

namespace cs2mesh {

struct Point {
  static constexpr int kDimension = 0;
  Vec3d position;
};

}  // namespace cs2mesh
