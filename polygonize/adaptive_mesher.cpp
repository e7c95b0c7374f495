#include "polygonize/adaptive_mesher.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "libfield/base/check.h"
#include "polygonize/mend_crossings.h"
#include "polygonize/octree_mesh.h"
#include "polygonize/refine.h"
#include "polygonize/remesh.h"
#include "polygonize/tolerance.h"

namespace cs2mesh {
namespace {

/// Parts of the tolerance: what remeshing aims at, in one attempt after the other; what triangles
/// are refined to; what is accepted, as the distance is measured at points.
constexpr double kAims[] = {1.0, 0.6, 0.35};
constexpr double kRefined = 0.9, kAccept = 0.96;

/// Below this side cells are not cut. Necks and gaps between smooth blobs are far larger, seen from
/// the blobs; along creases nothing is ever simple, so only the tolerance counts.
double smallest_side(const MesherRequest& request) {
  constexpr double kNeck = 1.0 / 64, kCrease = 0.35;
  const double neck = kNeck * request.thinnest_radius;
  return request.creased ? std::max(kCrease * request.tolerance, neck)
                         : std::min(kCrease * request.tolerance, neck);
}

Diagnostic missed(double tolerance, double error) {
  std::ostringstream text;
  text << "the tolerance " << tolerance << " was not reached: the mesh is within " << error
       << " of the surface";
  return {Severity::warning, Failure::tolerance, {}, text.str()};
}

class Adaptive {
 public:
  Adaptive(const ImplicitSurface& surface, const MesherRequest& request, AdaptiveStatistics& log)
      : surface_(surface), request_(request), log_(log) {}

  Result<MesherResult> run() {
    SurfaceOctreeOptions options;
    options.tolerance = request_.tolerance;
    options.smallest = smallest_side(request_);
    options.max_cells = request_.max_nodes;
    options.progress = request_.progress;
    const Result<SurfaceOctree> tree = SurfaceOctree::build(surface_, options);
    if (!tree) return Result<MesherResult>::failure(tree.diagnostics());
    look_at(*tree);
    const OctreeMesh first = mesh_octree(surface_, *tree);
    log_.first_triangles = first.mesh.triangles.size();
    log_.jets += first.evaluations;
    if (log_.first_triangles > request_.max_triangles) return too_many();

    MesherResult best;
    best.error = HUGE_VAL;
    for (const double aim : kAims) {
      ++log_.attempts;
      MesherResult result = fit(*tree, first, aim);
      if (cancelled(request_.progress)) return error_at({}, "interrupted", Failure::interrupted);
      if (result.error < best.error) best = std::move(result);
      if (best.error <= kAccept * request_.tolerance) break;
    }
    best.cell = smallest_cell_;
    best.values = log_.octree.values + log_.jets;
    best.gradients = log_.octree.gradients + log_.jets;
    best.reached = best.error <= request_.tolerance;
    std::vector<Diagnostic> remarks;
    if (!best.reached) remarks.push_back(missed(request_.tolerance, best.error));
    return {std::move(best), std::move(remarks)};
  }

 private:
  void look_at(const SurfaceOctree& tree) {
    log_.octree = tree.counts();
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

  /// The first mesh made to fit that part of the tolerance. Its error is infinite where triangles
  /// cross.
  MesherResult fit(const SurfaceOctree& tree, const OctreeMesh& first, double aim) {
    RemeshOptions remeshing;
    remeshing.tolerance = aim * request_.tolerance;
    remeshing.progress = request_.progress;
    RemeshStatistics remeshed;
    MesherResult result;
    result.mesh = remesh(surface_, tree, first.mesh, first.leaf_of, remeshing, &remeshed);
    log_.jets += remeshed.jets;
    RefineOptions refinement;
    refinement.tolerance = kRefined * request_.tolerance;
    refinement.max_triangles = request_.max_triangles;
    refinement.progress = request_.progress;
    if (result.mesh.empty()) return result;
    constexpr int kMostPasses = 4;
    Crossings crossings = Crossings::mended;
    for (int pass = 0; pass < kMostPasses && crossings == Crossings::mended; ++pass) {
      result.mesh = refine(surface_, std::move(result.mesh), refinement);
      log_.jets += result.mesh.triangles.size();
      crossings = mend_crossings(surface_, result.mesh, request_.thinnest_radius);
    }
    if (crossings == Crossings::left) {
      result.error = HUGE_VAL;
      return result;
    }
    const GradientEstimate estimate(0.4 * request_.tolerance);
    result.error = estimate.largest_distance(surface_, result.mesh);
    log_.jets += result.mesh.triangles.size();
    return result;
  }

  const ImplicitSurface& surface_;
  const MesherRequest& request_;
  AdaptiveStatistics& log_;
  double smallest_cell_ = 0.0;
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
  AdaptiveStatistics log;
  Result<MesherResult> result = Adaptive(surface, request, log).run();
  if (statistics != nullptr) *statistics = log;
  return result;
}

}  // namespace cs2mesh
