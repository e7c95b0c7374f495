#include "polygonize/convergence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <new>

#include "libfield/base/check.h"
#include "libfield/base/peak_memory.h"
#include "polygonize/compare.h"
#include "polygonize/deadline.h"
#include "polygonize/pareto_front.h"
#include "polygonize/part_request.h"
#include "polygonize/stage_log.h"

namespace cs2mesh {
namespace {

/// Runs are repeated while they have taken less than this together, to quiet the clock.
constexpr double kEnoughSeconds = 1.0;
constexpr int kMostTimings = 3;

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

Diagnostic interruption() {
  return error_at({}, "interrupted", Failure::interrupted);
}

/// All parts, meshed once.
struct Attempt {
  Model model;
  Evaluations evaluations;
  double estimate = 0.0;
  bool reached = true;
  double seconds = 0.0, cpu_seconds = 0.0;
  std::vector<Diagnostic> errors;  ///< without these there is a mesh
};

CompiledScene compiled_anew(const Scene& scene) {
  Result<CompiledScene> compiled = compile(scene);
  require(static_cast<bool>(compiled), "a ladder's scene compiles");
  compiled = clip_to_bounds(*std::move(compiled), scene);
  require(static_cast<bool>(compiled), "a ladder's scene is bounded");
  return *std::move(compiled);
}

void mesh_part(const Part& part, const Mesher& mesher, double tolerance, Progress& progress,
               Attempt& attempt) {
  Result<MesherResult> made = mesher.mesh(*part.surface, request_for(part, tolerance, &progress));
  if (!made) {
    attempt.errors = made.diagnostics();
    return;
  }
  attempt.estimate = std::max(attempt.estimate, made->error);
  attempt.reached = attempt.reached && made->reached;
  attempt.model.parts.push_back({part.name, std::move(made->mesh)});
}

Attempt mesh_once(const Scene& scene, const Mesher& mesher, double tolerance,
                  const LadderOptions& options) {
  EvaluationCounter counter;
  CompiledScene fresh = compiled_anew(scene);
  count_evaluations(fresh, counter);
  Attempt attempt;
  const double cpu_before = cpu_seconds();
  Deadline deadline(options.time_limit, options.progress);
  try {
    for (const Part& part : fresh.parts) {
      mesh_part(part, mesher, tolerance, deadline, attempt);
      if (!attempt.errors.empty()) break;
    }
  } catch (const std::bad_alloc&) {
    attempt.errors = {error_at({}, "out of memory", Failure::limit)};
  }
  attempt.seconds = deadline.elapsed();
  attempt.cpu_seconds = cpu_seconds() - cpu_before;
  attempt.evaluations = counter.total();
  return attempt;
}

/// Meshes as often as the clock needs.
Attempt mesh_timed(const Scene& scene, const Mesher& mesher, double tolerance,
                   const LadderOptions& options, LadderRun& run) {
  Attempt attempt;
  double total = 0;
  run.seconds = std::numeric_limits<double>::infinity();
  while (run.timings < kMostTimings && total < kEnoughSeconds) {
    attempt = {};  // not two meshes at once
    attempt = mesh_once(scene, mesher, tolerance, options);
    total += attempt.seconds;
    ++run.timings;
    if (attempt.seconds < run.seconds) {
      run.seconds = attempt.seconds;
      run.cpu_seconds = attempt.cpu_seconds;
    }
    if (!attempt.errors.empty()) break;
  }
  return attempt;
}

/// Measures the mesh; false where the user stopped it.
bool measure_run(const CompiledScene& compiled, const Scene& scene, const Model& model,
                 const LadderOptions& options, LadderRun& run) {
  CompareOptions comparing;
  comparing.samples = options.samples;
  comparing.certified_rays = options.certified_rays;
  comparing.silhouette = false;
  comparing.progress = options.progress;
  const Deadline clock(std::numeric_limits<double>::infinity(), nullptr);
  const Result<CompareReport> whole = compare(compiled, scene, model, comparing);
  if (!whole) return false;
  run.measure_seconds = clock.elapsed();
  run.error = whole->total;
  ++comparing.seed;
  comparing.samples /= 2;
  comparing.certified_rays /= 2;
  // A mesh with enough vertices, edges and centroids is measured at these alone: the same again.
  comparing.mesh_to_surface = 3 * run.triangles < options.samples;
  const Result<CompareReport> half = compare(compiled, scene, model, comparing);
  if (!half) return false;
  MeasuredError other = half->total;
  if (!comparing.mesh_to_surface) other.mesh_to_surface_max = run.error.mesh_to_surface_max;
  const bool finite = std::isfinite(run.error.max()) && std::isfinite(other.max());
  run.spread = finite ? std::abs(run.error.max() - other.max()) : 0.0;
  return true;
}

/// What is to be said of a run with a mesh.
void judge(bool reached, LadderRun& run) {
  run.outcome = RunOutcome::missed;
  if (!std::isfinite(run.error.max())) {
    run.remark = std::isfinite(run.error.surface_to_mesh_max) ? "there is mesh where no surface is"
                                                              : "a part has a surface and no mesh";
  } else if (!reached) {
    run.remark = "the mesher gave up at a distance of " + number_text(run.estimate);
  } else if (run.error.max() > run.tolerance) {
    run.remark = "the mesher says that it is within " + number_text(run.estimate) +
                 ", which measuring does not confirm";
  } else {
    run.outcome = RunOutcome::reached;
  }
}

}  // namespace

std::string_view name(RunOutcome outcome) {
  switch (outcome) {
    case RunOutcome::reached:
      return "reached";
    case RunOutcome::missed:
      return "missed";
    case RunOutcome::cut_off:
      return "cut off";
    case RunOutcome::failed:
      return "failed";
  }
  return "";
}

Result<LadderRun> run_rung(const Scene& scene, const CompiledScene& compiled, const Mesher& mesher,
                           double tolerance, const LadderOptions& options, Model* model) {
  require(tolerance > 0, "run_rung: a tolerance > 0");
  LadderRun run;
  run.mesher = mesher.name;
  run.tolerance = tolerance;
  const MemoryWatch memory;
  Attempt attempt = mesh_timed(scene, mesher, tolerance, options, run);
  run.peak_memory = memory.peak_bytes();
  run.own_memory = memory.own();
  if (cancelled(options.progress)) return interruption();
  if (!attempt.errors.empty()) {
    const Diagnostic& first = attempt.errors.front();
    const bool late = first.failure == Failure::interrupted;
    run.outcome = late ? RunOutcome::cut_off : RunOutcome::failed;
    run.remark = late ? "stopped after " + number_text(run.seconds) + " s" : first.message;
    return run;
  }
  run.vertices = attempt.model.vertex_count();
  run.triangles = attempt.model.triangle_count();
  run.evaluations = attempt.evaluations;
  run.estimate = attempt.estimate;
  if (run.triangles == 0) {
    run.remark = "there is no surface that the mesher can see";
    return run;
  }
  if (!measure_run(compiled, scene, attempt.model, options, run)) return interruption();
  judge(attempt.reached, run);
  if (model != nullptr) *model = std::move(attempt.model);
  return run;
}

Result<std::vector<LadderRun>> climb_ladder(const Scene& scene, const CompiledScene& compiled,
                                            const LadderOptions& options, const RunVisitor& visit) {
  std::vector<LadderRun> runs;
  for (const Mesher* mesher : options.meshers) {
    for (const double tolerance : options.tolerances) {
      Model model;
      Result<LadderRun> run = run_rung(scene, compiled, *mesher, tolerance, options, &model);
      if (!run) return Result<std::vector<LadderRun>>::failure(run.diagnostics());
      runs.push_back(*std::move(run));
      if (visit) visit(runs.back(), model);
    }
  }
  return runs;
}

std::vector<MesherOrders> fit_orders(std::span<const LadderRun> runs) {
  std::vector<MesherOrders> orders;
  for (const LadderRun& run : runs) {
    const bool known = std::any_of(orders.begin(), orders.end(), [&](const MesherOrders& entry) {
      return entry.mesher == run.mesher;
    });
    if (!known) orders.push_back({run.mesher, {}, {}, {}});
  }
  for (MesherOrders& entry : orders) {
    std::vector<double> triangles, seconds, largest, rms;
    for (const LadderRun& run : runs) {
      if (run.mesher != entry.mesher || !run.has_mesh()) continue;
      triangles.push_back(cost_of(run, RunCost::triangles));
      seconds.push_back(cost_of(run, RunCost::seconds));
      largest.push_back(run.error.max());
      rms.push_back(run.error.rms);
    }
    entry.max_by_triangles = fit_power(triangles, largest);
    entry.rms_by_triangles = fit_power(triangles, rms);
    entry.max_by_seconds = fit_power(seconds, largest);
  }
  return orders;
}

double cost_of(const LadderRun& run, RunCost cost) {
  return cost == RunCost::seconds ? run.seconds : static_cast<double>(run.triangles);
}

std::vector<bool> pareto_runs(std::span<const LadderRun> runs, RunCost cost) {
  std::vector<double> costs, errors;
  for (const LadderRun& run : runs) {
    costs.push_back(cost_of(run, cost));
    errors.push_back(run.has_mesh() ? run.error.max() : std::numeric_limits<double>::infinity());
  }
  return pareto_front(costs, errors);
}

}  // namespace cs2mesh
