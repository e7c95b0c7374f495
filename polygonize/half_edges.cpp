#include "polygonize/half_edges.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <numeric>

#include "libfield/base/check.h"

namespace cs2mesh {

std::vector<HalfEdge> opposite_half_edges(const TriangleMesh& mesh) {
  const auto count = static_cast<HalfEdge>(3 * mesh.triangles.size());
  // Group the half-edges by the vertex that they start from.
  std::vector<std::uint32_t> begin(mesh.positions.size() + 1, 0);
  for (HalfEdge h = 0; h < count; ++h) ++begin[start_of(mesh, h) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> place(begin.begin(), begin.end() - 1);
  struct Ray {  ///< with its end beside it: looking through a fan touches one stretch of memory
    TriangleMesh::Index end;
    HalfEdge edge;
  };
  std::vector<Ray> from(count);
  for (HalfEdge h = 0; h < count; ++h) from[place[start_of(mesh, h)]++] = {end_of(mesh, h), h};

  std::vector<HalfEdge> opposite(count);
  tbb::parallel_for(tbb::blocked_range<HalfEdge>(0, count, 4096), [&](const auto& range) {
    for (HalfEdge h = range.begin(); h < range.end(); ++h) {
      const TriangleMesh::Index start = start_of(mesh, h), end = end_of(mesh, h);
      HalfEdge found = count;
      for (std::uint32_t i = begin[end]; i < begin[end + 1]; ++i) {
        if (from[i].end != start) continue;
        require(found == count, "opposite_half_edges: three triangles at an edge");
        found = from[i].edge;
      }
      require(found != count, "opposite_half_edges: the mesh is not closed");
      opposite[h] = found;
    }
  });
  return opposite;
}

}  // namespace cs2mesh
