// cs2mesh info: what a scene holds.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/load_scene.h"
#include "cli/mesh_report.h"
#include "cli/verbs.h"

namespace cs2mesh {
namespace {

Json element_counts(const Scene& scene) {
  std::map<std::string, int> kinds;
  std::map<std::string, int> kernels;
  int soft = 0;
  for (const Element& element : scene.elements) {
    ++kinds[std::string(name_of(element.kind))];
    if (!scene.soft || !is_soft(scene, element)) continue;
    ++soft;
    ++kernels[std::string(name_of(kernel_of(scene, element)))];
  }
  const auto total = static_cast<int>(scene.elements.size());
  return {{"primitives", total},
          {"soft", soft},
          {"hard", total - soft},
          {"kinds", kinds},
          {"kernels", kernels}};
}

Json parts_of(const CompiledScene& compiled) {
  Json parts = Json::array();
  for (const Part& part : compiled.parts) {
    const Aabb box = part.surface->bounds();
    Json json = {{"name", part.name},
                 {"soft", part.soft},
                 {"primitives", part.primitive_count},
                 {"thinnest_radius", part.thinnest_radius},
                 {"bounded", box.empty() || box.finite()}};
    if (box.finite()) json["bounds"] = {{"min", to_json(box.min)}, {"max", to_json(box.max)}};
    parts.push_back(std::move(json));
  }
  return parts;
}

void print(const Json& report) {
  const auto count = [&](const char* name) { return report[name].get<int>(); };
  std::fprintf(stderr,
               "%s: %d primitives (%d soft, %d hard), %d materials, %d objects, %d lights\n",
               report["input"].get<std::string>().c_str(), count("primitives"), count("soft"),
               count("hard"), count("materials"), count("objects"), count("lights"));
  for (const char* table : {"kinds", "kernels"}) {
    std::fprintf(stderr, "%s:", table);
    for (const auto& [name, number] : report[table].items()) {
      std::fprintf(stderr, " %s %d", name.c_str(), number.get<int>());
    }
    std::fprintf(stderr, "\n");
  }
  for (const Json& part : report["parts"]) {
    std::fprintf(stderr, "part %s: %s, %d primitives, thinnest radius %g%s\n",
                 part["name"].get<std::string>().c_str(), part["soft"] ? "soft" : "hard",
                 part["primitives"].get<int>(), part["thinnest_radius"].get<double>(),
                 part["bounded"] ? "" : ", unbounded (a mesh needs --bounds)");
  }
  if (report.contains("extent")) {
    const auto text = [&](const char* name) { return report["extent"][name].dump(); };
    std::fprintf(stderr, "extent: %s to %s, diagonal %g\n", text("min").c_str(),
                 text("max").c_str(), report["extent"]["diagonal"].get<double>());
  }
}

}  // namespace

int run_info(const Words& arguments) {
  CLI::App app("what the scene holds, and what of it a mesh needs", "cs2mesh info");
  CommonOptions common;
  SceneOptions input;
  add_scene_options(app, input);
  add_json_option(app, common);
  add_common_options(app, common);
  parse(app, arguments);
  Console console(common);
  Stopwatch watch;
  const Scene scene = read_scene(input, console, watch);
  watch.start("compile");
  const CompiledScene compiled = console.take(compile(scene));
  watch.stop();

  Json report = {{"input", input.path}};
  report.update(element_counts(scene));
  report["materials"] = scene.materials.size();
  report["objects"] = scene.objects.size();
  report["lights"] = scene.lights.size();
  report["camera"] = {{"width", scene.camera.width},
                      {"height", scene.camera.height},
                      {"given", scene.camera.has_eye}};
  report["parts"] = parts_of(compiled);
  if (compiled.extent.finite()) {
    report["extent"] = {{"min", to_json(compiled.extent.min)},
                        {"max", to_json(compiled.extent.max)},
                        {"diagonal", compiled.extent.diagonal()}};
  }
  add_run(report, watch, console);
  if (!console.json()) print(report);
  deliver(report, "", console);
  return kDone;
}

}  // namespace cs2mesh
