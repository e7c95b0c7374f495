// Which parts of a model meet, where, and which lie inside others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Two parts, the lower index first, that have a point in common.
struct PartContact {
  std::size_t a = 0, b = 0;
  /// Triangles, of `a` and of `b`, that intersect. A build without CGAL cannot tell, and has all
  /// triangles of one part whose boxes overlap the other part's box as pairs with triangle 0.
  std::vector<std::array<std::uint32_t, 2>> triangles;
};

/// All contacts of the closed meshes of a model, by index. Parts whose boxes are apart are not
/// looked at any closer. Exact. O(n log n) for the triangles in overlaps of boxes of parts.
std::vector<PartContact> find_contacts(const Model& model);

/// Removes from `mesh` the components (connected through vertices) that lie inside of the solid
/// that `solid` bounds; returns whether there were any. Both are closed and do not meet. By the
/// winding number about a vertex of each component whose box is inside that of `solid`: O(n) each.
bool remove_components_inside(TriangleMesh& mesh, const TriangleMesh& solid);

}  // namespace cs2mesh
