#include "polygonize/mend_crossings.h"

#include <optional>
#include <vector>

#include "polygonize/collapse_crossings.h"
#include "polygonize/self_intersection.h"
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
    const Foot foot = find_foot(surface, sum[v] / count[v], reach);
    mesh.positions[v] = foot.point;
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

std::vector<Vec3d> places_of(const TriangleMesh& mesh, const SelfIntersections& found) {
  std::vector<Vec3d> places;
  for (const auto& pair : found.pairs) {
    for (const auto t : pair) places.push_back(mesh.positions[mesh.triangles[t][0]]);
  }
  return places;
}

}  // namespace

std::vector<Vec3d> crossing_places(const TriangleMesh& mesh) {
  const std::optional<SelfIntersections> found = find_self_intersections(mesh, kMostPairs);
  return found ? places_of(mesh, *found) : std::vector<Vec3d>{};
}

MendedCrossings mend_crossings(const ImplicitSurface& surface, TriangleMesh& mesh, double reach) {
  constexpr int kMostRounds = 8;
  for (int round = 0;; ++round) {
    const std::optional<SelfIntersections> found = find_self_intersections(mesh, kMostPairs);
    if (!found || found->pairs.empty()) {
      return {round == 0 ? Crossings::none : Crossings::mended, {}};
    }
    if (round == kMostRounds || found->pairs.size() == kMostPairs) {
      return {Crossings::left, places_of(mesh, *found)};
    }
    EditableMesh editable(std::move(mesh));
    const std::size_t collapsed = collapse_crossings(editable);
    mesh = editable.take();
    if (collapsed > 0) continue;
    std::vector<bool> marked = crossing_corners(mesh, *found);
    for (int ring = 0; ring < (round - 1) / 2; ++ring) marked = widened_by_ring(mesh, marked);
    smooth(surface, mesh, marked, reach);
  }
}

}  // namespace cs2mesh
