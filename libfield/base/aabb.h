// Axis-aligned boxes.
#pragma once

#include <algorithm>
#include <limits>

#include "libfield/base/vec.h"

namespace cs2mesh {

/// The closed box [min, max]; empty when any min exceeds its max, which is how it starts.
struct Aabb {
  Vec3d min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
            std::numeric_limits<double>::infinity()};
  Vec3d max{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
            -std::numeric_limits<double>::infinity()};

  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  bool finite() const { return is_finite(min) && is_finite(max); }
  Vec3d center() const { return 0.5 * (min + max); }
  Vec3d extent() const { return max - min; }
  double diagonal() const { return empty() ? 0.0 : norm(extent()); }

  /// The corner whose bits 0, 1, 2 choose min or max in x, y, z.
  Vec3d corner(int bits) const {
    return {bits & 1 ? max.x : min.x, bits & 2 ? max.y : min.y, bits & 4 ? max.z : min.z};
  }
  bool contains(const Vec3d& p) const {
    return min.x <= p.x && p.x <= max.x && min.y <= p.y && p.y <= max.y && min.z <= p.z &&
           p.z <= max.z;
  }
  bool contains(const Aabb& box) const { return contains(box.min) && contains(box.max); }
  bool overlaps(const Aabb& box) const {
    return min.x <= box.max.x && box.min.x <= max.x && min.y <= box.max.y && box.min.y <= max.y &&
           min.z <= box.max.z && box.min.z <= max.z;
  }
  void include(const Vec3d& p) {
    min = cs2mesh::min(min, p);
    max = cs2mesh::max(max, p);
  }
  void include(const Aabb& box) {
    min = cs2mesh::min(min, box.min);
    max = cs2mesh::max(max, box.max);
  }
  /// The box grown by `margin` >= 0 on every side.
  Aabb grown(double margin) const {
    const Vec3d m{margin, margin, margin};
    return {min - m, max + m};
  }
  Vec3d clamp(const Vec3d& p) const { return cs2mesh::max(min, cs2mesh::min(max, p)); }
  /// Distance from `p` to the nearest point of the box; 0 inside.
  double distance(const Vec3d& p) const { return norm(p - clamp(p)); }
  /// Distance from `p` to the farthest point of the box.
  double farthest_distance(const Vec3d& p) const { return norm(cs2mesh::max(max - p, p - min)); }
  /// Gap between two boxes; 0 when they touch.
  double distance(const Aabb& box) const {
    const Vec3d zero{};
    return norm(cs2mesh::max(zero, cs2mesh::max(box.min - max, min - box.max)));
  }
  friend bool operator==(const Aabb&, const Aabb&) = default;
};

}  // namespace cs2mesh
