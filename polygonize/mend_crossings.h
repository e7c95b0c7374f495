// Triangles that cross others, taken apart.
#pragma once

#include <vector>

#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

enum class Crossings {
  none,    ///< there were none; also without a look in a build that cannot tell
  mended,  ///< there are none any more
  left,
};

struct MendedCrossings {
  Crossings outcome = Crossings::none;
  std::vector<Vec3d> left;  ///< a corner of each triangle that still crosses another
};

/// A corner of each triangle that crosses another; of 20,000 at most, and none in a build that
/// cannot tell.
std::vector<Vec3d> crossing_places(const TriangleMesh& mesh);

/// Collapses or flips edges of triangles that cross others, a few times over; where that does not
/// help, moves their corners to the middle of their neighbours and back to the surface, more of the
/// neighbourhood each time. `reach` is how far from the
/// surface vertices may come to be, scene units, > 0. Not promised: that triangles stay as near to
/// the surface as they were.
MendedCrossings mend_crossings(const ImplicitSurface& surface, TriangleMesh& mesh, double reach);

}  // namespace cs2mesh
