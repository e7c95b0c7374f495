// From points near a surface {F = 0} to points on it.
#pragma once

#include <limits>
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

/// The distance of `p` from the nearest of the sign changes met along axes and diagonals on growing
/// spheres about it: an upper bound of its distance from the surface. `farthest` if there is none
/// nearer. For places where F has walls, from which no gradient points at the surface; some 300
/// values.
double searched_distance(const ImplicitSurface& surface, const Vec3d& p, double farthest);

}  // namespace cs2mesh
