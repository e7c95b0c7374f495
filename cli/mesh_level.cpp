#include "cli/mesh_level.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "cli/verify_mesh.h"

namespace cs2mesh {
namespace {

/// How much coarser each level is than the one before: with about a fourth of its triangles.
constexpr double kCoarser = 4.0;
/// Parts of the tolerance that a mesh is made to, one after the other, until it measures up.
constexpr double kAims[] = {1.0, 0.6, 0.35};

/// Checks the meshes as each of the outputs will hold them; the report is of the first output.
/// Throws Exit{kCheckFailed} if a promise is broken.
std::vector<PartReport> check_outputs(const Model& model, const std::vector<std::string>& outputs,
                                      const Scene& scene, const MeshRequest& request,
                                      Console& console) {
  CheckOptions options;
  options.self_intersections = request.self_intersections;
  options.progress = &console.progress();
  std::vector<PartReport> first;
  for (const std::string& path : paths_by_rounding(outputs)) {
    Model rounded = model;
    round_to_format(rounded, *mesh_format_of(path), request.file_options(scene));
    std::vector<PartReport> parts = check(rounded, options);
    console.stop_if_interrupted();
    const std::vector<Diagnostic> defects = defect_messages(parts, path);
    if (!defects.empty()) {
      console.show(defects);
      console.fail(Failure::check_failed, "the mesh failed its check; nothing was written",
                   {path, 0, 0});
    }
    if (first.empty()) first = std::move(parts);
  }
  return first;
}

Json estimated_error(const std::vector<PartLog>& log) {
  double largest = 0;
  for (const PartLog& part : log) largest = std::max(largest, part.error);
  return {{"mesh_to_surface_max", largest}};
}

/// The parts as they were written, and with `united` what became of those that touched.
void add_parts(Json& report, const MeshedScene& meshed, const std::vector<PartReport>& checked,
               bool united) {
  Json parts = Json::array();
  for (std::size_t i = 0; i < checked.size(); ++i) {
    Json part = to_json(checked[i]);
    part["cell"] = meshed.log[i].cell;
    part["error"] = {{"mesh_to_surface_max", meshed.log[i].error}};
    if (united) part["united"] = meshed.model.parts[i].sources;
    parts.push_back(std::move(part));
  }
  report["parts"] = std::move(parts);
  if (united) {
    report["swallowed"] = Json::array();
    for (const PartLog& log : meshed.swallowed) report["swallowed"].push_back(log.name);
  }
}

/// What is off, and that more than it may be.
std::string off_text(const Measured& measured, double tolerance) {
  return measured.what + " is off by " + std::to_string(measured.error.max()) +
         ", more than the tolerance of " + std::to_string(tolerance);
}

/// Measures the level if that was asked for. Returns whether it is within its tolerance; else
/// throws Exit where `last`, unless it was the number of triangles that set the tolerance: then
/// the distance measured is the tolerance.
bool measures_up(const MeshRun& run, const Fineness& fineness, bool last, MeshLevel& level) {
  if (!run.request.verifies()) return true;
  run.watch.start("verify");
  const Measured measured =
      measure_outputs(level.meshed, run.exact, {level.outputs, run.request.file_options(run.scene)},
                      run.request.united, run.console);
  level.measured = measured.error;
  if (measured.error.max() <= fineness.tolerance) return true;
  const std::string off = off_text(measured, fineness.tolerance);
  const auto warn = [&](const std::string& what) {
    run.console.show({{Severity::warning, Failure::none, measured.where, off + what}});
  };
  if (fineness.budgeted) {
    warn(", as measured, which becomes the tolerance");
    level.tolerance = measured.error.max();
    return true;
  }
  if (last) run.console.fail(Failure::tolerance, off + "; nothing was written", measured.where);
  warn(", as measured: it is meshed again, finer");
  return false;
}

/// Has the scene meshed, and again to a part of the tolerance where it is off when measured.
template <class MeshTo>
void mesh_within(const MeshRun& run, const Fineness& fineness, const MeshTo& mesh_to,
                 MeshLevel& level) {
  level.tolerance = fineness.tolerance;
  for (const double aim : kAims) {
    Fineness aimed = fineness;
    aimed.tolerance *= aim;
    level.meshed = mesh_to(aimed);
    const bool last = fineness.cell > 0 || aim == std::end(kAims)[-1];
    if (measures_up(run, fineness, last, level)) return;
  }
}

void finish(const MeshRun& run, MeshLevel& level) {
  run.watch.start("clean");
  // Only now: what is left out would be missed where it is measured.
  level.left_out = leave_out(level.meshed, run.compiled, run.request, run.console);
  level.checked =
      check_outputs(level.meshed.model, level.outputs, run.scene, run.request, run.console);
  run.watch.start("attributes");
  add_attributes(level.meshed, run.compiled, run.scene, run.request);
  run.console.stop_if_interrupted();
}

}  // namespace

MeshedScene mesh_united(const MeshRun& run, const Fineness& fineness,
                        const std::function<void(MeshedScene&)>& look) {
  run.watch.start("extract");
  MeshedScene meshed = mesh_parts(run.compiled, run.scene, fineness, run.console);
  if (look) look(meshed);
  if (run.request.united) {
    run.watch.start("unite");
    unite_parts(meshed, run.compiled, fineness, run.console);
  }
  return meshed;
}

MeshLevel mesh_first_level(const MeshRun& run, const Fineness& fineness, const Json& report) {
  MeshLevel level;
  const auto certify = [&](MeshedScene& parts) {
    if (!run.request.wants_certificate()) return;
    run.watch.start("certify");
    level.certificates =
        certify_if_asked(parts, run.compiled, fineness, run.request, report, run.console);
  };
  level.outputs = run.request.outputs;
  mesh_within(
      run, fineness, [&](const Fineness& aimed) { return mesh_united(run, aimed, certify); },
      level);
  finish(run, level);
  return level;
}

MeshLevel level_of(const MeshRun& run, const Fineness& fineness, MeshedScene united) {
  MeshLevel level;
  level.outputs = run.request.outputs;
  mesh_within(
      run, fineness, [&](const Fineness&) { return std::move(united); }, level);
  finish(run, level);
  return level;
}

MeshLevel mesh_coarser_level(const MeshRun& run, Fineness fineness, int number,
                             const MeshLevel& before) {
  fineness.tolerance = kCoarser * before.tolerance;
  fineness.budgeted = false;
  MeshLevel level;
  level.outputs = run.request.outputs_of(number);
  mesh_within(
      run, fineness, [&](const Fineness& aimed) { return mesh_united(run, aimed); }, level);
  finish(run, level);
  return level;
}

std::optional<std::size_t> unresolved_cells(const MeshLevel& level) {
  std::size_t count = 0;
  for (const PartLog& part : level.meshed.log) {
    if (!part.unresolved_cells) return std::nullopt;
    count += *part.unresolved_cells;
  }
  return count;
}

void add_level(Json& report, const MeshLevel& level, const MeshRequest& request) {
  report["error"] = level.measured ? to_json(*level.measured) : estimated_error(level.meshed.log);
  add_check(report, level.checked);
  if (request.min_feature) {
    const std::optional<std::size_t> cells = unresolved_cells(level);
    report["unresolved_cells"] = cells ? Json(*cells) : Json(nullptr);
  }
  if (request.leaves_out()) report["left_out"] = to_json(level.left_out);
  if (!level.certificates.empty()) add_certificates(report, level.certificates);
  add_parts(report, level.meshed, level.checked, request.united);
}

}  // namespace cs2mesh
