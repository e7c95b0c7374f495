#include "polygonize/adaptive_mesher.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "libfield/base/check.h"
#include "polygonize/both_ways.h"
#include "polygonize/bring_near.h"
#include "polygonize/check.h"
#include "polygonize/mend_crossings.h"
#include "polygonize/near_intersections.h"
#include "polygonize/octree_mesh.h"
#include "polygonize/placed_mesh.h"
#include "polygonize/remesh.h"
#include "polygonize/shape_operator.h"
#include "polygonize/tolerance.h"

namespace cs2mesh {
namespace {

/// Triangles smaller than so many tolerances are looked at closely.
constexpr double kSmall = 8.0;
/// Parts of the tolerance that remeshing aims at, in one attempt after the other.
constexpr double kAims[] = {1.0, 0.6, 0.35};
constexpr int kMostAttempts = 6, kMostCuts = 3;
constexpr std::size_t kMostPairs = 10'000;  ///< of triangles that cross
/// The part of the tolerance that triangles are refined to where what the mesh misses is found by
/// chance; up to the second it does not matter how near they are.
constexpr double kRefinedBlindly = 0.88, kSurely = 0.8;
/// Remeshing aims as much lower there: triangles that are split for little are thin and many.
constexpr double kBlindAim = 0.85;

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

/// Where kernels end, grooves may be as narrow as their edges, and bounds are summed element by
/// element: there proofs may be given up.
void limit_proofs(const ImplicitSurface& surface, SurfaceOctreeOptions& options) {
  constexpr std::size_t kManySlopes = 600'000;  // of two dozen elements, some ten seconds
  constexpr double kFair = 0.35;                // tolerances
  if (std::isfinite(surface.derivative_bound(3, surface.bounds()))) return;
  options.most_slopes = kManySlopes;
  options.fair_side = kFair * options.tolerance;
}

class Adaptive : private Coarsener {
 public:
  Adaptive(const ImplicitSurface& surface, const MesherRequest& request, AdaptiveStatistics& log)
      : surface_(surface), request_(request), log_(log), provable_(surface.has_cheap_bounds()) {}

  Result<MesherResult> run() {
    SurfaceOctreeOptions options = octree_options(request_, provable_);
    if (provable_) limit_proofs(surface_, options);
    Result<SurfaceOctree> tree = SurfaceOctree::build(surface_, options);
    if (!tree) return Result<MesherResult>::failure(tree.diagnostics());
    look_at(*tree);
    // Slits far below the smallest cell: better looked for than sampled by chance.
    constexpr double kMuch = 0.005;
    const double open = static_cast<double>(log_.open_leaves);
    proven_ = provable_ && !tree->gave_up() &&
              (request_.min_feature > 0 ||
               open <= kMuch * (open + static_cast<double>(log_.simple_leaves)));
    if (provable_ && !proven_) {
      lattice_.emplace(on_lattices({}));
      if (*lattice_ && (*lattice_)->reached) return *std::move(lattice_);
      if (cancelled(request_.progress)) return error_at({}, "interrupted", Failure::interrupted);
      options.coarseness = kCloseLook;
      tree = SurfaceOctree::build(surface_, options);
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
      MesherResult result = fit(*tree, first, {kAims[aim], untangle, proven_});
      if (cancelled(request_.progress)) return error_at({}, "interrupted", Failure::interrupted);
      if (result.error < best.error) best = std::move(result);
      if (best.error <= kAcceptedPart * request_.tolerance) break;
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
    const double enough = (provable_ ? 1.0 : kAcceptedPart) * request_.tolerance;
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

  /// On lattices from the beginning.
  Result<MesherResult> run_on_lattices() { return on_lattices(many_lattices()); }

 private:
  /// Made coarse, unless that is what went wrong before, as where the surface touches itself.
  Result<MesherResult> on_lattices(ToleranceOptions options) {
    if (!proven_) options.coarsener = this;
    return mesh_on_cells(surface_, request_, options);
  }

  Coarse coarsen(const TriangleMesh& dense, double cell) override {
    // Kinks need smaller triangles than normals tell; improving makes up for it elsewhere. Where
    // triangles come to cross, others may not.
    constexpr double kCoarseAims[] = {0.5, 0.7};
    constexpr double kWorthIt = 4.0;  // two balls alone take 2.7 times as many on a lattice
    const double needed = triangles_needed(dense, request_.tolerance);
    if (static_cast<double>(dense.triangles.size()) < kWorthIt * needed) return {{}, HUGE_VAL};
    const Result<PlacedMesh> placed =
        place_mesh(surface_, dense, cell, request_.max_nodes, request_.progress);
    if (!placed) return {{}, HUGE_VAL};
    const OctreeMesh first{placed->mesh, placed->leaf_of, {}, 0};
    for (const double aim : kCoarseAims) {
      MesherResult result = fit(placed->tree, first, {aim, false, false});
      if (cancelled(request_.progress)) break;
      if (result.error <= kTakenPart * request_.tolerance) {
        return {std::move(result.mesh), result.error};
      }
    }
    return {{}, HUGE_VAL};
  }

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

  /// What the lattice mesher makes of it in the end: on the lattices that were not tried, or
  /// before.
  Result<MesherResult> by_lattice() {
    if (!lattice_) return on_lattices(many_lattices());
    Result<MesherResult> finer = on_lattices(many_lattices(ToleranceOptions().most_attempts));
    const bool better = finer && (!*lattice_ || finer->error < (*lattice_)->error);
    return better || cancelled(request_.progress) ? std::move(finer) : *std::move(lattice_);
  }

  struct Fit {
    double aim = 1.0;       ///< a part of the tolerance
    bool untangle = false;  ///< looks for triangles that cross from the beginning, which is dear
    bool proven = false;    ///< that the topology is right
  };

  /// The first mesh made to fit the tolerance. Its error is infinite where triangles cross.
  MesherResult fit(const SurfaceOctree& tree, const OctreeMesh& first, const Fit& how) {
    RemeshOptions remeshing;
    remeshing.tolerance = how.aim * (how.proven ? 1.0 : kBlindAim) * request_.tolerance;
    remeshing.untangle = how.untangle;
    remeshing.balance = request_.balance;
    remeshing.progress = request_.progress;
    RemeshStatistics remeshed;
    MesherResult result;
    result.mesh = remesh(surface_, tree, first.mesh, first.leaf_of, remeshing, &remeshed);
    log_.jets += remeshed.jets;
    if (result.mesh.empty()) return result;
    std::vector<Vec3d>& on_surface = remeshed.on_surface;
    on_surface.insert(on_surface.end(), first.bulges.begin(), first.bulges.end());
    if (how.proven) {
      BroughtNear brought = bring_near(surface_, result.mesh, on_surface, bring_near_options());
      result.error = brought.error;
      trouble_ = std::move(brought.trouble);
      log_.jets += brought.jets;
    } else {
      trouble_.clear();
      result.error = bring_near_both_ways(result.mesh);
    }
    if (!how.proven && result.error < HUGE_VAL) {
      begin("measure");
      const double tolerance = request_.tolerance;
      const GradientEstimate estimate(0.4 * tolerance, kSmall * tolerance, kSurely * tolerance,
                                      request_.progress);
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
        places_of(find_new_intersections(rounded, {}, kMostPairs), rounded);
    trouble_.insert(trouble_.end(), places.begin(), places.end());
    return !places.empty();
  }

  BringNearOptions bring_near_options() const {
    BringNearOptions options;
    options.tolerance = request_.tolerance;
    options.reach = request_.thinnest_radius;
    // All are looked at closely where vertices are off the surface, as little can be told from a
    // few points then.
    options.small = request_.balance ? HUGE_VAL : kSmall * request_.tolerance;
    options.max_triangles = request_.max_triangles;
    options.progress = request_.progress;
    return options;
  }

  /// Refines the mesh where it is too far from the surface, and joins what there is of the surface
  /// too far from the mesh: without proof, that is looked for.
  double bring_near_both_ways(TriangleMesh& mesh) {
    const auto cross = [&] {
      return mend_crossings(surface_, mesh, request_.thinnest_radius) == Crossings::left;
    };
    if (cross()) return HUGE_VAL;
    BothWaysOptions options;
    options.enough = kRefinedBlindly * request_.tolerance;
    options.improve = true;
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
  std::optional<Result<MesherResult>> lattice_;  ///< what a few lattices make of it, if tried
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
  const bool on_lattices =
      !surface.has_cheap_bounds() && !std::isfinite(surface.derivative_bound(1, surface.bounds()));
  AdaptiveStatistics log;
  Adaptive adaptive(surface, request, log);
  Result<MesherResult> result = on_lattices ? adaptive.run_on_lattices() : adaptive.run();
  if (statistics != nullptr) *statistics = log;
  return result;
}

}  // namespace cs2mesh
