// cs2mesh compare: how far is a mesh, from any tool, from the exact surface?
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/load_scene.h"
#include "cli/mesh_parts.h"
#include "cli/mesh_report.h"
#include "cli/output_files.h"
#include "cli/verbs.h"
#include "polygonize/compare.h"
#include "polygonize/mesh_file.h"

namespace cs2mesh {
namespace {

struct Request {
  SceneOptions input;
  CommonOptions common;
  std::string mesh, report;
  std::optional<Length> tolerance;
  CompareOptions compare;
  bool no_silhouette = false;
};

Request parse_request(const Words& arguments) {
  Request request;
  CLI::App app("distance between a mesh and the exact surface, both ways; largest, RMS, 99.9 %",
               "cs2mesh compare");
  add_bounded_scene_options(app, request.input);
  app.add_option("mesh", request.mesh, "a mesh from any tool: .obj .ply .stl .glb .gltf .off")
      ->required()
      ->type_name("MESH");
  app.add_option("--samples", request.compare.samples, "points to measure at, each way")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e9))
      ->type_name("N");
  app.add_option("--rays", request.compare.certified_rays,
                 "random lines whose crossings with the surface are found without a gap")
      ->capture_default_str()
      ->type_name("N");
  add_length_option(app, "--tolerance", request.tolerance, "status 5 if the mesh is farther off");
  app.add_flag("--no-silhouette", request.no_silhouette,
               "leave out the difference of the silhouettes in the scene's camera");
  app.add_option("--report", request.report, "write the JSON to this file too")->type_name("FILE");
  add_json_option(app, request.common);
  add_common_options(app, request.common);
  parse(app, arguments);
  return request;
}

void say(const CompareReport& compared, double diagonal, Console& console) {
  const MeasuredError& error = compared.total;
  char text[320];
  std::snprintf(text, sizeof text,
                "mesh to surface %.3g, surface to mesh %.3g (%.2g %% of the diagonal), RMS %.3g, "
                "99.9 %% within %.3g, normals within %.3g degrees",
                error.mesh_to_surface_max, error.surface_to_mesh_max, 100 * error.max() / diagonal,
                error.rms, error.p999, error.normal_deg_max);
  console.say(text);
  if (compared.silhouette_pixels > 0) {
    std::snprintf(text, sizeof text, "silhouettes differ in %.3g %% of their pixels",
                  100 * compared.silhouette_xor);
    console.say(text);
  }
}

Json to_json(const CompareReport& compared) {
  Json error = to_json(compared.total);
  if (compared.silhouette_pixels > 0) error["silhouette_xor"] = compared.silhouette_xor;
  return error;
}

}  // namespace

int run_compare(const Words& arguments) {
  Request request = parse_request(arguments);
  Console console(request.common);
  if (!request.report.empty()) console.take(OutputFiles::can_write(request.report));
  Stopwatch watch;
  const Scene scene = read_scene(request.input, console, watch);
  const CompiledScene compiled = bounded_parts(scene, console, watch);
  watch.start("parse");
  const Model model = console.take(read_mesh(request.mesh));
  Json report = {{"input", request.input.path},
                 {"mesh", request.mesh},
                 {"vertices", model.vertex_count()},
                 {"triangles", model.triangle_count()}};

  watch.start("measure");
  request.compare.progress = &console.progress();
  request.compare.silhouette = !request.no_silhouette;
  const CompareReport compared = console.take(compare(compiled, scene, model, request.compare));
  watch.stop();

  const double diagonal = compiled.extent.diagonal();
  report["error"] = to_json(compared);
  report["parts"] = Json::array();
  for (const PartComparison& part : compared.parts) {
    report["parts"].push_back({{"name", part.name}, {"error", to_json(part.error)}});
  }
  report["diagonal"] = diagonal;
  add_run(report, watch, console);
  say(compared, diagonal, console);
  deliver(report, request.report, console);
  if (request.tolerance && !(compared.total.max() <= request.tolerance->absolute(diagonal))) {
    console.fail(Failure::tolerance, "the mesh is farther from the surface than the tolerance",
                 {request.mesh, 0, 0});
  }
  return kDone;
}

}  // namespace cs2mesh
