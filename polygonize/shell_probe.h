// Slots and fins that a mesh passes over, found from the mesh.
//
// If the surface is nowhere farther than a distance d from the mesh, then points at d above the
// mesh are outside and points at d below are inside, but where the shape itself is thinner. A slot
// that the mesh bridges shows as outside below, a fin that it cuts off as inside above.
#pragma once

#include <vector>

#include "libfield/base/progress.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/closest_point.h"
#include "polygonize/lost_point.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct ShellProbeOptions {
  double enough = 0.0;  ///< the distance, > 0
  /// Where F may have walls, between which there are slots and fins of any width, a triangle is
  /// looked at in points this far apart, in units of that, and at most 8 to its side; elsewhere in
  /// three points.
  double spacing = 0.8;
  /// Triangles without a vertex of this number or above are not looked at.
  TriangleMesh::Index first_new = 0;
  Progress* progress = nullptr;  ///< cancelled: the rest is left out
};

/// From points all over the mesh, `enough` above and below it, on to the end of whatever has the
/// wrong sign there: the points of the surface met, as far as they are too far from the mesh.
/// `tree` is that of the mesh. About two values a point.
///
/// Not promised: that slots and fins much smaller than the spacing are found.
std::vector<LostPoint> probe_shell(const ImplicitSurface& surface, const TriangleMesh& mesh,
                                   const ClosestPoint& tree, const ShellProbeOptions& options);

}  // namespace cs2mesh
