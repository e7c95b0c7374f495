// Points of a surface between the vertices of a mesh on it, where it turns much from one to the
// next.
#pragma once

#include <span>
#include <vector>

#include "polygonize/surface_octree.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// For each edge between whose ends the normals turn by more than some 14 degrees, and the surface
/// may rise by more than four times `close` for that, a point of the surface above its middle,
/// found by Newton's method; without those that do not come within `close` of it, in scene units,
/// in three steps. Each vertex is on the surface, which has its
/// normal there, near its leaf of the tree. One to three jets a point.
std::vector<Vec3d> points_half_way(const ImplicitSurface& surface, const SurfaceOctree& tree,
                                   const TriangleMesh& mesh, std::span<const Vec3d> normals,
                                   std::span<const Octree::Index> leaf_of, double close);

}  // namespace cs2mesh
