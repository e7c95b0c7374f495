// Whether a function grows along one direction all over a box, asked part by part.
#pragma once

#include <array>
#include <cstddef>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

/// Asks whether F changes its sign at most once along every line of a direction in a box: where it
/// grows along it on the surface in every part of the box, one direction for all.
struct Grower {
  const ImplicitSurface& surface;
  Vec3d direction;
  std::size_t slopes = 0;  ///< that were asked for

  /// Whether F grows so along `direction`. Up to some hundred slopes.
  bool grows_along(const Aabb& box);
  /// Whether F grows so along some direction; `direction` is its gradient somewhere in the box.
  bool grows_somehow(const Aabb& box);

 private:
  bool grows_in_parts(const ImplicitSurface& part, const Aabb& box, int cuts);
  std::array<Aabb, 2> halves(const Aabb& box) const;
};

}  // namespace cs2mesh
