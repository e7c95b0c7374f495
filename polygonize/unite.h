// Parts that touch become one mesh: the boundary of the union of what they enclose.
//
// Each part is a closed mesh of a smooth surface (or of a solid with its own creases); where two
// cross, corefinement cuts both along the polyline in which they intersect, and drops what lies
// inside. The polyline lies on both meshes, and so within the tolerance of both surfaces.
#pragma once

#include <cstddef>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/base/result.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct UniteOptions {
  /// What the meshes were made to, scene units, > 0. Along creases, vertices nearer to each other
  /// than 1/64 of it (1/8 where that is not enough for a sound mesh) may become one.
  double tolerance = 0.0;
  std::vector<SourceLocation> where;  ///< of each part, for messages; may be empty
  Progress* progress = nullptr;
};

/// Whether this build can unite parts that meet; without CGAL it cannot.
bool can_unite();

/// Unites the parts that have a point in common, each group of them into one part at the place of
/// its first, with `sources` set. A component that lies inside of another part disappears, with a
/// note where nothing of the part is left. All other parts stay as they are, to the bit.
///
/// Every part is closed, oriented outwards, 2-manifold, without self-intersections and attributes;
/// so is the result, and also when its coordinates are rounded to float32, unless the tolerance is
/// too near to that rounding for it. Where two solids only touch, or their faces coincide, one of
/// them is moved by up to 1/16 of the tolerance if it must be, so that they overlap.
///
/// Errors: parts that could not be united for all that (check_failed), parts that meet and a build
/// without CGAL (unmeshable), interrupted. The same result for any number of threads.
/// O(n log n) for each time a triangle's part is united, about the logarithm of the group's size.
///
/// Not promised: how far the crease is from the crease of the surfaces, which for two that cross at
/// an angle a (outside of both) may be tolerance / sin(a / 2); see refine_at_creases().
Result<Model> unite(Model model, const UniteOptions& options);

}  // namespace cs2mesh
