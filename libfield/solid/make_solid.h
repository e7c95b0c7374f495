// A hard element of the scene as an implicit surface.
#pragma once

#include <memory>

#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "libfield/scene/scene.h"

namespace cs2mesh {

struct MadeSolid {
  std::shared_ptr<const ImplicitSurface> surface;
  /// In scene units, the smallest under a non-uniform scale; of a cone the half of its larger
  /// radius, of a box that of its shortest side, of a quadric its least half axis or radius of
  /// curvature; between flat lids or ends no more than half their distance. 0 where there is none.
  double radius = 0.0;
  bool creased = false;  ///< flat lids or ends, faces, reflex corners
};

/// With `offset` (`soft off`), the offset surface that a soft element becomes: round ends, but for
/// the flat lids of a cylinder. Otherwise the ordinary solid: a sphere, a cylinder or pipe with
/// lids, an arc or arch with flat ends, the half-space below a plane, a cone with lids, a box, a
/// quadric. Error, at the element: a flat thing without thickness, no radius in force, a quadric
/// without inside.
Result<MadeSolid> make_solid(const Scene& scene, const Element& element, bool offset);

}  // namespace cs2mesh
