#include "cli/mesh_level.h"

#include <algorithm>
#include <cmath>

#include "cli/verify_mesh.h"

namespace cs2mesh {
namespace {

/// How much coarser each level is than the one before: with about a fourth of its triangles.
constexpr double kCoarser = 4.0;

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

}  // namespace

Fineness coarser(Fineness fineness, int number) {
  fineness.tolerance *= std::pow(kCoarser, number);
  return fineness;
}

MeshLevel mesh_level(const MeshRun& run, const Fineness& fineness, int number, const Json& report) {
  const MeshRequest& request = run.request;
  Console& console = run.console;
  MeshLevel level;
  level.tolerance = fineness.tolerance;
  level.outputs = request.outputs_of(number);
  run.watch.start("extract");
  level.meshed = mesh_parts(run.compiled, run.scene, fineness, console);
  if (request.wants_certificate() && number == 0) {
    run.watch.start("certify");
    level.certificates =
        certify_if_asked(level.meshed, run.compiled, fineness, request, report, console);
  }
  if (request.united) {
    run.watch.start("unite");
    unite_parts(level.meshed, run.compiled, fineness, console);
  }
  level.error = estimated_error(level.meshed.log);
  if (request.verifies()) {
    run.watch.start("verify");
    level.error = to_json(
        verify(level.meshed, run.exact,
               {fineness.tolerance, request.united, level.outputs, request.file_options(run.scene)},
               console));
  }
  run.watch.start("clean");
  // Only now: what is left out would be missed by --verify.
  level.left_out = leave_out(level.meshed, run.compiled, request, console);
  level.checked = check_outputs(level.meshed.model, level.outputs, run.scene, request, console);
  run.watch.start("attributes");
  add_attributes(level.meshed, run.compiled, run.scene, request);
  console.stop_if_interrupted();
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
