// The straight segment from a to b; its measure is its length.
#pragma once

#include "libfield/base/aabb.h"
#include "libfield/base/affine.h"
#include "libfield/base/vec.h"
#include "libfield/primitive/frame.h"

namespace cs2mesh {

struct Segment {
  static constexpr int kDimension = 1;
  Vec3d a, b;
};

/// Length.
double measure(const Segment& segment);
/// Distance from `p` to the primitive; absolute error of a few ulp of the distance and of the
/// primitive's size.
double distance(const Segment& segment, const Vec3d& p);
/// The smallest box.
Aabb bounds(const Segment& segment);
/// Mid-point.
Vec3d middle(const Segment& segment);
/// Length.
double size(const Segment& segment);
/// u: 0 at a to 1 at b, clamped beyond; v: turns about the axis from its reference_axis, [0, 1).
Uv uv(const Segment& segment, const Vec3d& p);
/// Contains (u, v) for all points of the box; a whole range where the box meets a seam or an axis.
UvIntervals enclose_uv(const Segment& segment, const Aabb& box);
/// The image under the map. Any map.
Segment transformed(const Segment& segment, const Affine& map);

}  // namespace cs2mesh
