#include "polygonize/balanced_heights.h"

#include <algorithm>

#include "libfield/base/check.h"
#include "polygonize/sagitta.h"

namespace cs2mesh {

std::vector<double> balanced_heights(const TriangleMesh& mesh, std::span<const Vec3d> normals,
                                     double most) {
  require(normals.size() == mesh.positions.size(), "balanced_heights: one normal a vertex");
  std::vector<double> up(normals.size(), 0.0), down(normals.size(), 0.0);
  const auto rise = [&](TriangleMesh::Index a, TriangleMesh::Index b) {
    return sagitta(mesh.positions[a], normals[a], mesh.positions[b], normals[b]);
  };
  for (const auto& t : mesh.triangles) {
    if (t[0] == t[1]) continue;
    const auto range = deviation_range(rise(t[0], t[1]), rise(t[1], t[2]), rise(t[2], t[0]));
    const double middle = 0.5 * (range.low + range.high);
    for (const auto v : t) {
      up[v] = std::clamp(middle, up[v], most);
      down[v] = std::clamp(middle, -most, down[v]);
    }
  }
  for (std::size_t v = 0; v < up.size(); ++v) up[v] += down[v];
  return up;
}

}  // namespace cs2mesh
