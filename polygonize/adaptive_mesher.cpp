#include "polygonize/adaptive_mesher.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "libfield/base/check.h"
#include "polygonize/both_ways.h"
#include "polygonize/check.h"
#include "polygonize/closest_point.h"
#include "polygonize/improve.h"
#include "polygonize/insert_points.h"
#include "polygonize/mend_crossings.h"
#include "polygonize/near_intersections.h"
#include "polygonize/octree_mesh.h"
#include "polygonize/refine.h"
#include "polygonize/remesh.h"
#include "polygonize/tolerance.h"
#include "polygonize/vertex_ring.h"

namespace cs2mesh {
namespace {

/// Triangles smaller than so many tolerances are looked at closely.
constexpr double kSmall = 8.0;
/// Parts of the tolerance: what remeshing aims at, in one attempt after the other; what triangles
/// are refined to; what is accepted, as the distance is measured at points.
constexpr double kAims[] = {1.0, 0.6, 0.35};
constexpr int kMostAttempts = 6, kMostCuts = 3;
constexpr std::size_t kMostPairs = 10'000;  ///< of triangles that cross
constexpr double kRefinedBlindly = 0.88;    // where what the mesh misses is found by chance
constexpr double kRefined = 0.93, kLost = 0.93, kAccept = 0.97;
/// What triangles are refined to where others were in their way.
constexpr double kCloser = 0.3;

/// Where the octree proves little, the first mesh tells what there is, and has to be finer.
constexpr double kCloseLook = 2.5;

/// Necks and gaps between smooth blobs are larger than the smallest side, seen from the blobs.
/// Without proof, cells are between those of the lattice mesher and what the tolerance may ask for.
SurfaceOctreeOptions octree_options(const MesherRequest& request, bool prove) {
  constexpr double kNeck = 1.0 / 64, kShare = 0.35, kLattice = 0.8;
  SurfaceOctreeOptions options;
  options.tolerance = request.tolerance;
  options.prove = prove;
  if (!prove) options.coarseness = kCloseLook;
  options.smallest = std::min(kShare * request.tolerance, kNeck * request.thinnest_radius);
  const double lattice = expected_cell(request.thinnest_radius, request.creased, request.tolerance);
  // Cells twice as large are cut, so that what is thinner than those may be lost; but the tolerance
  // is not to suffer.
  const double ignored = std::min(0.5 * request.min_feature, 0.4 * lattice);
  if (prove) options.smallest = std::max(options.smallest, ignored);
  if (!prove) {
    options.largest = kLattice * lattice;
    options.smallest = std::clamp(kShare * request.tolerance, 0.25 * lattice, 0.4 * lattice);
  }
  options.max_cells = request.max_nodes;
  options.progress = request.progress;
  return options;
}

class Adaptive {
 public:
  Adaptive(const ImplicitSurface& surface, const MesherRequest& request, AdaptiveStatistics& log)
      : surface_(surface), request_(request), log_(log), provable_(surface.has_cheap_bounds()) {}

  Result<MesherResult> run() {
    Result<SurfaceOctree> tree =
        SurfaceOctree::build(surface_, octree_options(request_, provable_));
    if (!tree) return Result<MesherResult>::failure(tree.diagnostics());
    look_at(*tree);
    // Slits far below the smallest cell: better looked for than sampled by chance.
    constexpr double kMuch = 0.005;
    const double open = static_cast<double>(log_.open_leaves);
    proven_ = provable_ && (request_.min_feature > 0 ||
                            open <= kMuch * (open + static_cast<double>(log_.simple_leaves)));
    if (provable_ && !proven_) {
      lattice_.emplace(mesh_by_lattice(surface_, request_));
      if (*lattice_ && (*lattice_)->reached) return *std::move(lattice_);
      if (cancelled(request_.progress)) return error_at({}, "interrupted", Failure::interrupted);
      SurfaceOctreeOptions closer = octree_options(request_, true);
      closer.coarseness = kCloseLook;
      tree = SurfaceOctree::build(surface_, closer);
      if (!tree) return Result<MesherResult>::failure(tree.diagnostics());
      look_at(*tree);
    }
    MesherResult best;
    best.error = HUGE_VAL;
    std::size_t aim = 0;
    bool untangle = false;
    for (int attempt = 0; attempt < kMostAttempts && aim < std::size(kAims); ++attempt) {
      begin("first mesh");
      const OctreeMesh first = mesh_octree(surface_, *tree);
      log_.first_triangles = first.mesh.triangles.size();
      log_.jets += first.evaluations;
      if (log_.first_triangles > request_.max_triangles) return too_many();
      ++log_.attempts;
      MesherResult result = fit(*tree, first, kAims[aim], untangle);
      if (cancelled(request_.progress)) return error_at({}, "interrupted", Failure::interrupted);
      if (result.error < best.error) best = std::move(result);
      if (best.error <= kAccept * request_.tolerance) break;
      if (!provable_ && (untangle || best.error < HUGE_VAL)) break;
      // Smaller cells where it went wrong; if there are none, smaller triangles everywhere.
      const Result<std::size_t> cut = tree->cut_near(trouble_);
      if (!cut) return Result<MesherResult>::failure(cut.diagnostics());
      if (*cut == 0 || attempt >= kMostCuts) {
        aim += untangle ? 1 : 0;
        untangle = true;
      }
      look_at(*tree);
    }
    const double enough = (provable_ ? 1.0 : kAccept) * request_.tolerance;
    if (best.error > enough) {
      Result<MesherResult> other = by_lattice();
      if (!other && !(best.error < HUGE_VAL)) return other;
      if (other && other->error < best.error) return other;
    }
    if (best.error > request_.tolerance) {
      const Diagnostic remark = tolerance_missed(request_.tolerance, best.error, smallest_cell_);
      return {std::move(best), {remark}};
    }
    best.cell = smallest_cell_;
    best.reached = true;
    if (proven_ && request_.min_feature > 0) best.unresolved_cells = log_.open_leaves;
    return best;
  }

 private:
  void begin(std::string_view stage) const {
    if (request_.progress != nullptr) request_.progress->report(stage, 0.0);
  }

  void look_at(const SurfaceOctree& tree) {
    log_.octree = tree.counts();
    log_.simple_leaves = log_.open_leaves = 0;
    const Octree& octree = tree.octree();
    int deepest = 0;
    for (Octree::Index i = 0; i < octree.size(); ++i) {
      if (!octree.is_leaf(i) || tree.kind(i) == LeafKind::empty) continue;
      ++(tree.kind(i) == LeafKind::simple ? log_.simple_leaves : log_.open_leaves);
      deepest = std::max<int>(deepest, octree[i].level);
    }
    smallest_cell_ = octree.side(deepest);
  }

  Result<MesherResult> too_many() const {
    return error_at({},
                    "the mesh needs more than " + std::to_string(request_.max_triangles) +
                        " triangles; use a larger tolerance",
                    Failure::limit);
  }

  /// What the lattice mesher makes of it.
  Result<MesherResult> by_lattice() {
    if (!lattice_) lattice_.emplace(mesh_by_lattice(surface_, request_));
    return *std::move(lattice_);
  }

  /// The first mesh made to fit that part of the tolerance. Its error is infinite where triangles
  /// cross; `untangle` looks for that from the beginning, which is dear.
  MesherResult fit(const SurfaceOctree& tree, const OctreeMesh& first, double aim, bool untangle) {
    RemeshOptions remeshing;
    remeshing.tolerance = aim * request_.tolerance;
    remeshing.untangle = untangle;
    remeshing.balance = request_.balance;
    remeshing.progress = request_.progress;
    RemeshStatistics remeshed;
    MesherResult result;
    result.mesh = remesh(surface_, tree, first.mesh, first.leaf_of, remeshing, &remeshed);
    log_.jets += remeshed.jets;
    if (result.mesh.empty()) return result;
    std::vector<Vec3d>& on_surface = remeshed.on_surface;
    on_surface.insert(on_surface.end(), first.bulges.begin(), first.bulges.end());
    result.error =
        proven_ ? bring_near(result.mesh, on_surface) : bring_near_both_ways(result.mesh);
    if (!proven_ && result.error < HUGE_VAL) {
      begin("measure");
      const GradientEstimate estimate(0.4 * request_.tolerance, kSmall * request_.tolerance);
      result.error = std::max(result.error, estimate.largest_distance(surface_, result.mesh));
      log_.jets += result.mesh.triangles.size();
    }
    if (result.error < HUGE_VAL && crosses_in_floats(result.mesh)) result.error = HUGE_VAL;
    return result;
  }

  /// Whether triangles cross once positions are rounded to floats, as files of most formats have
  /// them; not where that moves them by what the tolerance has to do with. Where is put down in
  /// trouble_.
  bool crosses_in_floats(const TriangleMesh& mesh) {
    constexpr double kSmallMove = 1e-3;  // tolerances
    const TriangleMesh rounded = rounded_to_float(mesh);
    double most = 0.0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      most = std::max(most, norm(rounded.positions[v] - mesh.positions[v]));
    }
    if (most > kSmallMove * request_.tolerance) return false;
    const std::vector<Vec3d> places =
        places_of(find_new_intersections(rounded, 0, kMostPairs), rounded);
    put_down({}, places);
    return !places.empty();
  }

  /// Refines the mesh where it is too far from the surface, and joins those of some points of the
  /// surface that are too far from it. Returns how far apart they are then, at most, as far as that
  /// was looked at; infinite if triangles cross. Where it is hard is put down in trouble_.
  double bring_near(TriangleMesh& mesh, std::span<const Vec3d> on_surface) {
    constexpr int kMostPasses = 16, kMostMends = 4;
    RefineOptions refinement = refine_options();
    bool whole = true;  // whether the pass looks at all triangles, not just at those that changed
    trouble_.clear();
    std::vector<Vec3d> close;  // where sheets come close, so that triangles have to be smaller
    std::vector<bool> close_vertices;
    int mends = 0;
    std::size_t crossing_before = std::numeric_limits<std::size_t>::max();
    TriangleMesh::Index unchecked = 0;  // triangles without a vertex from there on do not cross
    std::vector<LostPoint> missed;      // of the points of the surface
    bool looked = false;                // at all of them
    const auto look_at_all = [&](bool all) {
      whole = all;
      refinement.first_new = all ? 0 : vertex_count(mesh);
    };
    for (int pass = 0; pass < kMostPasses; ++pass) {
      if (!close.empty()) {
        close_vertices = vertices_near(mesh, close);
        refinement.close = &close_vertices;
        refinement.closer = kCloser * request_.tolerance;
      }
      RefineStatistics refined;
      mesh = refine(surface_, std::move(mesh), refinement, &refined);
      log_.jets += mesh.triangles.size();
      std::vector<LostPoint> lost = std::move(refined.far);
      if (pass == 0) {
        mesh = improve(surface_, std::move(mesh), improve_options());
        find_again(lost, mesh);
      }
      begin("mend");
      SelfIntersections found = find_new_intersections(mesh, unchecked, kMostPairs);
      const std::vector<Vec3d> crossing = places_of(found, mesh);
      put_down(lost, crossing);
      if (!crossing.empty()) {
        close.insert(close.end(), crossing.begin(), crossing.end());
        // Smaller triangles first: those that are mended may be farther from the surface.
        const bool fewer = crossing.size() < std::exchange(crossing_before, crossing.size());
        if (!fewer) {
          if (++mends > kMostMends || mend_crossings(surface_, mesh, request_.thinnest_radius,
                                                     std::move(found)) == Crossings::left) {
            return HUGE_VAL;
          }
          unchecked = vertex_count(mesh);
        }
        look_at_all(false);
        continue;
      }
      unchecked = vertex_count(mesh);
      begin("look back");
      // Not every pass asks about all points of the surface, but the first and the last one do.
      if (whole || !looked) {
        missed = lost_points(mesh, on_surface);
        looked = true;
      } else if (!missed.empty()) {
        std::vector<Vec3d> again;
        again.reserve(missed.size());
        for (const LostPoint& point : missed) again.push_back(point.on_surface);
        missed = lost_points(mesh, again);
      }
      lost.insert(lost.end(), missed.begin(), missed.end());
      put_down(missed, {});
      const bool near_enough = largest_distance(lost) <= kAccept * request_.tolerance;
      if (whole && near_enough && (lost.empty() || pass > 0)) {
        return std::max(largest_distance(lost), kRefined * request_.tolerance);
      }
      const bool was_whole = whole;
      look_at_all(false);
      if (!lost.empty() && !insert_points(mesh, lost).empty()) continue;
      if (was_whole) return largest_distance(lost);
      look_at_all(true);
    }
    return HUGE_VAL;
  }

  /// Gives points the triangles of another mesh that are nearest to them.
  static void find_again(std::span<LostPoint> points, const TriangleMesh& mesh) {
    if (points.empty()) return;
    const ClosestPoint tree(mesh);
    for (LostPoint& point : points) {
      const ClosestPoint::Hit hit = tree.nearest(point.on_surface);
      point.on_mesh = hit.point;
      point.triangle = hit.triangle;
    }
  }

  /// The corners of the triangles nearest to these points, and of those around.
  static std::vector<bool> vertices_near(const TriangleMesh& mesh, std::span<const Vec3d> points) {
    constexpr int kRings = 2;
    std::vector<bool> near(mesh.positions.size(), false);
    ClosestPoint(mesh).nearest_each(points, [&](std::size_t, const ClosestPoint::Hit& hit) {
      for (const TriangleMesh::Index v : mesh.triangles[hit.triangle]) near[v] = true;
    });
    for (int ring = 0; ring < kRings; ++ring) near = widened_by_ring(mesh, near);
    return near;
  }

  static TriangleMesh::Index vertex_count(const TriangleMesh& mesh) {
    return static_cast<TriangleMesh::Index>(mesh.positions.size());
  }

  static double largest_distance(std::span<const LostPoint> lost) {
    double largest = 0.0;
    for (const LostPoint& point : lost) largest = std::max(largest, point.distance);
    return largest;
  }

  RefineOptions refine_options() const {
    RefineOptions refinement;
    refinement.tolerance = kRefined * request_.tolerance;
    refinement.small = closely();
    refinement.max_triangles = request_.max_triangles;
    refinement.progress = request_.progress;
    return refinement;
  }

  /// The side of triangles that are looked at closely: all where vertices are off the surface, as
  /// little can be told from a few points then.
  double closely() const { return request_.balance ? HUGE_VAL : kSmall * request_.tolerance; }

  ImproveOptions improve_options() const {
    ImproveOptions improvement;
    improvement.tolerance = kRefined * request_.tolerance;
    improvement.small = closely();
    improvement.progress = request_.progress;
    return improvement;
  }

  void put_down(std::span<const LostPoint> lost, std::span<const Vec3d> crossing) {
    for (const LostPoint& point : lost) trouble_.push_back(point.on_surface);
    trouble_.insert(trouble_.end(), crossing.begin(), crossing.end());
  }

  /// The points that are too far from the mesh, the farthest first.
  std::vector<LostPoint> lost_points(const TriangleMesh& mesh,
                                     std::span<const Vec3d> on_surface) const {
    constexpr std::size_t kChunk = 1024;
    const ClosestPoint tree(mesh);
    std::vector<std::vector<LostPoint>> chunks((on_surface.size() + kChunk - 1) / kChunk);
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
      const auto points =
          on_surface.subspan(kChunk * i, std::min(kChunk, on_surface.size() - kChunk * i));
      tree.nearest_each(points, [&](std::size_t k, const ClosestPoint::Hit& hit) {
        if (hit.distance > kLost * request_.tolerance) {
          chunks[i].push_back({points[k], hit.point, hit.distance, hit.triangle});
        }
      });
    });
    std::vector<LostPoint> lost;
    for (const auto& chunk : chunks) lost.insert(lost.end(), chunk.begin(), chunk.end());
    std::stable_sort(lost.begin(), lost.end(), [](const LostPoint& a, const LostPoint& b) {
      return a.distance > b.distance;
    });
    return lost;
  }

  /// As above, and joins what there is of the surface too far from the mesh: without proof, that is
  /// looked for.
  double bring_near_both_ways(TriangleMesh& mesh) {
    const auto cross = [&] {
      return mend_crossings(surface_, mesh, request_.thinnest_radius) == Crossings::left;
    };
    if (cross()) return HUGE_VAL;
    BothWaysOptions options;
    options.enough = kRefinedBlindly * request_.tolerance;
    options.small = request_.tolerance;
    options.max_triangles = request_.max_triangles;
    options.progress = request_.progress;
    if (!both_ways_) both_ways_.emplace(surface_, options);
    const double back = both_ways_->run(mesh);
    if (cross()) return HUGE_VAL;
    return back;
  }

  const ImplicitSurface& surface_;
  const MesherRequest& request_;
  AdaptiveStatistics& log_;
  bool provable_ = false;                        ///< bounds are cheap
  bool proven_ = false;                          ///< and hardly a leaf of the octree is open
  std::optional<Result<MesherResult>> lattice_;  ///< what the lattice mesher makes, if tried
  std::optional<BothWays> both_ways_;
  double smallest_cell_ = 0.0;
  std::vector<Vec3d> trouble_;  ///< points where the last attempt went wrong
};

}  // namespace

Result<MesherResult> mesh_adaptive(const ImplicitSurface& surface, const MesherRequest& request,
                                   AdaptiveStatistics* statistics) {
  require(request.tolerance > 0 && std::isfinite(request.tolerance),
          "mesh_adaptive: the tolerance must be positive");
  require(request.thinnest_radius > 0 && std::isfinite(request.thinnest_radius),
          "mesh_adaptive: the radius must be positive");
  if (surface.bounds().empty()) {
    MesherResult nothing;
    nothing.reached = true;
    return nothing;
  }
  // A profile that jumps makes walls and slots of any width, which the lattice mesher looks for.
  // Where bounds are cheap there are none, but deep inside F may overflow.
  if (!surface.has_cheap_bounds() &&
      !std::isfinite(surface.derivative_bound(1, surface.bounds()))) {
    return mesh_by_lattice(surface, request);
  }
  AdaptiveStatistics log;
  Result<MesherResult> result = Adaptive(surface, request, log).run();
  if (statistics != nullptr) *statistics = log;
  return result;
}

}  // namespace cs2mesh
