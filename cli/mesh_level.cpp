#include "cli/mesh_level.h"

#include <algorithm>
#include <cmath>
#include <iterator>

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

/// Meshes all parts, certifies and unites them as far as that was asked for.
void mesh_once(const MeshRun& run, const Fineness& fineness, int number, const Json& report,
               MeshLevel& level) {
  const MeshRequest& request = run.request;
  run.watch.start("extract");
  level.meshed = mesh_parts(run.compiled, run.scene, fineness, run.console);
  if (request.wants_certificate() && number == 0) {
    run.watch.start("certify");
    level.certificates =
        certify_if_asked(level.meshed, run.compiled, fineness, request, report, run.console);
  }
  if (request.united) {
    run.watch.start("unite");
    unite_parts(level.meshed, run.compiled, fineness, run.console);
  }
  level.error = estimated_error(level.meshed.log);
}

/// The same, and where it is to be measured and is off, again to a part of the tolerance.
void mesh_within(const MeshRun& run, const Fineness& fineness, int number, const Json& report,
                 MeshLevel& level) {
  const MeshRequest& request = run.request;
  for (const double aim : kAims) {
    Fineness aimed = fineness;
    aimed.tolerance *= aim;
    mesh_once(run, aimed, number, report, level);
    if (!request.verifies()) return;
    run.watch.start("verify");
    const Measured measured =
        measure_outputs(level.meshed, run.exact, {level.outputs, request.file_options(run.scene)},
                        request.united, run.console);
    level.error = to_json(measured.error);
    if (measured.error.max() <= fineness.tolerance) return;
    const std::string off = measured.what + " is off by " + std::to_string(measured.error.max()) +
                            ", more than the tolerance of " + std::to_string(fineness.tolerance);
    if (fineness.cell > 0 || aim == std::end(kAims)[-1]) {
      run.console.fail(Failure::tolerance, off + "; nothing was written", measured.where);
    }
    run.console.show({{Severity::warning, Failure::none, measured.where,
                       off + ", as measured: it is meshed again, finer"}});
  }
}

}  // namespace

Fineness coarser(Fineness fineness, int number) {
  fineness.tolerance *= std::pow(kCoarser, number);
  return fineness;
}

MeshLevel mesh_level(const MeshRun& run, const Fineness& fineness, int number, const Json& report) {
  const MeshRequest& request = run.request;
  MeshLevel level;
  level.tolerance = fineness.tolerance;
  level.outputs = request.outputs_of(number);
  mesh_within(run, fineness, number, report, level);
  run.watch.start("clean");
  // Only now: what is left out would be missed where it is measured.
  level.left_out = leave_out(level.meshed, run.compiled, request, run.console);
  level.checked = check_outputs(level.meshed.model, level.outputs, run.scene, request, run.console);
  run.watch.start("attributes");
  add_attributes(level.meshed, run.compiled, run.scene, request);
  run.console.stop_if_interrupted();
  return level;
}

void add_level(Json& report, const MeshLevel& level, const MeshRequest& request) {
  report["error"] = level.error;
  add_check(report, level.checked);
  if (request.leaves_out()) report["left_out"] = to_json(level.left_out);
  if (!level.certificates.empty()) add_certificates(report, level.certificates);
  add_parts(report, level.meshed, level.checked, request.united);
}

}  // namespace cs2mesh
