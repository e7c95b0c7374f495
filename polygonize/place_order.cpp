#include "polygonize/place_order.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <utility>

#include "libfield/base/check.h"
#include "polygonize/morton.h"

namespace cs2mesh {

std::vector<std::uint32_t> triangles_by_place(const TriangleMesh& mesh) {
  const Aabb all = bounds(mesh);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> coded(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, coded.size(), [&](std::size_t t) {
    coded[t] = {morton_code(all, centroid(mesh, t)), static_cast<std::uint32_t>(t)};
  });
  tbb::parallel_sort(coded.begin(), coded.end());
  std::vector<std::uint32_t> order(coded.size());
  for (std::size_t i = 0; i < coded.size(); ++i) order[i] = coded[i].second;
  return order;
}

std::vector<TriangleMesh::Index> sort_by_place(TriangleMesh& mesh) {
  require(mesh.normals.empty() && mesh.colors.empty(), "sort_by_place: a mesh with attributes");
  using Index = TriangleMesh::Index;
  constexpr Index kNone = ~Index{0};
  std::vector<Index> number(mesh.positions.size(), kNone), former;
  former.reserve(number.size());
  const auto take = [&](Index v) {
    if (number[v] != kNone) return;
    number[v] = static_cast<Index>(former.size());
    former.push_back(v);
  };

  std::vector<std::array<Index, 3>> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const std::uint32_t t : triangles_by_place(mesh)) {
    triangles.push_back(mesh.triangles[t]);
    for (Index& v : triangles.back()) {
      take(v);
      v = number[v];
    }
  }
  for (Index v = 0; v < number.size(); ++v) take(v);

  std::vector<Vec3d> positions(former.size());
  for (std::size_t i = 0; i < former.size(); ++i) positions[i] = mesh.positions[former[i]];
  mesh.triangles = std::move(triangles);
  mesh.positions = std::move(positions);
  return former;
}

}  // namespace cs2mesh
