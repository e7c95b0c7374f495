// Points of a surface {F = 0} straight above or below given points.
#pragma once

#include <optional>
#include <span>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

/// A point and the line on which to look for the surface.
struct RootQuery {
  Vec3d point;
  Vec3d direction;     ///< unit; either way counts
  double guess = 0.0;  ///< distance at which the surface is expected
  double limit = 0.0;  ///< farthest distance looked at
};

/// For each query a root of F on its line within `limit` of its point, to the rounding of F:
/// between the two ends of a stretch about the point that grows from `guess` by doubling until F
/// differs in sign there. Nothing where it does not up to `limit`. The root need not be the
/// nearest. The points are neighbours. Four or five jets a query where the guess is good.
void find_near_roots(const ImplicitSurface& surface, std::span<const RootQuery> queries,
                     std::span<std::optional<Vec3d>> roots);

}  // namespace cs2mesh
