// cs2mesh compare: how far is a mesh, from any tool, from the exact surface?
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include "cli/load_scene.h"
#include "cli/mesh_parts.h"
#include "cli/mesh_report.h"
#include "cli/output_files.h"
#include "cli/verbs.h"
#include "polygonize/mesh_file.h"
#include "polygonize/metrology.h"

namespace cs2mesh {
namespace {

struct Request {
  SceneOptions input;
  CommonOptions common;
  std::string mesh, report;
  std::optional<Length> tolerance;
  MeasureOptions measure;
  bool whole = false;
};

Request parse_request(const Words& arguments) {
  Request request;
  request.measure.samples = 100000;
  request.measure.certified_rays = 1000;
  CLI::App app("distance between a mesh and the exact surface, both ways; largest, RMS, 99.9 %",
               "cs2mesh compare");
  add_bounded_scene_options(app, request.input);
  app.add_option("mesh", request.mesh, "a mesh from any tool: .obj .ply .stl .glb .gltf .off")
      ->required()
      ->type_name("MESH");
  app.add_option("--samples", request.measure.samples, "points to measure at, each way")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e9))
      ->type_name("N");
  app.add_option("--rays", request.measure.certified_rays,
                 "random lines whose crossings with the surface are found without a gap")
      ->capture_default_str()
      ->type_name("N");
  add_length_option(app, "--tolerance", request.tolerance, "status 5 if the mesh is farther off");
  app.add_flag(
      "--whole", request.whole,
      "measure all parts as one surface, even where the mesh names them as the scene does");
  app.add_option("--report", request.report, "write the JSON to this file too")->type_name("FILE");
  add_json_option(app, request.common);
  add_common_options(app, request.common);
  parse(app, arguments);
  return request;
}

/// A mesh and the surfaces that it should lie on.
struct Pairing {
  std::string name;
  TriangleMesh mesh;
  std::vector<const ImplicitSurface*> surfaces;
};

TriangleMesh joined(const Model& model) {
  TriangleMesh all;
  for (const MeshPart& part : model.parts) {
    const auto first = static_cast<TriangleMesh::Index>(all.positions.size());
    all.positions.insert(all.positions.end(), part.mesh.positions.begin(),
                         part.mesh.positions.end());
    for (auto triangle : part.mesh.triangles) {
      for (TriangleMesh::Index& corner : triangle) corner += first;
      all.triangles.push_back(triangle);
    }
  }
  return all;
}

/// Part by part if the mesh has the scene's parts by name, else everything at once.
std::vector<Pairing> pair_up(const CompiledScene& compiled, Model model, bool whole) {
  std::vector<Pairing> pairs;
  const bool same_number = model.parts.size() == compiled.parts.size();
  for (const Part& part : compiled.parts) {
    const auto twin = std::find_if(model.parts.begin(), model.parts.end(),
                                   [&](const MeshPart& mesh) { return mesh.name == part.name; });
    if (whole || !same_number || twin == model.parts.end()) {
      pairs.assign(1, {"", joined(model), {}});
      for (const Part& all : compiled.parts) pairs[0].surfaces.push_back(all.surface.get());
      return pairs;
    }
    pairs.push_back({part.name, twin->mesh, {part.surface.get()}});
  }
  return pairs;
}

/// The worst of two parts, mean squares weighted by samples.
MeasuredError worse(const MeasuredError& a, const MeasuredError& b) {
  MeasuredError both = a;
  if (b.mesh_to_surface_max > a.mesh_to_surface_max) {
    both.mesh_to_surface_max = b.mesh_to_surface_max;
    both.mesh_to_surface_at = b.mesh_to_surface_at;
  }
  if (b.surface_to_mesh_max > a.surface_to_mesh_max) {
    both.surface_to_mesh_max = b.surface_to_mesh_max;
    both.surface_to_mesh_at = b.surface_to_mesh_at;
  }
  if (b.normal_deg_max > a.normal_deg_max) {
    both.normal_deg_max = b.normal_deg_max;
    both.normal_deg_at = b.normal_deg_at;
  }
  const auto in_a = static_cast<double>(a.mesh_samples + a.surface_samples);
  const auto in_b = static_cast<double>(b.mesh_samples + b.surface_samples);
  const double count = std::max(1.0, in_a + in_b);
  both.rms = std::sqrt((in_a * a.rms * a.rms + in_b * b.rms * b.rms) / count);
  // An upper bound: the share of samples beyond the larger of the two is at most 0.1 % in each.
  both.p999 = std::max(a.p999, b.p999);
  both.mesh_samples += b.mesh_samples;
  both.surface_samples += b.surface_samples;
  both.ray_samples += b.ray_samples;
  both.uncertain_rays += b.uncertain_rays;
  return both;
}

void say(const MeasuredError& error, double diagonal, Console& console) {
  char text[320];
  std::snprintf(text, sizeof text,
                "mesh to surface %.3g, surface to mesh %.3g (%.2g %% of the diagonal), RMS %.3g, "
                "99.9 %% within %.3g, normals within %.3g degrees",
                error.mesh_to_surface_max, error.surface_to_mesh_max, 100 * error.max() / diagonal,
                error.rms, error.p999, error.normal_deg_max);
  console.say(text);
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
  Model model = console.take(read_mesh(request.mesh));
  Json report = {{"input", request.input.path},
                 {"mesh", request.mesh},
                 {"vertices", model.vertex_count()},
                 {"triangles", model.triangle_count()}};

  watch.start("measure");
  request.measure.progress = &console.progress();
  const std::vector<Pairing> pairs = pair_up(compiled, std::move(model), request.whole);
  request.measure.samples /= pairs.size();
  MeasuredError all;
  Json parts = Json::array();
  for (const Pairing& pair : pairs) {
    const MeasuredError error = measure(pair.surfaces, pair.mesh, request.measure);
    console.stop_if_interrupted();
    all = &pair == pairs.data() ? error : worse(all, error);
    if (!pair.name.empty()) parts.push_back({{"name", pair.name}, {"error", to_json(error)}});
  }
  watch.stop();

  const double diagonal = compiled.extent.diagonal();
  report["error"] = to_json(all);
  if (!parts.empty()) report["parts"] = std::move(parts);
  report["diagonal"] = diagonal;
  add_run(report, watch, console);
  say(all, diagonal, console);
  deliver(report, request.report, console);
  if (request.tolerance && !(all.max() <= request.tolerance->absolute(diagonal))) {
    console.fail(Failure::tolerance, "the mesh is farther from the surface than the tolerance",
                 {request.mesh, 0, 0});
  }
  return kDone;
}

}  // namespace cs2mesh
