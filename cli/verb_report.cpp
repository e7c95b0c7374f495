// cs2mesh report: which mesher is how exact in which time? One page that tells it in numbers, plots
// and pictures.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/interrupt.h"
#include "cli/load_scene.h"
#include "cli/output_files.h"
#include "cli/printed.h"
#include "cli/report_html.h"
#include "cli/report_pictures.h"
#include "cli/report_request.h"
#include "cli/report_rows.h"
#include "cli/verbs.h"
#include "libfield/base/atomic_file.h"
#include "polygonize/convergence.h"
#include "polygonize/reference_uncertainty.h"

namespace cs2mesh {
namespace {

/// One line through so many points of the surface, as `compare` has it.
constexpr std::size_t kSamplesPerRay = 100;

LadderOptions ladder_of(const ReportRequest& request, double diagonal, Console& console) {
  LadderOptions options;
  for (const Length& length : request.tolerances) {
    options.tolerances.push_back(length.absolute(diagonal));
  }
  std::sort(options.tolerances.rbegin(), options.tolerances.rend());
  options.tolerances.erase(std::unique(options.tolerances.begin(), options.tolerances.end()),
                           options.tolerances.end());
  options.meshers = request.meshers;
  options.samples = request.samples;
  options.certified_rays = request.samples / kSamplesPerRay;
  if (request.time_limit > 0) options.time_limit = request.time_limit;
  options.progress = &console.progress();
  return options;
}

void say(const LadderRun& run, double diagonal, Console& console) {
  std::string line =
      run.mesher + ", tolerance " + printed("%.3g %%", 100 * run.tolerance / diagonal) +
      " of the diagonal: " + std::string(name(run.outcome)) + ", " + printed("%.3g s", run.seconds);
  if (run.has_mesh()) {
    line += ", " + std::to_string(run.triangles) + " triangles, off by " +
            printed("%.3g %%", 100 * run.error.max() / diagonal);
  }
  if (!run.remark.empty()) line += " (" + run.remark + ")";
  console.say(line);
}

Json describe(const ReportRequest& request, const Scene& scene, const CompiledScene& compiled,
              const LadderOptions& options) {
  Json report = {{"input", request.input.path},
                 {"outputs", request.outputs()},
                 {"primitives", scene.elements.size()},
                 {"parts", compiled.parts.size()},
                 {"diagonal", compiled.extent.diagonal()},
                 {"samples", options.samples},
                 {"tolerances", options.tolerances},
                 {"meshers", Json::array()}};
  report["time_limit"] = request.time_limit > 0 ? Json(request.time_limit) : Json(nullptr);
  for (const Mesher* mesher : options.meshers) report["meshers"].push_back(mesher->name);
  return report;
}

void add_runs(Json& report, const std::vector<LadderRun>& runs, double diagonal) {
  const bool own =
      std::all_of(runs.begin(), runs.end(), [](const LadderRun& run) { return run.own_memory; });
  report["memory"] = own ? "run" : "process";
  report["runs"] = runs_to_json(runs, diagonal);
  report["orders"] = orders_to_json(fit_orders(runs));
}

void write_outputs(const ReportRequest& request, const Json& report, const ReportPage& page,
                   Console& console) {
  const WhileWriting guard;
  OutputFiles files;
  console.take(files.write(request.page, [&](const std::string& at) {
    return write_file(at, report_html(report, page));
  }));
  if (!request.csv.empty()) {
    console.take(files.write(request.csv, [&](const std::string& at) {
      return write_file(at, to_csv(report["runs"]));
    }));
  }
  console.take(files.commit());
}

}  // namespace

int run_report(const Words& arguments) {
  const ReportRequest request = parse_report_request(arguments);
  Console console(request.common);
  require_writable(request, console);
  Stopwatch watch;
  const Scene scene = read_scene(request.input, console, watch);
  const CompiledScene compiled = bounded_parts(scene, console, watch);
  const double diagonal = compiled.extent.diagonal();
  const LadderOptions options = ladder_of(request, diagonal, console);
  Json report = describe(request, scene, compiled, options);

  watch.start("reference");
  const double uncertainty = reference_uncertainty(compiled, CompileOptions().error_budget,
                                                   options.samples, options.progress);
  console.stop_if_interrupted();
  report["reference"] = {{"uncertainty", uncertainty}};
  ReportPage page;
  ReportPictures pictures(scene, compiled, request.size, options.tolerances, console);
  watch.start("pictures");
  pictures.start(page);

  watch.start("ladder");
  const std::vector<LadderRun> runs =
      console.take(climb_ladder(scene, compiled, options, [&](const LadderRun& run, Model& model) {
        say(run, diagonal, console);
        watch.start("pictures");
        pictures.add(run, model, page);
        watch.start("ladder");
      }));
  add_runs(report, runs, diagonal);
  watch.start("plots");
  add_plots(runs, uncertainty, diagonal, page, console);
  report["plots"] = page.plots.size();
  watch.stop();

  add_run(report, watch, console);
  write_outputs(request, report, page, console);
  deliver(report, "", console);
  return kDone;
}

}  // namespace cs2mesh
