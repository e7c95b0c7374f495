// Triangles that cross others, looked for in parts of a mesh.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "polygonize/self_intersection.h"
#include "polygonize/triangle_set.h"

namespace cs2mesh {

/// The pairs of find_self_intersections() of which both triangles meet one of `boxes`; nothing from
/// a build without CGAL. O(n log k) for k boxes, and what is found in them.
SelfIntersections find_intersections_near(const TriangleMesh& mesh, std::vector<Aabb> boxes,
                                          std::size_t most_pairs);

/// The pairs of which one triangle at least is not of `apart`, a set of triangles of which no two
/// cross.
SelfIntersections find_new_intersections(const TriangleMesh& mesh, const TriangleSet& apart,
                                         std::size_t most_pairs);

/// A corner of each triangle of the pairs.
std::vector<Vec3d> places_of(const SelfIntersections& found, const TriangleMesh& mesh);

}  // namespace cs2mesh
