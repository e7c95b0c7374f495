// The flat triangle; its measure is its area.
#pragma once

#include <array>

#include "libfield/base/aabb.h"
#include "libfield/base/affine.h"
#include "libfield/base/vec.h"
#include "libfield/primitive/frame.h"

namespace cs2mesh {

struct Triangle {
  static constexpr int kDimension = 2;
  std::array<Vec3d, 3> vertex;
};

/// Normal of the triangle times twice its area, from its two shortest edges (so that a sliver keeps
/// its direction); counter-clockwise vertices see it point towards them.
Vec3d area_vector(const Triangle& triangle);

/// Area.
double measure(const Triangle& triangle);
/// Distance from `p` to the primitive; absolute error of a few ulp of the distance and of the
/// primitive's size.
double distance(const Triangle& triangle, const Vec3d& p);
/// The smallest box.
Aabb bounds(const Triangle& triangle);
/// Centroid.
Vec3d middle(const Triangle& triangle);
/// The longest edge.
double size(const Triangle& triangle);
/// Orthogonal projection V1 + u (V2 - V1) + v (V3 - V1), each clamped to [0, 1]; 0 if the
/// triangle has no area.
Uv uv(const Triangle& triangle, const Vec3d& p);
/// Contains (u, v) for all points of the box; a whole range where the box meets a seam or an axis.
UvIntervals enclose_uv(const Triangle& triangle, const Aabb& box);
/// The image under the map. Any map.
Triangle transformed(const Triangle& triangle, const Affine& map);

}  // namespace cs2mesh
