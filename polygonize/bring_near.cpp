#include "polygonize/bring_near.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libfield/base/check.h"
#include "polygonize/closest_point.h"
#include "polygonize/flip_far.h"
#include "polygonize/improve.h"
#include "polygonize/insert_points.h"
#include "polygonize/mend_crossings.h"
#include "polygonize/near_intersections.h"
#include "polygonize/refine.h"
#include "polygonize/triangle_set.h"
#include "polygonize/vertex_ring.h"

namespace cs2mesh {
namespace {

/// Parts of the tolerance: what triangles are refined to, and from where on points count as lost.
constexpr double kRefined = 0.93, kLost = 0.93;
/// What triangles are refined to where others were in their way.
constexpr double kCloser = 0.3;
constexpr int kMostPasses = 16, kMostMends = 4;
constexpr std::size_t kMostPairs = 10'000;  ///< of triangles that cross

double largest_distance(std::span<const LostPoint> lost) {
  double largest = 0.0;
  for (const LostPoint& point : lost) largest = std::max(largest, point.distance);
  return largest;
}

/// Gives points the triangles of another mesh that are nearest to them.
void find_again(std::span<LostPoint> points, const TriangleMesh& mesh) {
  if (points.empty()) return;
  const ClosestPoint tree(mesh);
  for (LostPoint& point : points) {
    const ClosestPoint::Hit hit = tree.nearest(point.on_surface);
    // Equal are those of which no surface is known (insert_points.h).
    if (point.on_mesh != point.on_surface) point.on_mesh = hit.point;
    point.triangle = hit.triangle;
  }
}

/// The corners of the triangles nearest to these points, and of those around.
std::vector<bool> vertices_near(const TriangleMesh& mesh, std::span<const Vec3d> points) {
  constexpr int kRings = 2;
  std::vector<bool> near(mesh.positions.size(), false);
  ClosestPoint(mesh).nearest_each(points, [&](std::size_t, const ClosestPoint::Hit& hit) {
    for (const TriangleMesh::Index v : mesh.triangles[hit.triangle]) near[v] = true;
  });
  for (int ring = 0; ring < kRings; ++ring) near = widened_by_ring(mesh, near);
  return near;
}

class Bringer {
 public:
  Bringer(const ImplicitSurface& surface, TriangleMesh& mesh, std::span<const Vec3d> on_surface,
          const BringNearOptions& options)
      : surface_(surface), mesh_(mesh), on_surface_(on_surface), options_(options) {}

  BroughtNear run() {
    result_.error = HUGE_VAL;
    for (int pass = 0; pass < kMostPasses; ++pass) {
      std::vector<LostPoint> lost = refine_once(pass == 0);
      const Crossings crossings = part_crossings(lost);
      if (crossings == Crossings::left) break;
      if (crossings == Crossings::mended) continue;
      if (flip_far(surface_, mesh_, lost, far_options()) > 0) continue;
      look_back(lost);
      const double distance = largest_distance(lost);
      const bool near_enough = distance <= kAcceptedPart * options_.tolerance;
      if (near_enough && (lost.empty() || pass > 0)) {
        result_.error = std::max(distance, kRefined * options_.tolerance);
        break;
      }
      if (insert_points(surface_, mesh_, lost).empty()) {
        result_.error = distance;
        break;
      }
    }
    return std::move(result_);
  }

 private:
  void begin(std::string_view stage) const {
    if (options_.progress != nullptr) options_.progress->report(stage, 0.0);
  }

  FarOptions far_options() const {
    FarOptions options;
    options.tolerance = kRefined * options_.tolerance;
    options.small = options_.small;
    options.longest_way = 100 * options_.tolerance;
    return options;
  }

  void put_down(std::span<const LostPoint> lost, std::span<const Vec3d> crossing) {
    std::vector<Vec3d>& trouble = result_.trouble;
    for (const LostPoint& point : lost) trouble.push_back(point.on_surface);
    trouble.insert(trouble.end(), crossing.begin(), crossing.end());
  }

  /// The triangles that are not known to be near the surface, and those that have to be nearer.
  std::vector<std::uint32_t> unknown(const std::vector<bool>& close) const {
    std::vector<std::uint32_t> found = near_.others(mesh_);
    if (close.empty()) return found;
    const auto is_close = [&](TriangleMesh::Index v) { return close[v]; };
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& corners = mesh_.triangles[t];
      if (std::all_of(corners.begin(), corners.end(), is_close)) found.push_back(t);
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// Returns what could not be brought near.
  std::vector<LostPoint> refine_once(bool first) {
    std::vector<bool> close;
    if (!close_.empty()) close = vertices_near(mesh_, close_);
    const std::vector<std::uint32_t> looked_at = unknown(close);
    RefineOptions refinement;
    refinement.tolerance = kRefined * options_.tolerance;
    refinement.small = options_.small;
    refinement.first_looked_at = &looked_at;
    refinement.close = close.empty() ? nullptr : &close;
    refinement.closer = kCloser * options_.tolerance;
    refinement.max_triangles = options_.max_triangles;
    refinement.progress = options_.progress;
    RefineStatistics refined;
    mesh_ = refine(surface_, std::move(mesh_), refinement, &refined);
    result_.jets += mesh_.triangles.size();
    std::vector<std::uint64_t> doubtful;
    for (const LostPoint& lost : refined.far) {
      doubtful.push_back(triangle_key(mesh_, lost.triangle));
    }
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& corners = mesh_.triangles[t];
      const bool unseen = *std::max_element(corners.begin(), corners.end()) >= refined.first_unseen;
      if (unseen) doubtful.push_back(triangle_key(mesh_, t));
    }
    near_ = TriangleSet(mesh_);
    near_.remove(std::move(doubtful));
    // What is moved then moves a little more after it was measured: the next pass looks at it.
    if (first) {
      improve_once();
      find_again(refined.far, mesh_);
    }
    return std::move(refined.far);
  }

  void improve_once() {
    ImproveOptions improvement;
    improvement.tolerance = kRefined * options_.tolerance;
    improvement.small = options_.small;
    improvement.progress = options_.progress;
    ImproveStatistics improved;
    mesh_ = improve(surface_, std::move(mesh_), improvement, &improved);
    near_.add(std::move(improved.near));
  }

  /// Triangles that cross are first to be smaller there, as those that are mended may be farther
  /// from the surface. None: there were none. Left: nothing helps.
  Crossings part_crossings(std::span<const LostPoint> lost) {
    begin("mend");
    SelfIntersections found = find_new_intersections(mesh_, apart_, kMostPairs);
    const std::vector<Vec3d> crossing = places_of(found, mesh_);
    put_down(lost, crossing);
    if (!crossing.empty()) {
      close_.insert(close_.end(), crossing.begin(), crossing.end());
      const bool fewer = crossing.size() < std::exchange(crossing_before_, crossing.size());
      if (fewer) return Crossings::mended;
      if (++mends_ > kMostMends ||
          mend_crossings(surface_, mesh_, options_.reach, std::move(found)) == Crossings::left) {
        return Crossings::left;
      }
    }
    apart_ = TriangleSet(mesh_);
    return crossing.empty() ? Crossings::none : Crossings::mended;
  }

  /// Adds the points of the surface that the mesh misses, the farthest first. Only those are asked
  /// about whose triangle is no more, or is not near.
  void look_back(std::vector<LostPoint>& lost) {
    begin("look back");
    covered_by_.resize(on_surface_.size(), 0);
    std::vector<std::uint32_t> asked;
    for (std::uint32_t i = 0; i < on_surface_.size(); ++i) {
      if (covered_by_[i] == 0 || !near_.contains(covered_by_[i])) asked.push_back(i);
    }
    if (asked.empty()) return;
    std::vector<LostPoint> missed = missed_of(asked);
    std::stable_sort(missed.begin(), missed.end(), [](const LostPoint& a, const LostPoint& b) {
      return a.distance > b.distance;
    });
    lost.insert(lost.end(), missed.begin(), missed.end());
    put_down(missed, {});
  }

  /// Those of these points of the surface that are too far from the mesh; notes which triangles the
  /// others are near.
  std::vector<LostPoint> missed_of(std::span<const std::uint32_t> asked) {
    constexpr std::size_t kChunk = 1024;
    const ClosestPoint tree(mesh_);
    std::vector<std::vector<LostPoint>> chunks((asked.size() + kChunk - 1) / kChunk);
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
      const auto some = asked.subspan(kChunk * i, std::min(kChunk, asked.size() - kChunk * i));
      std::vector<Vec3d> points;
      for (const std::uint32_t p : some) points.push_back(on_surface_[p]);
      tree.nearest_each(points, [&](std::size_t k, const ClosestPoint::Hit& hit) {
        if (hit.distance > kLost * options_.tolerance) {
          covered_by_[some[k]] = 0;
          chunks[i].push_back({points[k], hit.point, hit.distance, hit.triangle});
        } else {
          covered_by_[some[k]] = triangle_key(mesh_, hit.triangle);
        }
      });
    });
    std::vector<LostPoint> missed;
    for (const auto& chunk : chunks) missed.insert(missed.end(), chunk.begin(), chunk.end());
    return missed;
  }

  const ImplicitSurface& surface_;
  TriangleMesh& mesh_;
  std::span<const Vec3d> on_surface_;
  const BringNearOptions& options_;
  BroughtNear result_;
  TriangleSet near_;                       ///< those known to be near the surface
  TriangleSet apart_;                      ///< of which no two cross
  std::vector<std::uint64_t> covered_by_;  ///< a triangle near each point of the surface, or 0
  std::vector<Vec3d> close_;  ///< where sheets come close, so that triangles have to be smaller
  int mends_ = 0;
  std::size_t crossing_before_ = std::numeric_limits<std::size_t>::max();
};

}  // namespace

BroughtNear bring_near(const ImplicitSurface& surface, TriangleMesh& mesh,
                       std::span<const Vec3d> on_surface, const BringNearOptions& options) {
  require(options.tolerance > 0 && options.reach > 0, "bring_near: lengths must be positive");
  return Bringer(surface, mesh, on_surface, options).run();
}

}  // namespace cs2mesh
