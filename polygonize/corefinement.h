// The union of two closed meshes by corefinement: both are cut along their intersection, and what
// lies inside the other is left out.
#pragma once

#include <cstdint>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// A closed mesh with a number for each triangle, such as that of the part it came from.
struct TaggedMesh {
  TriangleMesh mesh;  ///< without attributes
  std::vector<std::uint32_t> tags;
};

struct CorefinedUnion {
  enum class Outcome {
    united,
    not_manifold,  ///< the solids touch at a vertex or an edge
    broken_input,  ///< a mesh is not closed or manifold, or intersects itself at the crease
    no_cgal,       ///< this build cannot
  };
  Outcome outcome = Outcome::no_cgal;
  TaggedMesh mesh;             ///< empty unless united
  std::vector<char> is_fresh;  ///< one a vertex: on the crease, not a vertex of either mesh before
};

/// Whether this build has CGAL.
bool has_corefinement();

/// The boundary of the union of what two meshes enclose; each triangle has the tag of the one it
/// was cut from. Which triangles intersect, and
/// how, is decided exactly; fresh vertices are the exact intersections, rounded, so that triangles
/// next to them may have a height of about the rounding, or turn over by as much.
///
/// The meshes are closed, oriented outwards, 2-manifold and without self-intersections. The same
/// result each time. O(n log n + triangles at the crease).
CorefinedUnion corefined_union(const TaggedMesh& a, const TaggedMesh& b);

}  // namespace cs2mesh
