#include "polygonize/lattice_cut.h"

#include <limits>
#include <string>

namespace cs2mesh {
namespace {

Diagnostic interrupted() {
  return error_at({}, "interrupted", Failure::interrupted);
}

/// Gives every block its place in the mesh; false if there are too many triangles or vertices.
bool number(std::vector<BlockCells>& blocks, std::size_t max_triangles,
            LatticeStatistics& statistics) {
  constexpr std::size_t kMostIndices = std::numeric_limits<TriangleMesh::Index>::max();
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (BlockCells& block : blocks) {
    if (vertices > kMostIndices || triangles > kMostIndices) return false;
    block.first_vertex = static_cast<std::uint32_t>(vertices);
    block.first_triangle = static_cast<std::uint32_t>(triangles);
    vertices += block.vertices;
    triangles += block.triangles;
    statistics.split_cells += block.splits.size();
  }
  statistics.vertices = vertices;
  statistics.triangles = triangles;
  return vertices <= kMostIndices && triangles <= kMostIndices && triangles <= max_triangles;
}

}  // namespace

Diagnostic too_many_triangles(std::size_t triangles) {
  return error_at({},
                  "the mesh would have " + std::to_string(triangles) +
                      " triangles, more than the limit; use a larger tolerance",
                  Failure::limit);
}

Result<std::unique_ptr<LatticeCut>> cut_lattice(const ImplicitSurface& surface,
                                                const LatticeOptions& options,
                                                LatticeStatistics& counts) {
  Progress* const progress = options.progress;
  counts = {};

  // Sample where the surface can be.
  report_mesh(progress, 0.0);
  Result<NarrowBand> band =
      NarrowBand::build(surface, {options.cell, options.origin, options.max_nodes, progress});
  if (!band) return Result<std::unique_ptr<LatticeCut>>::failure(band.diagnostics());
  counts.value_evaluations = band->counts().nodes_evaluated;
  counts.blocks_tested = band->counts().blocks_tested;
  counts.blocks_active = band->counts().blocks_active;

  // Clear the nodes next to it.
  report_mesh(progress, 0.4);
  auto cut = std::make_unique<LatticeCut>(*std::move(band));
  if (!cut->nodes.settle(progress)) return interrupted();
  counts.gradient_evaluations = cut->nodes.counts().jets;
  counts.moved_nodes = cut->nodes.counts().moved;
  counts.stuck_nodes = cut->nodes.counts().stuck;

  // Find and number the crossings, then place them.
  report_mesh(progress, 0.6);
  LatticeCells& cells = cut->cells;
  std::vector<BlockCells>& blocks = cells.blocks();
  if (!for_each_block(blocks.size(), progress, [&](std::size_t b) { cells.classify(b); })) {
    return interrupted();
  }
  if (!number(blocks, options.max_triangles, counts)) {
    return too_many_triangles(counts.triangles);
  }
  report_mesh(progress, 0.7);
  cut->crossings.resize(counts.vertices);
  const bool placed = for_each_block(
      blocks.size(), progress, [&](std::size_t b) { cells.place_vertices(b, cut->crossings); });
  if (!placed) return interrupted();
  for (const BlockCells& block : blocks) {
    counts.value_evaluations += block.values;
    counts.gradient_evaluations += block.jets;
    counts.clamped_roots += block.clamped;
  }
  report_mesh(progress, 0.8);
  return cut;
}

}  // namespace cs2mesh
