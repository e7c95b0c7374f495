// cs2mesh SCENE OUT...: the whole way from a scene to checked mesh files.
#include <new>
#include <nlohmann/json.hpp>

#include "cli/certify_parts.h"
#include "cli/interrupt.h"
#include "cli/load_scene.h"
#include "cli/mesh_budget.h"
#include "cli/output_files.h"
#include "cli/printed.h"
#include "cli/verbs.h"
#include "polygonize/part_request.h"

namespace cs2mesh {
namespace {

/// All levels appear, or none.
void write_outputs(const std::vector<MeshLevel>& levels, const Scene& scene,
                   const MeshRequest& request, Console& console) {
  const WhileWriting guard;
  OutputFiles files;
  for (const MeshLevel& level : levels) {
    for (const std::string& path : level.outputs) {
      console.take(files.write(path, [&](const std::string& at) {
        return write_mesh(level.meshed.model, at, request.file_options(scene));
      }));
    }
  }
  console.take(files.commit());
}

void add_plan(Json& report, const std::vector<PartLog>& plan) {
  Json parts = Json::array();
  for (const PartLog& log : plan) parts.push_back({{"name", log.name}, {"cell", log.cell}});
  report["parts"] = std::move(parts);
}

/// Seconds and evaluations, stage by stage and of F all together, and the part of the processor
/// time that certificates took. Those of --verify are left out, as it asks the surface itself.
void add_costs(Json& report, const MeshRequest& request, const Console& console) {
  if (request.wants_certificate())
    report["certificate_time_share"] = share_of_time(console.stages().costs());
  report["evaluations"] = to_json(console.evaluations());
  report["stages"] = Json::array();
  for (const StageCost& cost : console.stages().costs()) {
    Json entry = {
        {"stage", cost.stage}, {"seconds", cost.seconds}, {"cpu_seconds", cost.cpu_seconds}};
    entry.update(to_json(cost.evaluations));
    report["stages"].push_back(std::move(entry));
  }
}

std::string seconds_text(const Stopwatch& watch) {
  return printed("%.2f s", watch.seconds()["total"].get<double>());
}

/// A line a level, the time with the first.
void say(const std::vector<MeshLevel>& levels, const Stopwatch& watch, Console& console) {
  std::string proofs;
  if (!levels.front().certificates.empty()) {
    proofs = printed(", %.0f %% of the processor time for proofs",
                     100 * share_of_time(console.stages().costs()));
  }
  console.say(summary(levels.front().checked) + ", " + seconds_text(watch) + proofs);
  if (const auto cells = unresolved_cells(levels.front()); cells && *cells > 0) {
    console.say(std::to_string(*cells) + " cells may hide what is thinner than --min-feature");
  }
  for (std::size_t i = 1; i < levels.size(); ++i) {
    console.say("level " + std::to_string(i) + ", tolerance " +
                printed("%.3g", levels[i].tolerance) + ": " + summary(levels[i].checked));
  }
}

/// Of all levels but the first, which the report is of, each with the same fields.
Json levels_to_json(const std::vector<MeshLevel>& levels, const MeshRequest& request) {
  Json list = Json::array();
  for (std::size_t i = 1; i < levels.size(); ++i) {
    Json entry = {{"outputs", levels[i].outputs}, {"tolerance", levels[i].tolerance}};
    add_level(entry, levels[i], request);
    list.push_back(std::move(entry));
  }
  return list;
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

/// The mesh that was asked for, and in the report what became of its tolerance.
MeshLevel first_level(const MeshRun& run, const Fineness& fineness, Json& report) {
  if (!run.request.max_triangles) return mesh_first_level(run, fineness, report);
  BudgetedMesh best = mesh_within_budget(run, fineness);
  report["tolerance"] = best.fineness.tolerance;
  report["tolerance_asked"] = fineness.tolerance;
  // Parts are certified before they are united, and so have to be meshed once more.
  MeshLevel level = run.request.wants_certificate()
                        ? mesh_first_level(run, best.fineness, report)
                        : level_of(run, best.fineness, std::move(best.meshed));
  report["tolerance"] = level.tolerance;
  return level;
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

  const MeshRun run{request, scene, exact, compiled, watch, console};
  std::vector<MeshLevel> levels;
  levels.push_back(first_level(run, fineness, report));
  for (int i = 1; i <= request.levels; ++i) {
    levels.push_back(mesh_coarser_level(run, fineness, i, levels.back()));
  }
  if (request.self_intersections) {
    warn_if_unchecked(levels.front().checked, request.input.path, console);
  }
  watch.start("export");
  write_outputs(levels, scene, request, console);
  watch.stop();

  add_level(report, levels.front(), request);
  if (request.levels > 0) report["levels"] = levels_to_json(levels, request);
  add_costs(report, request, console);
  add_run(report, watch, console);
  say(levels, watch, console);
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
