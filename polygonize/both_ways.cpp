#include "polygonize/both_ways.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "polygonize/improve.h"
#include "polygonize/insert_points.h"
#include "polygonize/near_intersections.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The corners of triangles that cross others, looked for where there are others than those of
/// `apart`. None in a build that cannot tell.
std::vector<TriangleMesh::Index> crossing_vertices(const TriangleMesh& mesh,
                                                   const TriangleSet& apart) {
  constexpr std::size_t kMostPairs = 10'000;
  std::vector<TriangleMesh::Index> corners;
  for (const auto& pair : find_new_intersections(mesh, apart, kMostPairs).pairs) {
    for (const auto t : pair) {
      corners.insert(corners.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
    }
  }
  return corners;
}

}  // namespace

BothWays::BothWays(const ImplicitSurface& surface, const BothWaysOptions& options)
    : surface_(surface),
      watch_(surface, {options.surface_samples, options.enough, 1, options.progress}),
      improve_(options.improve) {
  // Less than enough, as what is found is the end of a slot near where it is deepest.
  probe_.enough = 0.8 * options.enough;
  probe_.progress = options.progress;
  refinement_.tolerance = options.enough;
  refinement_.small = options.small;
  refinement_.max_triangles = options.max_triangles;
  refinement_.progress = options.progress;
}

double BothWays::run(TriangleMesh& mesh) {
  constexpr int kMostLooks = 8;
  probe_.first_new = 0;
  const TriangleSet apart(mesh);
  if (!bring_near(mesh, 0)) return kInfinity;
  if (!crossing_vertices(mesh, apart).empty()) return kInfinity;
  if (mesh.empty()) return watch_.any() ? kInfinity : 0.0;
  if (improve_) improve_shapes(mesh);
  SurfaceWatch::Look back;
  for (int look = 0; look < kMostLooks; ++look) {
    if (cancelled(refinement_.progress)) return kInfinity;
    if (refinement_.progress != nullptr) {
      refinement_.progress->report("look back", static_cast<double>(look) / kMostLooks);
    }
    const ClosestPoint tree(mesh);
    back = look == 0 ? watch_.look(tree) : look_again(tree, back);
    for (const LostPoint& lost : probe_shell(surface_, mesh, tree, probe_)) {
      back.lost.push_back(lost);
      back.farthest = std::max(back.farthest, lost.distance);
    }
    probe_.first_new = static_cast<TriangleMesh::Index>(mesh.positions.size());
    if (back.lost.empty() || !join(mesh, back.lost)) break;
  }
  return back.farthest;
}

/// Fewer and better triangles, where they stay near the surface and apart.
void BothWays::improve_shapes(TriangleMesh& mesh) {
  const TriangleSet apart(mesh);
  ImproveOptions improvement;
  improvement.tolerance = refinement_.tolerance;
  improvement.small = refinement_.small;
  improvement.progress = refinement_.progress;
  TriangleMesh better = improve(surface_, mesh, improvement);
  if (!bring_near(better, 0) || !crossing_vertices(better, apart).empty()) return;
  mesh = std::move(better);
}

/// Refines the triangles with a vertex from `first_new` on; false if some that are too far
/// remain. They are mostly where the mesh has a hole or a bridge that the surface has not: a
/// smaller cell is needed there.
bool BothWays::bring_near(TriangleMesh& mesh, Index first_new) {
  std::size_t left = mesh.triangles.size();
  for (;;) {
    RefineStatistics refined;
    refinement_.first_new = first_new;
    mesh = refine(surface_, std::move(mesh), refinement_, &refined);
    far_ = std::move(refined.far);
    if (far_.empty()) return true;
    first_new = static_cast<TriangleMesh::Index>(mesh.positions.size());
    if (far_.size() >= left || insert_points(surface_, mesh, far_).empty()) return false;
    left = far_.size();
  }
}

/// Joins lost points, but for those that bring triangles along which stay too far from the
/// surface or cross others; false if none could be joined.
bool BothWays::join(TriangleMesh& mesh, std::vector<LostPoint> lost) {
  constexpr int kMostTries = 6;
  const auto first = static_cast<TriangleMesh::Index>(mesh.positions.size());
  for (int attempt = 0; attempt < kMostTries; ++attempt) {
    TriangleMesh joined = mesh;
    const std::vector<std::size_t> points = insert_points(surface_, joined, lost);
    if (points.empty()) return false;
    std::vector<TriangleMesh::Index> blamed;
    if (bring_near(joined, first)) {
      blamed = crossing_vertices(joined, TriangleSet(mesh));
      if (blamed.empty()) {
        mesh = std::move(joined);
        return true;
      }
    }
    for (const LostPoint& far : far_) {
      const auto& corners = joined.triangles[far.triangle];
      blamed.insert(blamed.end(), corners.begin(), corners.end());
    }
    std::vector<char> bad(lost.size(), 0);
    for (const auto v : blamed) {
      if (v >= first && v - first < points.size()) bad[points[v - first]] = 1;
    }
    std::vector<LostPoint> good;
    for (std::size_t i = 0; i < lost.size(); ++i) {
      if (bad[i] == 0) good.push_back(lost[i]);
    }
    if (good.size() == lost.size()) return false;
    lost = std::move(good);
  }
  return false;
}

/// What was lost, as the mesh is now; the rest has come no farther.
SurfaceWatch::Look BothWays::look_again(const ClosestPoint& tree,
                                        const SurfaceWatch::Look& last) const {
  SurfaceWatch::Look now;
  now.farthest = std::min(last.farthest, probe_.enough);
  for (const LostPoint& before : last.lost) {
    const ClosestPoint::Hit hit = tree.nearest(before.on_surface);
    now.farthest = std::max(now.farthest, hit.distance);
    if (hit.distance > probe_.enough) {
      now.lost.push_back({before.on_surface, hit.point, hit.distance, hit.triangle});
    }
  }
  return now;
}

}  // namespace cs2mesh
