// Points of the surface that a mesh misses, made vertices of it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libfield/field/implicit_surface.h"
#include "polygonize/lost_point.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Joins points of the surface to the triangles that miss them, the farthest first, as tents over
/// the triangle or over one of its edges. A point is left out where another has been joined to the
/// same triangle, where its tent would be folded onto a neighbour (fold.h), and where it is the
/// point of the mesh, since no surface was found from there. The mesh stays closed, oriented and
/// 2-manifold. Returns the numbers of the points joined.
///
/// Not promised: that tents do not run into other parts of the mesh.
std::vector<std::size_t> insert_points(const ImplicitSurface& surface, TriangleMesh& mesh,
                                       std::span<const LostPoint> points);

}  // namespace cs2mesh
