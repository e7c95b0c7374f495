// The lattice mesher: one triangle mesh from the signs of F at the nodes of a lattice.
//
// Cells of a cubical lattice are cut by the surface as their corner signs say (F >= 0 is inside). A
// cube without an ambiguous face yields its cycles from a table; a cube with one is cut into
// pyramids and tetrahedra around its centre (cell_table.h), as what hangs together in it by a finer
// grid of samples tells (cell_connection.h). Every vertex lies on one edge, and every cell at that
// edge has exactly one cycle through it, so the mesh is closed, oriented and 2-manifold for every
// pattern of signs. Nodes all but on the surface are moved first (lattice_nodes.h), so that no
// vertex comes close to a node and no triangle degenerates.
#pragma once

#include <cstddef>

#include "libfield/base/progress.h"
#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct LatticeOptions {
  double cell = 0.0;                       ///< side of a cell, > 0
  Vec3d origin{};                          ///< a node of the lattice
  std::size_t max_nodes = 400'000'000;     ///< memory: 8 bytes each, and as much again
  std::size_t max_triangles = 50'000'000;  ///< beyond either, Failure::limit
  Progress* progress = nullptr;
};

struct LatticeStatistics {
  std::size_t value_evaluations = 0;
  std::size_t gradient_evaluations = 0;
  std::size_t blocks_tested = 0;
  std::size_t blocks_active = 0;
  std::size_t moved_nodes = 0;
  std::size_t stuck_nodes = 0;    ///< near the surface, with no clearer place around
  std::size_t split_cells = 0;    ///< with an ambiguous face
  std::size_t clamped_roots = 0;  ///< vertices moved by 1e-6 of an edge off its end
  double off_surface = 0.0;       ///< largest distance of other vertices from the surface
  std::size_t vertices = 0;
  std::size_t triangles = 0;
};

/// Meshes {F = 0}; triangles are counter-clockwise seen from {F < 0}. Vertices are on the surface
/// to the rounding of F, except clamped ones. The same mesh, to the bit, for any number of threads.
///
/// Requires (ContractViolation): cell > 0, finite or empty bounds. Errors: Failure::limit,
/// Failure::interrupted. An empty mesh if no node is inside. Not promised: that features smaller
/// than a cell are seen, or that the mesh is free of self-intersections where the surface is wilder
/// than the lattice can follow; see mesh_to_tolerance() and check().
Result<TriangleMesh> mesh_lattice(const ImplicitSurface& surface, const LatticeOptions& options,
                                  LatticeStatistics* statistics = nullptr);

}  // namespace cs2mesh
