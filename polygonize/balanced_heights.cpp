#include "polygonize/balanced_heights.h"

#include <algorithm>

#include "libfield/base/check.h"
#include "polygonize/sagitta.h"

namespace cs2mesh {

std::vector<double> balanced_heights(const TriangleMesh& mesh, std::span<const Vec3d> normals,
                                     double most) {
  require(normals.size() == mesh.positions.size(), "balanced_heights: one normal a vertex");
  const auto rise = [&](TriangleMesh::Index a, TriangleMesh::Index b) {
    return sagitta(mesh.positions[a], normals[a], mesh.positions[b], normals[b]);
  };
  std::vector<DeviationRange> ranges(normals.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    if (a == b) continue;
    const DeviationRange range = deviation_range(rise(a, b), rise(b, c), rise(c, a));
    for (const auto v : {a, b, c}) {
      ranges[v].low = std::min(ranges[v].low, range.low);
      ranges[v].high = std::max(ranges[v].high, range.high);
    }
  }
  std::vector<double> heights;
  heights.reserve(ranges.size());
  for (const DeviationRange& range : ranges) {
    heights.push_back(std::clamp(0.5 * (range.low + range.high), -most, most));
  }
  return heights;
}

}  // namespace cs2mesh
