// Components of meshes that are not wanted are left out: small ones, and those that nobody sees
// from outside.
#pragma once

#include <cstddef>

#include "libfield/base/progress.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct LeaveOutOptions {
  /// Components go whose box has a shorter diagonal than this; scene units.
  double smallest = 0.0;
  /// Whether components go that lie inside of others: voids, and what is in them.
  bool enclosed = false;
  /// Whether a component of one part may lie inside of one of another. Not for parts that
  /// intersect.
  bool across_parts = false;
  Progress* progress = nullptr;
};

/// What was left out.
struct LeftOut {
  struct Tally {
    std::size_t components = 0;
    std::size_t voids = 0;  ///< of these: wound inwards
    double area = 0.0;
  };
  Tally small, enclosed;  ///< small ones that are enclosed as well count as small

  bool nothing() const { return small.components + enclosed.components == 0; }
};

/// Takes whole components (connected through vertices) out of the parts, which are without
/// attributes but for their sources. Parts of which all is left out remain, without triangles;
/// those of which nothing is left out stay as they are, to the bit.
///
/// Each part is closed, oriented and 2-manifold, and then still is; parts that touch nothing still
/// touch nothing. Which side of a component is inside is told by the sign of its volume, and
/// whether it lies inside of another by the winding number about one of its vertices: certain but
/// where meshes touch. A component whose sign is lost in rounding encloses nothing.
///
/// Of the distances to the surface, that from the mesh stays what it was; that from the surface
/// holds for what is kept alone. Cancelled, it leaves the model as it was. The same result for any
/// number of threads. O(n log n), and where components are to be enclosed, the sum over these of
/// the triangles of those whose boxes hold them.
LeftOut leave_out(Model& model, const LeaveOutOptions& options);

}  // namespace cs2mesh
