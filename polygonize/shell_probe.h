// Slots and fins that a mesh passes over, found from the mesh.
//
// If the surface is nowhere farther than a distance d from the mesh, then points at d above the
// mesh are outside and points at d below are inside, but where the shape itself is thinner. A slot
// that the mesh bridges shows as outside below, a fin that it cuts off as inside above.
#pragma once

#include <vector>

#include "libfield/field/implicit_surface.h"
#include "polygonize/closest_point.h"
#include "polygonize/lost_point.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct ShellProbeOptions {
  double enough = 0.0;  ///< the distance, > 0
  /// Between the points looked at, in units of that: where the second derivative of F is bounded,
  /// and where it may have walls, between which there are slots and fins of any width.
  double smooth_spacing = 2.0, creased_spacing = 0.6;
  /// Triangles without a vertex of this number or above are not looked at.
  TriangleMesh::Index first_new = 0;
};

/// From points all over the mesh, `enough` above and below it, on to the end of whatever has the
/// wrong sign there: the points of the surface met, as far as they are too far from the mesh.
/// `tree` is that of the mesh. About two values a point.
///
/// Not promised: that slots and fins much smaller than the spacing are found.
std::vector<LostPoint> probe_shell(const ImplicitSurface& surface, const TriangleMesh& mesh,
                                   const ClosestPoint& tree, const ShellProbeOptions& options);

}  // namespace cs2mesh
