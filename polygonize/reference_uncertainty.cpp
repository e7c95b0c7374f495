#include "polygonize/reference_uncertainty.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "polygonize/surface_samples.h"

namespace cs2mesh {
namespace {

/// The largest step from the surface samples of one block; `budget` in values of F.
double largest_step(const SurfaceBlock& block, int cells, double budget) {
  std::vector<Vec3d> points;
  append_crossings(block, cells, points);
  std::vector<Jet> jets(points.size());
  block.surface->jets(points, jets);
  double largest = 0;
  for (const Jet& jet : jets) {
    const double off = std::abs(jet.value) + budget;
    if (off > 0) largest = std::max(largest, off / norm(jet.gradient));
  }
  return largest;
}

}  // namespace

double reference_uncertainty(const CompiledScene& compiled, double error_budget,
                             std::size_t samples, const Progress* progress) {
  constexpr std::uint64_t kSeed = 1;
  const std::size_t each = samples / std::max<std::size_t>(compiled.parts.size(), 1);
  double largest = 0;
  for (const Part& part : compiled.parts) {
    const Aabb box = part.surface->bounds();
    const std::vector<SurfaceBlock> blocks =
        surface_blocks(*part.surface, box, each, kSeed, progress);
    const int cells = cells_per_block(blocks.size(), each);
    const double budget = part.soft ? error_budget : 0.0;
    std::vector<double> steps(blocks.size(), 0.0);
    tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
      if (!cancelled(progress)) steps[i] = largest_step(blocks[i], cells, budget);
    });
    for (const double step : steps) largest = std::max(largest, step);
    if (box.empty()) continue;
    const double reach = std::max(norm(box.min), norm(box.max));
    largest = std::max(largest, reach * std::numeric_limits<double>::epsilon());
  }
  return largest;
}

}  // namespace cs2mesh
