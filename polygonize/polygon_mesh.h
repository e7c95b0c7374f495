// From closed polygons with their corners near a surface, as meshers make them that place a vertex
// in a cell, to triangles with their corners on it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Polygons counter-clockwise seen from outside, over vertices near {F = 0}; neighbours in space
/// are mostly neighbours in number.
struct PolygonMesh {
  using Index = TriangleMesh::Index;
  std::vector<Vec3d> positions;
  std::vector<char> fixed;  ///< by vertex: whether it stays where it is, as at a crease; or empty
  std::vector<Vec3d> retreats;  ///< by vertex: where it goes where triangles cross; or empty
  std::vector<Index> corners;   ///< polygon after polygon, at least three each
  std::vector<Index> ends;      ///< by polygon: where its corners end

  std::size_t size() const { return ends.size(); }
  std::size_t triangle_count() const { return corners.size() - 2 * ends.size(); }
  std::span<const Index> polygon(std::size_t i) const {
    const std::size_t first = i == 0 ? 0 : ends[i - 1];
    return std::span(corners).subspan(first, ends[i] - first);
  }
};

struct SettleCounts {
  std::size_t jets = 0;      ///< evaluations; few more than these
  double off_surface = 0.0;  ///< largest distance of a vertex from the surface, scene units
};

struct SettleOptions {
  double reach = 0.0;  ///< farthest that a vertex is moved, scene units, > 0
  Progress* progress = nullptr;
};

/// Moves the vertices to points of the surface near them (to about 1e-4 of the way moved, mostly
/// far nearer), and cuts polygons into triangles: quadrilaterals along the diagonal that is nearer
/// to the surface and does not fold them, others ear by ear. Edges of triangles that face
/// away from the surface are flipped where that helps. Where triangles cross, vertices go to their
/// retreats, or back to where they came from: `counts` says how far off that leaves them.
///
/// The mesh is closed, oriented outward and 2-manifold, without degenerate triangles and, in a
/// build that can tell, without self-intersections: all that is checked. Errors:
/// Failure::check_failed where it is not so, Failure::interrupted. The same mesh, to the bit, for
/// any number of threads. About 4 jets a vertex, and a search for self-intersections.
Result<TriangleMesh> settle(const ImplicitSurface& surface, PolygonMesh polygons,
                            const SettleOptions& options, SettleCounts& counts);

}  // namespace cs2mesh
