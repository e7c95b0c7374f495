#include "cli/mesh_budget.h"

#include <algorithm>

#include "cli/printed.h"
#include "polygonize/triangle_budget.h"

namespace cs2mesh {
namespace {

/// Tolerances as parts of the diagonal: the coarsest that makes sense, and one that is soon meshed.
constexpr double kCoarsest = 0.25, kFirst = 0.02;

/// Of the mesh as it would be written.
std::size_t triangles_to_write(const MeshRun& run, const MeshedScene& meshed) {
  if (!run.request.leaves_out()) return meshed.model.triangle_count();
  Model model = meshed.model;
  leave_out(model, leave_out_options(run.request, run.compiled, run.console));
  return model.triangle_count();
}

}  // namespace

BudgetedMesh mesh_within_budget(const MeshRun& run, const Fineness& fineness) {
  const double diagonal = run.compiled.extent.diagonal();
  TriangleBudget budget;
  budget.most_triangles = *run.request.max_triangles;
  budget.finest = fineness.tolerance;
  budget.coarsest = std::max(kCoarsest * diagonal, fineness.tolerance);
  budget.first = kFirst * diagonal;
  BudgetedMesh best{fineness, {}};
  best.fineness.budgeted = true;
  std::size_t last = 0;
  const std::optional<double> reached = finest_within(budget, [&](double tolerance) {
    Fineness tried = best.fineness;
    tried.tolerance = tolerance;
    MeshedScene meshed = mesh_united(run, tried);
    last = triangles_to_write(run, meshed);
    run.console.stop_if_interrupted();
    run.console.remark("tolerance " + printed("%.6g", tolerance) + ": " + std::to_string(last) +
                       " triangles");
    // Those that fit come finer and finer.
    if (last <= budget.most_triangles) best = {tried, std::move(meshed)};
    return last;
  });
  if (!reached) {
    run.console.fail(Failure::limit,
                     "even at a quarter of the diagonal there are " + std::to_string(last) +
                         " triangles, more than the " + std::to_string(budget.most_triangles) +
                         " of --max-triangles; nothing was written",
                     {run.request.input.path, 0, 0});
  }
  if (*reached > fineness.tolerance) {
    run.console.say("for at most " + std::to_string(budget.most_triangles) +
                    " triangles the tolerance is " + printed("%.6g", *reached) + " instead of " +
                    printed("%.6g", fineness.tolerance));
  }
  return best;
}

}  // namespace cs2mesh
