// Polygons in space cut into triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "libfield/base/vec.h"

namespace cs2mesh {

/// Cuts ears off a polygon until three corners are left or none can be cut, the one with the
/// shortest chord first; calls emit(a, b, c) for each, turning as the polygon does. A chord between
/// corners a and b is drawn only if may_join(a, b). Returns the number of corners left, which are
/// the first of `polygon`. O(n^2).
template <class MayJoin, class Emit>
std::size_t cut_ears(std::span<std::uint32_t> polygon, std::span<const Vec3d> positions,
                     const MayJoin& may_join, const Emit& emit) {
  std::size_t n = polygon.size();
  while (n > 3) {
    const auto before = [&](std::size_t i) { return polygon[i == 0 ? n - 1 : i - 1]; };
    const auto after = [&](std::size_t i) { return polygon[i + 1 == n ? 0 : i + 1]; };
    std::size_t ear = n;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      const double chord = squared_norm(positions[after(i)] - positions[before(i)]);
      if (chord < shortest && may_join(before(i), after(i))) {
        shortest = chord;
        ear = i;
      }
    }
    if (ear == n) return n;
    emit(before(ear), polygon[ear], after(ear));
    std::copy(polygon.begin() + static_cast<std::ptrdiff_t>(ear) + 1,
              polygon.begin() + static_cast<std::ptrdiff_t>(n),
              polygon.begin() + static_cast<std::ptrdiff_t>(ear));
    --n;
  }
  return n;
}

}  // namespace cs2mesh
