// The circular arc q(t) = C + c (ex cos t + ey sin t), |t| <= sweep / 2; its measure is its length
// c * sweep.
#pragma once

#include <optional>
#include <variant>

#include "libfield/base/aabb.h"
#include "libfield/base/affine.h"
#include "libfield/base/vec.h"
#include "libfield/primitive/frame.h"
#include "libfield/primitive/segment.h"

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

/// Length.
double measure(const Arc& arc);
/// Distance from `p` to the primitive; absolute error of a few ulp of the distance and of the
/// primitive's size.
double distance(const Arc& arc, const Vec3d& p);
/// The smallest box, rounded outward.
Aabb bounds(const Arc& arc);
/// The point half-way along it.
Vec3d middle(const Arc& arc);
/// The greatest distance between two of its points.
double size(const Arc& arc);
/// u: 0 to 1 along it, clamped beyond its ends (the rest of the circle split at its middle);
/// v: turns about the circle's line, from outward in its plane towards the normal, [0, 1).
Uv uv(const Arc& arc, const Vec3d& p);
/// Contains (u, v) for all points of the box; a whole range where the box meets a seam or an axis.
UvIntervals enclose_uv(const Arc& arc, const Aabb& box);
/// The image under the map. It must be a similarity (similarity_factor > 0).
Arc transformed(const Arc& arc, const Affine& map);

/// The arc about `normal` (not zero; counter-clockwise seen against it) of `width_degrees` from
/// `start_degrees`, which is counted from reference_axis(normal). A negative width runs backwards;
/// widths beyond a turn are a full circle.
Arc make_arc(const Vec3d& center, double radius, const Vec3d& normal, double start_degrees,
             double width_degrees);
/// The same with angles counted from the part of `x_axis` that is perpendicular to the normal.
Arc make_arc(const Vec3d& center, double radius, const Vec3d& normal, const Vec3d& x_axis,
             double start_degrees, double width_degrees);
/// The circular arc from p1 through p2 to p3; the segment p1 p3 if they are collinear (the cross
/// product of p2 - p1 and p3 - p1 at most 1e-9 of the product of lengths) with p2 between; nothing
/// if there is no such arc.
std::optional<std::variant<Segment, Arc>> make_arch(const Vec3d& p1, const Vec3d& p2,
                                                    const Vec3d& p3);

}  // namespace cs2mesh
