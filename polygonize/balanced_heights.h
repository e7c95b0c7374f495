// How far vertices may be lifted off a surface to have it as far above triangles as below.
#pragma once

#include <span>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// For each vertex of a mesh on a surface with these unit normals, the middle between how far the
/// surface is below and above the triangles there, as the normals tell it (sagitta.h): positive
/// where it is convex, about 0 over saddles. In scene units, along the normals, no more than `most`
/// either way. 0 for vertices without triangles; those whose first two corners are the same are
/// left out. O(n).
std::vector<double> balanced_heights(const TriangleMesh& mesh, std::span<const Vec3d> normals,
                                     double most);

}  // namespace cs2mesh
