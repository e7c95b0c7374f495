// Morton codes: numbers for points such that neighbours in number are near each other in space.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "libfield/base/aabb.h"

namespace cs2mesh {

/// Spreads the lower 21 bits so that two zeros follow each.
inline std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffffULL;
  x = (x | x << 16) & 0x001f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

/// The code of a point of `all`, 21 bits an axis; points outside count as the nearest inside.
inline std::uint64_t morton_code(const Aabb& all, const Vec3d& p) {
  constexpr double kSteps = 0x1p21;
  std::uint64_t code = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double extent = all.max[axis] - all.min[axis];
    const double share = extent > 0 ? (p[axis] - all.min[axis]) / extent : 0.0;
    // Also where the extent overflows, or the share is not a number.
    const double step = share > 0 ? std::min(share * kSteps, kSteps - 1) : 0.0;
    code |= spread_bits(static_cast<std::uint64_t>(step)) << axis;
  }
  return code;
}

}  // namespace cs2mesh
