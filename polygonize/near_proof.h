// Proofs that triangles are near a surface: F < 0 all over a triangle that is somewhat outside of
// it, and F > 0 all over one that is as far inside.
//
// The segments between those two cross the surface then, each no farther than that from its point
// of the triangle. How far F is from what it is at the corners is told by how it bends
// (bent_triangle.h), which for blobs is what a ball of their size bends: triangles that are well
// within the distance are mostly proven by what is known at their corners, which they share.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// For each of these triangles of the mesh, whether it is proven that every point of it is within
/// `distance` of the surface: scene units, > 0. `directions` holds for each vertex of the mesh the
/// way out, of length 1 or less; proofs succeed if it is near the normal of the surface, and the
/// vertex near the surface. The triangles are best near each other. Not promised: that a triangle
/// is proven which is near. A value and a jet a vertex, and a bound a triangle.
std::vector<bool> proven_near(const ImplicitSurface& surface, const TriangleMesh& mesh,
                              std::span<const std::size_t> triangles,
                              std::span<const Vec3d> directions, double distance);

/// For each vertex of a mesh that is closed and oriented a way out, of length 1: exact for those
/// that lie with their neighbours on a sphere (Max, "Weights for computing vertex normals from
/// facet normals", 1999). Zero where triangles leave none. O(n).
std::vector<Vec3d> ways_out(const TriangleMesh& mesh);

}  // namespace cs2mesh
