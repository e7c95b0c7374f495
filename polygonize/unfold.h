// Triangles that look away from the surface they are to follow, turned by turning edges.
#pragma once

#include <cstddef>
#include <span>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Looks for triangles that turn their back on the surface or stand across it, as slivers between
/// corners nearly in line do, and flips an edge of each where the worse of the two triangles then
/// follows the surface better. `normals` are those of the surface at the vertices, outward and of
/// length one, or zero where none is known. Returns how many edges were flipped.
///
/// Contract: `mesh` is closed, oriented and manifold along its edges, and has one normal a vertex;
/// it stays closed, oriented and 2-manifold. Not promised: that every such triangle can be helped.
std::size_t unfold(TriangleMesh& mesh, std::span<const Vec3d> normals);

}  // namespace cs2mesh
