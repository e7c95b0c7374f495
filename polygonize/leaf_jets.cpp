#include "polygonize/leaf_jets.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "libfield/base/check.h"

namespace cs2mesh {

void leaf_jets(const ImplicitSurface& surface, const SurfaceOctree& tree,
               std::span<const Octree::Index> leaves, std::span<const Vec3d> points,
               std::span<Jet> jets) {
  require(leaves.size() == points.size() && points.size() == jets.size(),
          "leaf_jets: one leaf and one jet a point");
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  for (std::size_t first = 0; first < leaves.size();) {
    const std::uint32_t number = tree.surface_number(leaves[first]);
    std::size_t last = first + 1;
    while (last < leaves.size() && tree.surface_number(leaves[last]) == number) ++last;
    runs.emplace_back(first, last);
    first = last;
  }
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    const auto [first, last] = runs[i];
    const Octree::Index leaf = leaves[first];
    const Aabb& box = tree.surface_box(leaf);
    const auto run = points.subspan(first, last - first);
    const bool inside =
        std::all_of(run.begin(), run.end(), [&](const Vec3d& p) { return box.contains(p); });
    (inside ? tree.surface_at(leaf) : surface).jets(run, jets.subspan(first, last - first));
  });
}

}  // namespace cs2mesh
