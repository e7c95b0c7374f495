#include "polygonize/mend_crossings.h"

#include <utility>
#include <vector>

#include "polygonize/collapse_crossings.h"
#include "polygonize/near_intersections.h"
#include "polygonize/surface_projection.h"
#include "polygonize/vertex_ring.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

constexpr std::size_t kMostPairs = 10'000;

/// Each marked vertex to the mean of its neighbours, then to the surface.
void smooth(const ImplicitSurface& surface, TriangleMesh& mesh, const std::vector<bool>& marked,
            double reach) {
  std::vector<Vec3d> sum(mesh.positions.size(), Vec3d{});
  std::vector<double> count(mesh.positions.size(), 0.0);
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!marked[t[k]]) continue;
      sum[t[k]] += mesh.positions[t[(k + 1) % 3]] + mesh.positions[t[(k + 2) % 3]];
      count[t[k]] += 2;
    }
  }
  for (Index v = 0; v < marked.size(); ++v) {
    if (!marked[v]) continue;
    const Vec3d middle = sum[v] / count[v];
    const Vec3d foot = find_foot(surface, middle, reach).point;
    // Where no foot is found it is the middle itself.
    if (foot != middle) mesh.positions[v] = foot;
  }
}

/// The corners of the triangles that cross others.
std::vector<bool> crossing_corners(const TriangleMesh& mesh, const SelfIntersections& found) {
  std::vector<bool> marked(mesh.positions.size(), false);
  for (const auto& pair : found.pairs) {
    for (const auto t : pair) {
      for (const Index v : mesh.triangles[t]) marked[v] = true;
    }
  }
  return marked;
}

/// Boxes around what may change if the triangles of these pairs are mended.
std::vector<Aabb> boxes_around(const TriangleMesh& mesh, const SelfIntersections& found) {
  std::vector<Aabb> boxes;
  for (const auto& pair : found.pairs) {
    for (const auto t : pair) {
      const Aabb box = bounds(mesh, t);
      boxes.push_back(box.grown(2 * box.diagonal()));
    }
  }
  return boxes;
}

}  // namespace

Crossings mend_crossings(const ImplicitSurface& surface, TriangleMesh& mesh, double reach) {
  SelfIntersections found = find_self_intersections(mesh, kMostPairs).value_or(SelfIntersections{});
  if (found.pairs.empty()) return Crossings::none;
  return mend_crossings(surface, mesh, reach, std::move(found));
}

Crossings mend_crossings(const ImplicitSurface& surface, TriangleMesh& mesh, double reach,
                         SelfIntersections found) {
  constexpr int kMostRounds = 8;
  for (int round = 0; round < kMostRounds && found.pairs.size() < kMostPairs; ++round) {
    const std::vector<Aabb> boxes = boxes_around(mesh, found);
    EditableMesh editable(std::move(mesh));
    const std::size_t collapsed = collapse_crossings(editable, found.pairs);
    mesh = editable.take();
    if (collapsed == 0) {
      std::vector<bool> marked = crossing_corners(mesh, found);
      for (int ring = 0; ring < (round - 1) / 2; ++ring) marked = widened_by_ring(mesh, marked);
      smooth(surface, mesh, marked, reach);
    }
    found = find_intersections_near(mesh, boxes, kMostPairs);
    if (!found.pairs.empty()) continue;
    found = find_self_intersections(mesh, kMostPairs).value_or(SelfIntersections{});
    if (found.pairs.empty()) return Crossings::mended;
  }
  return Crossings::left;
}

}  // namespace cs2mesh
