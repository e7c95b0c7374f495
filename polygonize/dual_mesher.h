// The dual mesher: a vertex for every piece of surface in a cell of a lattice, and a quadrilateral
// around every lattice edge that the surface crosses (dual contouring; Ju, Losasso, Schaefer and
// Warren 2002, with a vertex a piece as in the dual marching cubes of Nielson 2004).
//
// Cells, signs and crossings are those of the lattice mesher (lattice_mesher.h): cells with an
// ambiguous face are cut into pyramids and tetrahedra. Its polygons, one a piece of surface, are a
// closed oriented 2-manifold in which no two have more than one side in common, and this mesh is
// the dual of that: so it is closed, oriented and 2-manifold for every pattern of signs, diagonals
// included (cells that are opposite each other at an edge have nothing but that edge in common).
//
// Where the tangent planes at the crossings of a cell agree, its vertex is put on the surface near
// their middle. Where they do not, it goes to the point nearest to all the planes (plane_fit.h);
// planes are then taken nearer to that point, three times. If they still do not agree there is a
// crease, and the vertex stays.
#pragma once

#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/lattice_mesher.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Meshes {F = 0}; triangles are counter-clockwise seen from {F < 0}. Vertices are on the surface
/// to about 1e-4 of a cell or better; those at creases to 1e-2 of a cell, mostly far nearer,
/// exactly where the faces are flat; statistics tell how far vertices are off. The same mesh, to
/// the bit, for any number of threads.
///
/// Requires (ContractViolation): cell > 0, finite or empty bounds. Errors: Failure::limit,
/// Failure::interrupted; Failure::check_failed where the cell is too large for the surface, so that
/// triangles cross. An empty mesh if no node is inside. Not promised: that features smaller than a
/// cell are seen; nor, in a build without CGAL, that no triangles cross. Of the statistics,
/// clamped_roots counts crossings, not vertices.
Result<TriangleMesh> mesh_dual(const ImplicitSurface& surface, const LatticeOptions& options,
                               LatticeStatistics* statistics = nullptr);

}  // namespace cs2mesh
