// cs2mesh SCENE OUT...: the whole way from a scene to checked mesh files.
#include <algorithm>
#include <cstdio>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/certify_parts.h"
#include "cli/interrupt.h"
#include "cli/load_scene.h"
#include "cli/mesh_parts.h"
#include "cli/mesh_report.h"
#include "cli/mesh_request.h"
#include "cli/output_files.h"
#include "cli/verbs.h"
#include "polygonize/part_request.h"
#include "polygonize/ply.h"

namespace cs2mesh {
namespace {

/// Samples of --verify, each way and part.
constexpr std::size_t kVerifySamples = 100000;
constexpr std::size_t kVerifyRays = 2000;

/// Formats that store the same coordinates are checked once.
enum class Rounding { none, stl, glb };

Rounding rounding_of(MeshFormat format) {
  if (format == MeshFormat::stl) return Rounding::stl;
  return format == MeshFormat::glb ? Rounding::glb : Rounding::none;
}

/// Checks the meshes as each of the outputs will hold them; the report is of the first output.
/// Throws Exit{kCheckFailed} if a promise is broken.
std::vector<PartReport> check_outputs(const Model& model, const Scene& scene,
                                      const MeshRequest& request, Console& console) {
  CheckOptions options;
  options.self_intersections = request.self_intersections;
  options.progress = &console.progress();
  std::vector<Rounding> checked;
  std::vector<PartReport> first;
  for (const std::string& path : request.outputs) {
    const MeshFormat format = *mesh_format_of(path);
    if (std::find(checked.begin(), checked.end(), rounding_of(format)) != checked.end()) continue;
    checked.push_back(rounding_of(format));
    Model rounded = model;
    round_to_format(rounded, format, request.file_options(scene));
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

void fail_if_off(const MeasuredError& error, double tolerance, const std::string& what,
                 const SourceLocation& where, Console& console) {
  if (error.max() <= tolerance) return;
  console.fail(Failure::tolerance,
               what + " is off by " + std::to_string(error.max()) +
                   ", more than the tolerance of " + std::to_string(tolerance) +
                   "; nothing was written",
               where);
}

/// The same of all parts together, as their union: what of a surface is inside of another does not
/// count.
Json verify_union(const MeshedScene& meshed, const CompiledScene& compiled, double tolerance,
                  Console& console) {
  MeasureOptions options;
  options.samples = kVerifySamples * compiled.parts.size();
  options.certified_rays = kVerifyRays * compiled.parts.size();
  options.progress = &console.progress();
  std::vector<const ImplicitSurface*> surfaces;
  for (const Part& part : compiled.parts) surfaces.push_back(part.surface.get());
  const MeasuredError error = measure(surfaces, joined(meshed.model), options);
  console.stop_if_interrupted();
  fail_if_off(error, tolerance, "the union", compiled.parts.front().where, console);
  return to_json(error);
}

/// Measures every part with rays; throws Exit{kToleranceMissed} if one is off.
Json verify(const MeshedScene& meshed, const CompiledScene& compiled, double tolerance,
            Console& console) {
  Json worst;
  double largest = -1;
  for (std::size_t i = 0; i < meshed.model.parts.size(); ++i) {
    const Part& part = compiled.parts[meshed.parts_of[i].front()];
    MeasureOptions options;
    options.samples = kVerifySamples;
    options.certified_rays = kVerifyRays;
    options.progress = &console.progress();
    const MeasuredError error = measure(*part.surface, meshed.model.parts[i].mesh, options);
    console.stop_if_interrupted();
    fail_if_off(error, tolerance, "part '" + part.name + "'", part.where, console);
    if (error.max() > largest) {
      largest = error.max();
      worst = to_json(error);
    }
  }
  return worst;
}

void write_outputs(const Model& model, const Scene& scene, const MeshRequest& request,
                   Console& console) {
  const WhileWriting guard;
  OutputFiles files;
  for (const std::string& path : request.outputs) {
    console.take(files.write(path, [&](const std::string& at) {
      return write_mesh(model, at, request.file_options(scene));
    }));
  }
  console.take(files.commit());
}

/// Certifies the parts if that was asked for. With --certify throws Exit{kToleranceMissed}, the
/// report delivered, if anything is in doubt.
std::vector<PartCertificate> certify_if_asked(const MeshedScene& meshed,
                                              const CompiledScene& compiled,
                                              const Fineness& fineness, const MeshRequest& request,
                                              Json report, Console& console) {
  if (!request.wants_certificate()) return {};
  std::vector<PartCertificate> certificates = certify_parts(meshed, compiled, fineness, console);
  console.say(summary(certificates));
  if (!request.certificate.empty()) {
    const WhileWriting guard;
    OutputFiles files;
    console.take(files.write(request.certificate, [&](const std::string& at) {
      return write_ply(picture_of_doubts(meshed, certificates), at);
    }));
    console.take(files.commit());
  }
  if (request.certify && any_doubt(certificates)) {
    add_certificates(report, certificates);
    deliver(report, request.report, console);
    console.fail(Failure::tolerance, "not all of the mesh is certified; no mesh was written",
                 {request.input.path, 0, 0});
  }
  return certificates;
}

Json to_json(const PartLog& log, Json part) {
  part["cell"] = log.cell;
  return part;
}

void add_plan(Json& report, const std::vector<PartLog>& plan) {
  Json parts = Json::array();
  for (const PartLog& log : plan) parts.push_back(to_json(log, {{"name", log.name}}));
  report["parts"] = std::move(parts);
}

/// The parts as they were written, and with `united` what became of those that touched.
void add_parts(Json& report, const MeshedScene& meshed, const std::vector<PartReport>& checked,
               bool united) {
  Json parts = Json::array();
  for (std::size_t i = 0; i < checked.size(); ++i) {
    Json part = to_json(meshed.log[i], to_json(checked[i]));
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

/// Seconds and evaluations, stage by stage and of F all together. Those of --verify are left out,
/// as it asks the surface itself.
void add_costs(Json& report, const Console& console) {
  report["evaluations"] = to_json(console.evaluations());
  report["stages"] = Json::array();
  for (const StageCost& cost : console.stages().costs()) {
    Json entry = {
        {"stage", cost.stage}, {"seconds", cost.seconds}, {"cpu_seconds", cost.cpu_seconds}};
    entry.update(to_json(cost.evaluations));
    report["stages"].push_back(std::move(entry));
  }
}

Json estimated_error(const std::vector<PartLog>& log) {
  double largest = 0;
  for (const PartLog& part : log) largest = std::max(largest, part.error);
  return {{"mesh_to_surface_max", largest}};
}

std::string seconds_text(const Stopwatch& watch) {
  char text[64];
  std::snprintf(text, sizeof text, "%.2f s", watch.seconds()["total"].get<double>());
  return text;
}

int report_plan(Json report, const CompiledScene& compiled, const Fineness& fineness,
                const MeshRequest& request, const Stopwatch& watch, Console& console) {
  const std::vector<PartLog> plan = plan_parts(compiled, fineness);
  for (const PartLog& part : plan) {
    console.say("would mesh part '" + part.name + "' with cells of about " +
                std::to_string(part.cell));
  }
  add_plan(report, plan);
  add_run(report, watch, console);
  deliver(report, request.report, console);
  return kDone;
}

int mesh_scene(const MeshRequest& request, Console& console) {
  Stopwatch watch(&console.progress());
  const Scene scene = read_scene(request.input, console, watch);
  const CompiledScene exact = bounded_parts(scene, console, watch);
  CompiledScene compiled = exact;
  count_evaluations(compiled, console.counter());
  const Fineness fineness = fineness_of(request, scene, compiled);
  Json report = {{"input", request.input.path},
                 {"outputs", request.outputs},
                 {"primitives", scene.elements.size()},
                 {"tolerance", fineness.cell > 0 ? Json(nullptr) : Json(fineness.tolerance)}};
  if (request.dry_run) return report_plan(report, compiled, fineness, request, watch, console);

  watch.start("extract");
  MeshedScene meshed = mesh_parts(compiled, scene, fineness, console);
  if (request.wants_certificate()) watch.start("certify");
  const std::vector<PartCertificate> certificates =
      certify_if_asked(meshed, compiled, fineness, request, report, console);
  if (request.united) {
    watch.start("unite");
    unite_parts(meshed, compiled, fineness, console);
  }
  watch.start("clean");
  const std::vector<PartReport> checked = check_outputs(meshed.model, scene, request, console);
  if (request.self_intersections) warn_if_unchecked(checked, request.input.path, console);
  report["error"] = estimated_error(meshed.log);
  if (request.verify) {
    watch.start("verify");
    report["error"] = request.united && compiled.parts.size() > 1
                          ? verify_union(meshed, exact, fineness.tolerance, console)
                          : verify(meshed, exact, fineness.tolerance, console);
  }
  watch.start("attributes");
  add_attributes(meshed, compiled, scene, request);
  console.stop_if_interrupted();
  watch.start("export");
  write_outputs(meshed.model, scene, request, console);
  watch.stop();

  add_check(report, checked);
  if (!certificates.empty()) add_certificates(report, certificates);
  add_parts(report, meshed, checked, request.united);
  add_costs(report, console);
  add_run(report, watch, console);
  console.say(summary(checked) + ", " + seconds_text(watch));
  deliver(report, request.report, console);
  return kDone;
}

}  // namespace

int run_mesh(const Words& arguments) {
  const MeshRequest request = parse_mesh_request(arguments);
  Console console(request.common);
  require_writable(request, console);
  try {
    return mesh_scene(request, console);
  } catch (const std::bad_alloc&) {
    console.fail_for_memory();
  }
}

}  // namespace cs2mesh
