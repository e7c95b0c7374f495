// cs2mesh check: is a mesh closed, manifold, free of self-intersections, and if not, where?
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/mesh_report.h"
#include "cli/verbs.h"
#include "polygonize/mesh_file.h"

namespace cs2mesh {

int run_check(const Words& arguments) {
  CLI::App app("closed? manifold? self-intersecting? where? Status 4 if anything is wrong",
               "cs2mesh check");
  CommonOptions common;
  std::string path;
  bool no_intersections = false;
  CheckOptions options;
  app.add_option("mesh", path, "a mesh: .obj .ply .stl .glb .gltf .off")
      ->required()
      ->type_name("MESH");
  app.add_flag("--no-self-intersections", no_intersections, "leave out the slowest check");
  app.add_option("--list", options.max_defects, "defects to list in the JSON, of each kind")
      ->capture_default_str()
      ->type_name("N");
  add_json_option(app, common);
  add_common_options(app, common);
  parse(app, arguments);
  Console console(common);
  Stopwatch watch;
  watch.start("parse");
  const Model model = console.take(read_mesh(path));
  watch.start("check");
  options.self_intersections = !no_intersections;
  options.progress = &console.progress();
  const std::vector<PartReport> parts = check(model, options);
  watch.stop();
  console.stop_if_interrupted();

  if (options.self_intersections) warn_if_unchecked(parts, path, console);
  Json report = {{"input", path}};
  add_check(report, parts);
  report["parts"] = Json::array();
  for (const PartReport& part : parts) report["parts"].push_back(to_json(part));
  add_run(report, watch, console);
  console.say(path + ": " + summary(parts));
  const std::vector<Diagnostic> defects = defect_messages(parts, path);
  console.show(defects);
  if (model.triangle_count() == 0) {
    console.fail(Failure::check_failed, "no triangle in the mesh", {path, 0, 0});
  }
  deliver(report, "", console);
  return exit_status(defects);
}

}  // namespace cs2mesh
