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
#include "polygonize/vertex_ring.h"

namespace cs2mesh {
namespace {

/// Parts of the tolerance: what triangles are refined to, and from where on points count as lost.
constexpr double kRefined = 0.93, kLost = 0.93;
/// What triangles are refined to where others were in their way.
constexpr double kCloser = 0.3;
constexpr int kMostPasses = 16, kMostMends = 4;
constexpr std::size_t kMostPairs = 10'000;  ///< of triangles that cross

TriangleMesh::Index vertex_count(const TriangleMesh& mesh) {
  return static_cast<TriangleMesh::Index>(mesh.positions.size());
}

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
    point.on_mesh = hit.point;
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

/// The points that are too far from the mesh, the farthest first.
std::vector<LostPoint> lost_points(const TriangleMesh& mesh, std::span<const Vec3d> on_surface,
                                   double distance) {
  constexpr std::size_t kChunk = 1024;
  const ClosestPoint tree(mesh);
  std::vector<std::vector<LostPoint>> chunks((on_surface.size() + kChunk - 1) / kChunk);
  tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
    const auto points =
        on_surface.subspan(kChunk * i, std::min(kChunk, on_surface.size() - kChunk * i));
    tree.nearest_each(points, [&](std::size_t k, const ClosestPoint::Hit& hit) {
      if (hit.distance > distance) {
        chunks[i].push_back({points[k], hit.point, hit.distance, hit.triangle});
      }
    });
  });
  std::vector<LostPoint> lost;
  for (const auto& chunk : chunks) lost.insert(lost.end(), chunk.begin(), chunk.end());
  std::stable_sort(lost.begin(), lost.end(),
                   [](const LostPoint& a, const LostPoint& b) { return a.distance > b.distance; });
  return lost;
}

class Bringer {
 public:
  Bringer(const ImplicitSurface& surface, TriangleMesh& mesh, std::span<const Vec3d> on_surface,
          const BringNearOptions& options)
      : surface_(surface), mesh_(mesh), on_surface_(on_surface), options_(options) {
    refinement_.tolerance = kRefined * options.tolerance;
    refinement_.small = options.small;
    refinement_.max_triangles = options.max_triangles;
    refinement_.progress = options.progress;
  }

  BroughtNear run() {
    result_.error = HUGE_VAL;
    for (int pass = 0; pass < kMostPasses; ++pass) {
      std::vector<LostPoint> lost = refine_once(pass == 0);
      const Crossings crossings = part_crossings(lost);
      if (crossings == Crossings::left) break;
      if (crossings == Crossings::mended) {
        look_at_all(false);
        continue;
      }
      if (flip_far(surface_, mesh_, lost, far_options()) > 0) {
        unchecked_ = 0;
        look_at_all(false);
        continue;
      }
      look_back(lost);
      const bool near_enough = largest_distance(lost) <= kAcceptedPart * options_.tolerance;
      if (whole_ && near_enough && (lost.empty() || pass > 0)) {
        result_.error = std::max(largest_distance(lost), kRefined * options_.tolerance);
        break;
      }
      const bool was_whole = whole_;
      look_at_all(false);
      if (!lost.empty() && !insert_points(surface_, mesh_, lost).empty()) continue;
      if (was_whole) {
        result_.error = largest_distance(lost);
        break;
      }
      look_at_all(true);
    }
    return std::move(result_);
  }

 private:
  void begin(std::string_view stage) const {
    if (options_.progress != nullptr) options_.progress->report(stage, 0.0);
  }

  void look_at_all(bool all) {
    whole_ = all;
    refinement_.first_new = all ? 0 : vertex_count(mesh_);
  }

  FarOptions far_options() const {
    FarOptions options;
    options.tolerance = refinement_.tolerance;
    options.small = options_.small;
    options.longest_way = 100 * options_.tolerance;
    return options;
  }

  void put_down(std::span<const LostPoint> lost, std::span<const Vec3d> crossing) {
    std::vector<Vec3d>& trouble = result_.trouble;
    for (const LostPoint& point : lost) trouble.push_back(point.on_surface);
    trouble.insert(trouble.end(), crossing.begin(), crossing.end());
  }

  /// Returns what could not be brought near.
  std::vector<LostPoint> refine_once(bool first) {
    std::vector<bool> close;
    if (!close_.empty()) {
      close = vertices_near(mesh_, close_);
      refinement_.close = &close;
      refinement_.closer = kCloser * options_.tolerance;
    }
    RefineStatistics refined;
    mesh_ = refine(surface_, std::move(mesh_), refinement_, &refined);
    refinement_.close = nullptr;
    result_.jets += mesh_.triangles.size();
    if (first) {
      ImproveOptions improvement;
      improvement.tolerance = kRefined * options_.tolerance;
      improvement.small = options_.small;
      improvement.progress = options_.progress;
      mesh_ = improve(surface_, std::move(mesh_), improvement);
      find_again(refined.far, mesh_);
    }
    return std::move(refined.far);
  }

  /// Triangles that cross are first to be smaller there, as those that are mended may be farther
  /// from the surface. None: there were none. Left: nothing helps.
  Crossings part_crossings(std::span<const LostPoint> lost) {
    begin("mend");
    SelfIntersections found = find_new_intersections(mesh_, unchecked_, kMostPairs);
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
    unchecked_ = vertex_count(mesh_);
    return crossing.empty() ? Crossings::none : Crossings::mended;
  }

  /// Adds the points of the surface that the mesh misses. Not every pass asks about all of them,
  /// but the first and the last one do.
  void look_back(std::vector<LostPoint>& lost) {
    begin("look back");
    const double distance = kLost * options_.tolerance;
    if (whole_ || !looked_) {
      missed_ = lost_points(mesh_, on_surface_, distance);
      looked_ = true;
    } else if (!missed_.empty()) {
      std::vector<Vec3d> again;
      again.reserve(missed_.size());
      for (const LostPoint& point : missed_) again.push_back(point.on_surface);
      missed_ = lost_points(mesh_, again, distance);
    }
    lost.insert(lost.end(), missed_.begin(), missed_.end());
    put_down(missed_, {});
  }

  const ImplicitSurface& surface_;
  TriangleMesh& mesh_;
  std::span<const Vec3d> on_surface_;
  const BringNearOptions& options_;
  RefineOptions refinement_;
  BroughtNear result_;
  bool whole_ = true;  ///< whether the pass looks at all triangles, not just at those changed
  std::vector<Vec3d> close_;  ///< where sheets come close, so that triangles have to be smaller
  int mends_ = 0;
  std::size_t crossing_before_ = std::numeric_limits<std::size_t>::max();
  /// Triangles without a vertex from there on do not cross.
  TriangleMesh::Index unchecked_ = 0;
  std::vector<LostPoint> missed_;  ///< of the points of the surface
  bool looked_ = false;            ///< at all of them
};

}  // namespace

BroughtNear bring_near(const ImplicitSurface& surface, TriangleMesh& mesh,
                       std::span<const Vec3d> on_surface, const BringNearOptions& options) {
  require(options.tolerance > 0 && options.reach > 0, "bring_near: lengths must be positive");
  return Bringer(surface, mesh, on_surface, options).run();
}

}  // namespace cs2mesh
