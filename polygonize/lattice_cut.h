// A lattice cut by a surface: what meshers on cells of one size have in common.
#pragma once

#include <tbb/parallel_for.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/base/result.h"
#include "polygonize/lattice_cells.h"
#include "polygonize/lattice_mesher.h"
#include "polygonize/lattice_nodes.h"
#include "polygonize/narrow_band.h"

namespace cs2mesh {

/// Band, settled nodes, and cells whose crossed edges are found, numbered and placed.
struct LatticeCut {
  explicit LatticeCut(NarrowBand sampled)
      : band(std::move(sampled)), nodes(band), cells(nodes), crossings() {}
  LatticeCut(const LatticeCut&) = delete;
  LatticeCut& operator=(const LatticeCut&) = delete;

  NarrowBand band;
  LatticeNodes nodes;
  LatticeCells cells;
  std::vector<Vec3d>
      crossings;  ///< where the surface crosses edges, by the numbers of LatticeCells
};

/// As mesh_lattice(), up to the placing of vertices; all counts of `statistics` are set.
Result<std::unique_ptr<LatticeCut>> cut_lattice(const ImplicitSurface& surface,
                                                const LatticeOptions& options,
                                                LatticeStatistics& statistics);

/// Tells how much of the mesh on cells of one size is done, 0..1.
inline void report_mesh(Progress* progress, double fraction) {
  if (progress != nullptr) progress->report("mesh", fraction);
}

/// Of Failure::limit, for a mesh of that many triangles.
Diagnostic too_many_triangles(std::size_t triangles);

/// Runs f(block) for 0 .. count - 1, in parallel; false if cancelled.
template <class F>
bool for_each_block(std::size_t count, const Progress* progress, F&& f) {
  std::atomic<bool> stopped{false};
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t block) {
    if (cancelled(progress)) stopped = true;
    if (!stopped) f(block);
  });
  return !stopped;
}

}  // namespace cs2mesh
