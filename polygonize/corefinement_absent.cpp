// Built in the place of corefinement.cpp where there is no CGAL.
#include "polygonize/corefinement.h"

namespace cs2mesh {

bool has_corefinement() {
  return false;
}

CorefinedUnion corefined_union(const TaggedMesh& /*a*/, const TaggedMesh& /*b*/) {
  return {};
}

}  // namespace cs2mesh
