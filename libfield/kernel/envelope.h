// What the kernels share to bound themselves.
#pragma once

#include <cmath>

namespace cs2mesh {

/// `bound` >= 0 widened by 1e-12 of itself: far above the rounding of any kernel's few operations.
inline double rounded_up(double bound) {
  return bound * (1.0 + 1e-12);
}

}  // namespace cs2mesh
