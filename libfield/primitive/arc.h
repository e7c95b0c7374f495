// The circular arc q(t) = C + c (ex cos t + ey sin t), |t| <= sweep / 2; its measure is its length
// c * sweep.
#pragma once

#include "libfield/base/vec.h"

namespace cs2mesh {

/// Unit, mutually orthogonal ex (towards the middle of the arc), ey (towards growing angle) and
/// normal. Any handedness is allowed: a mirrored arc is an arc.
struct Arc {
  static constexpr int kDimension = 1;
  Vec3d center;
  double radius = 1.0;  ///< c > 0
  Vec3d ex{1, 0, 0}, ey{0, 1, 0}, normal{0, 0, 1};
  double sweep = 0.0;  ///< radians, 0 < sweep <= 2 pi
};

}  // namespace cs2mesh
