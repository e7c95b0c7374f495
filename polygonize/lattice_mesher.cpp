#include "polygonize/lattice_mesher.h"

#include "polygonize/lattice_cut.h"

namespace cs2mesh {

Result<TriangleMesh> mesh_lattice(const ImplicitSurface& surface, const LatticeOptions& options,
                                  LatticeStatistics* statistics) {
  LatticeStatistics counts;
  Result<std::unique_ptr<LatticeCut>> cut = cut_lattice(surface, options, counts);
  if (!cut) return Result<TriangleMesh>::failure(cut.diagnostics());

  // Join the crossings.
  const LatticeCells& cells = (*cut)->cells;
  TriangleMesh mesh;
  mesh.positions = std::move((*cut)->crossings);
  mesh.triangles.resize(counts.triangles);
  const bool joined = for_each_block(counts.blocks_active, options.progress, [&](std::size_t b) {
    cells.make_triangles(b, mesh.positions, mesh.triangles);
  });
  if (!joined) return error_at({}, "interrupted", Failure::interrupted);
  report_mesh(options.progress, 1.0);
  if (statistics != nullptr) *statistics = counts;
  return mesh;
}

}  // namespace cs2mesh
