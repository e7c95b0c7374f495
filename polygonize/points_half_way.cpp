#include "polygonize/points_half_way.h"

#include <algorithm>

#include "polygonize/leaf_jets.h"
#include "polygonize/sagitta.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// A place to look for the surface, and the leaf near it.
struct Start {
  Octree::Index leaf = 0;
  Vec3d point;
};

std::vector<Start> starts(const SurfaceOctree& tree, const TriangleMesh& mesh,
                          std::span<const Vec3d> normals, std::span<const Octree::Index> leaf_of,
                          double little) {
  constexpr double kMuch = 0.97;  // cosine
  std::vector<Start> all;
  for (const auto& t : mesh.triangles) {
    if (t[0] == t[1]) continue;  // collapsed
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = t[k], b = t[(k + 1) % 3];
      if (a > b || !(dot(normals[a], normals[b]) < kMuch)) continue;
      const Vec3d &p = mesh.positions[a], &q = mesh.positions[b];
      const double most_rise = 0.125 * norm(q - p) * norm(normals[b] - normals[a]);
      if (!(most_rise > little)) continue;
      const double rise = sagitta(p, normals[a], q, normals[b]);
      all.push_back({leaf_of[a], 0.5 * (p + q) + (0.5 * rise) * (normals[a] + normals[b])});
    }
  }
  std::stable_sort(all.begin(), all.end(), [&](const Start& one, const Start& other) {
    return tree.surface_number(one.leaf) < tree.surface_number(other.leaf);
  });
  return all;
}

}  // namespace

std::vector<Vec3d> points_half_way(const ImplicitSurface& surface, const SurfaceOctree& tree,
                                   const TriangleMesh& mesh, std::span<const Vec3d> normals,
                                   std::span<const Octree::Index> leaf_of, double close) {
  constexpr int kSteps = 3;
  constexpr double kLittle = 4.0;
  std::vector<Octree::Index> leaves;
  std::vector<Vec3d> points;
  for (const Start& start : starts(tree, mesh, normals, leaf_of, kLittle * close)) {
    leaves.push_back(start.leaf);
    points.push_back(start.point);
  }
  std::vector<Jet> jets(points.size());
  std::vector<Vec3d> found;
  for (int step = 0; step < kSteps && !points.empty(); ++step) {
    jets.resize(points.size());
    leaf_jets(surface, tree, leaves, points, jets);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double slope = norm_of_any(jets[i].gradient);
      const double way = leveled(jets[i].value) / slope;
      const double side = tree.octree().side(tree.octree()[leaves[i]].level);
      // At the edge of a support the logarithm makes short steps, too, far from the surface.
      if (first_order_distance(jets[i], HUGE_VAL) <= close) {
        found.push_back(points[i]);
      } else if (std::abs(way) <= side) {
        points[kept] = points[i] - way / slope * jets[i].gradient;
        leaves[kept++] = leaves[i];
      }
    }
    points.resize(kept);
    leaves.resize(kept);
  }
  return found;
}

}  // namespace cs2mesh
