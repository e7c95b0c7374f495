// From points near a surface {F = 0} to points on it.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

/// Where a point comes to lie on the surface.
struct Projection {
  double distance = std::numeric_limits<double>::infinity();
  Vec3d foot;
  Vec3d gradient;  ///< of F, at the foot or within a fraction of `distance` from it
};

/// For each point a point of the surface near it: along the gradient of F as far as to a change of
/// sign, which proves that there is surface no farther than 1.05 `distance` (and, where the
/// gradient varies, than `distance`). A foot from which the point does not lie along the normal
/// slides along the surface to where it does. Where the straight way leads nowhere, up or down the
/// gradient in short steps, then along the directions of growing spheres up to `search_limit`;
/// infinite distance if that finds nothing either. The foot may be that of a local minimum of the
/// distance. `local` is `surface` restricted to `box`, which contains the points. O(1) jets a
/// point, two where F is nearly linear over the distance.
void project(const ImplicitSurface& surface, const ImplicitSurface& local, const Aabb& box,
             std::span<const Vec3d> points, double search_limit, std::span<Projection> out);
/// The same with a restriction to the box of the points, which are near each other.
void project(const ImplicitSurface& surface, std::span<const Vec3d> points, double search_limit,
             std::span<Projection> out);

/// A stretch of a straight line across which F changes its sign.
struct SignChange {
  double distance = 0.0;  ///< of its far end from the point that was searched from
  Vec3d near, far;        ///< its ends; no farther apart than 1/256 of `distance`
};

/// The nearest of the sign changes met along axes and diagonals on growing spheres about `p`, from
/// farthest / 32 to `farthest`: its distance is an upper bound of that of the surface. For places
/// where F has walls, from which no gradient points at the surface; up to some 300 values. Closely:
/// also where F leads along each sphere, for tips between those lines; up to some 140 jets more.
std::optional<SignChange> search_around(const ImplicitSurface& surface, const Vec3d& p,
                                        double farthest, bool closely = false);

/// A point of the surface near `p`, from which `first_order` is the distance to judge by value and
/// gradient: Newton's method along the gradient may run past a wall that is nearer, so that and a
/// search all around are tried. Its distance bounds that of the surface if either finds anything;
/// if neither does, it is `p` itself with `first_order`. A point no farther than `enough` will do.
struct Foot {
  Vec3d point;
  double distance = 0.0;
};
Foot find_foot(const ImplicitSurface& surface, const Vec3d& p, double first_order,
               double enough = 0.0);

}  // namespace cs2mesh
