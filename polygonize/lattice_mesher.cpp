#include "polygonize/lattice_mesher.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <limits>
#include <string>

#include "polygonize/lattice_cells.h"
#include "polygonize/lattice_nodes.h"
#include "polygonize/narrow_band.h"

namespace cs2mesh {
namespace {

Diagnostic interrupted() {
  return error_at({}, "interrupted", Failure::interrupted);
}

/// Runs f(block) for all blocks; false if cancelled.
template <class F>
bool for_each_block(std::size_t count, Progress* progress, F&& f) {
  std::atomic<bool> stopped{false};
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t block) {
    if (cancelled(progress)) stopped = true;
    if (!stopped) f(block);
  });
  return !stopped;
}

void report(Progress* progress, double fraction) {
  if (progress != nullptr) progress->report("mesh", fraction);
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

Result<TriangleMesh> mesh_lattice(const ImplicitSurface& surface, const LatticeOptions& options,
                                  LatticeStatistics* statistics) {
  LatticeStatistics counts;
  Progress* const progress = options.progress;

  // Sample where the surface can be.
  report(progress, 0.0);
  const Result<NarrowBand> band =
      NarrowBand::build(surface, {options.cell, options.origin, options.max_nodes, progress});
  if (!band) return Result<TriangleMesh>::failure(band.diagnostics());
  counts.value_evaluations = band->counts().nodes_evaluated;
  counts.blocks_tested = band->counts().blocks_tested;
  counts.blocks_active = band->counts().blocks_active;

  // Clear the nodes next to it.
  report(progress, 0.4);
  LatticeNodes nodes(*band);
  if (!nodes.settle(progress)) return interrupted();
  counts.gradient_evaluations = nodes.counts().jets;
  counts.moved_nodes = nodes.counts().moved;
  counts.stuck_nodes = nodes.counts().stuck;

  // Find and number the crossings, then place and join them.
  report(progress, 0.6);
  LatticeCells cells(nodes);
  std::vector<BlockCells>& blocks = cells.blocks();
  if (!for_each_block(blocks.size(), progress, [&](std::size_t b) { cells.classify(b); })) {
    return interrupted();
  }
  if (!number(blocks, options.max_triangles, counts)) {
    return error_at({},
                    "the mesh would have " + std::to_string(counts.triangles) +
                        " triangles, more than the limit; use a larger tolerance",
                    Failure::limit);
  }
  report(progress, 0.7);
  TriangleMesh mesh;
  mesh.positions.resize(counts.vertices);
  mesh.triangles.resize(counts.triangles);
  const bool placed = for_each_block(
      blocks.size(), progress, [&](std::size_t b) { cells.place_vertices(b, mesh.positions); });
  if (!placed) return interrupted();
  report(progress, 0.9);
  const bool joined = for_each_block(blocks.size(), progress, [&](std::size_t b) {
    cells.make_triangles(b, mesh.positions, mesh.triangles);
  });
  if (!joined) return interrupted();
  report(progress, 1.0);

  for (const BlockCells& block : blocks) {
    counts.gradient_evaluations += block.jets;
    counts.clamped_roots += block.clamped;
  }
  if (statistics != nullptr) *statistics = counts;
  return mesh;
}

}  // namespace cs2mesh
