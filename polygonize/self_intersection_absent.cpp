// Built in the place of self_intersection.cpp where there is no CGAL.
#include "polygonize/self_intersection.h"

namespace cs2mesh {

std::optional<SelfIntersections> find_self_intersections(const TriangleMesh& /*mesh*/,
                                                         std::size_t /*most_pairs*/) {
  return std::nullopt;
}

}  // namespace cs2mesh
