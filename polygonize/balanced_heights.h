// Vertices off the surface, so that it is as far above the triangles as below.
#pragma once

#include <span>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// For each vertex the height above the surface, in scene units, at which the surface is as far
/// above the triangle around it that asks for most as below; within [-most, most], 0 without
/// triangles. `mesh` has its vertices on the surface, whose outward unit `normals` there tell how
/// far it is from each triangle, to second order; triangles with a corner twice do not count. O(n).
std::vector<double> balanced_heights(const TriangleMesh& mesh, std::span<const Vec3d> normals,
                                     double most);

}  // namespace cs2mesh
