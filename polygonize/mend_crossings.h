// Triangles that cross others, taken apart.
#pragma once

#include "libfield/field/implicit_surface.h"
#include "polygonize/self_intersection.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

enum class Crossings {
  none,    ///< there were none; also without a look in a build that cannot tell
  mended,  ///< there are none any more
  left,
};

/// Collapses or flips edges of triangles that cross others, a few times over; where that does not
/// help, moves their corners to the middle of their neighbours and back to the surface, more of the
/// neighbourhood each time. `reach` is how far from the
/// surface vertices may come to be, scene units, > 0. Not promised: that triangles stay as near to
/// the surface as they were.
Crossings mend_crossings(const ImplicitSurface& surface, TriangleMesh& mesh, double reach);
/// The same, begun with these pairs of triangles that cross; whether there are others is looked for
/// when they are mended.
Crossings mend_crossings(const ImplicitSurface& surface, TriangleMesh& mesh, double reach,
                         SelfIntersections found);

}  // namespace cs2mesh
