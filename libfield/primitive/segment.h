// The straight segment from a to b; its measure is its length.
#pragma once

#include "libfield/base/vec.h"

namespace cs2mesh {

struct Segment {
  static constexpr int kDimension = 1;
  Vec3d a, b;
};

}  // namespace cs2mesh
