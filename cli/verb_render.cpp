// cs2mesh render: the reference image.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/interrupt.h"
#include "cli/load_scene.h"
#include "cli/output_files.h"
#include "cli/verbs.h"
#include "libfield/ray/pfm.h"
#include "libfield/ray/png.h"
#include "libfield/ray/render.h"
#include "polygonize/mesh_file.h"
#include "polygonize/render_mesh.h"

namespace cs2mesh {
namespace {

struct Request {
  SceneOptions input;
  CommonOptions common;
  std::string picture, depth, normal, cost, mesh;
  std::vector<int> size;
  int samples = 0;  ///< 0: the scene's
};

Request parse_request(const Words& arguments) {
  Request request;
  CLI::App app("ray-trace the reference image: every pixel from the exact surface",
               "cs2mesh render");
  add_bounded_scene_options(app, request.input);
  app.add_option("out", request.picture, "the image, a file in .png")->required()->type_name("OUT");
  app.add_option("--depth", request.depth, "also write the distance from the eye, as .pfm floats")
      ->type_name("FILE");
  app.add_option("--normal", request.normal, "also write the unit normals, as .pfm floats")
      ->type_name("FILE");
  app.add_option("--cost", request.cost, "also write the evaluations a pixel, as .pfm floats")
      ->type_name("FILE");
  app.add_option("--size", request.size, "pixels (default: the scene's framesize, or 128 128)")
      ->type_name("WIDTH HEIGHT")
      ->check(CLI::Range(1, 8192))
      ->expected(2);
  app.add_option("--samples", request.samples,
                 "up to N x N rays a pixel where it needs them (default: the scene's, or 1)")
      ->type_name("N")
      ->check(CLI::Range(1, 16));
  app.add_option("--mesh", request.mesh,
                 "draw this mesh, with flat triangles, in place of the surface")
      ->type_name("MESH");
  add_json_option(app, request.common);
  add_common_options(app, request.common);
  parse(app, arguments);
  return request;
}

std::vector<std::string> outputs_of(const Request& request, Console& console) {
  console.take(OutputFiles::has_extension(request.picture, ".png"));
  std::vector<std::string> outputs = {request.picture};
  for (const std::string& path : {request.depth, request.normal, request.cost}) {
    if (path.empty()) continue;
    console.take(OutputFiles::has_extension(path, ".pfm"));
    outputs.push_back(path);
  }
  for (const std::string& path : outputs) console.take(OutputFiles::can_write(path));
  return outputs;
}

RenderOptions render_options(const Request& request, Console& console) {
  RenderOptions options;
  if (request.size.size() == 2) {
    options.width = request.size[0];
    options.height = request.size[1];
  }
  if (request.samples > 0) options.samples = request.samples;
  options.depth = !request.depth.empty();
  options.normal = !request.normal.empty();
  options.cost = !request.cost.empty();
  options.progress = &console.progress();
  return options;
}

/// The picture of a mesh in the camera that the surface would be seen with.
RenderedImage draw_mesh(const Request& request, const CompiledScene& compiled, const Scene& scene,
                        Console& console) {
  for (const std::string& path : {request.depth, request.normal, request.cost}) {
    if (!path.empty()) console.fail(Failure::bad_input, "not available with --mesh", {path, 0, 0});
  }
  RenderMeshOptions options;
  options.width = request.size.empty() ? scene.camera.width : request.size[0];
  options.height = request.size.empty() ? scene.camera.height : request.size[1];
  if (static_cast<long long>(options.width) * options.height > kMostPixels) {
    console.fail(Failure::limit, "too many pixels in the picture", {request.picture, 0, 0});
  }
  options.samples = std::clamp(request.samples > 0 ? request.samples : scene.camera.samples, 1, 16);
  options.progress = &console.progress();
  const Model model = console.take(read_mesh(request.mesh));
  RenderedImage image;
  image.color =
      render_mesh(model, scene,
                  make_view(scene.camera, compiled.extent, options.width, options.height), options);
  console.stop_if_interrupted();
  return image;
}

void write_images(const Request& request, const RenderedImage& image, Console& console) {
  const WhileWriting guard;
  OutputFiles files;
  const auto write = [&](const std::string& path, const auto& pixels) {
    if (path.empty()) return;
    console.take(files.write(path, [&](const std::string& at) { return write_pfm(at, pixels); }));
  };
  console.take(files.write(request.picture,
                           [&](const std::string& at) { return write_png(at, image.color); }));
  write(request.depth, image.depth);
  write(request.normal, image.normal);
  write(request.cost, image.cost);
  console.take(files.commit());
}

Json to_json(const RenderStatistics& statistics) {
  return {{"hits", statistics.hits},
          {"misses", statistics.misses},
          {"shadow", statistics.shadow_rays},
          {"uncertain", statistics.uncertain}};
}

}  // namespace

int run_render(const Words& arguments) {
  const Request request = parse_request(arguments);
  Console console(request.common);
  const std::vector<std::string> outputs = outputs_of(request, console);
  Stopwatch watch;
  const Scene scene = read_scene(request.input, console, watch);
  // Rays need no bounded surface; bounds cut it off where there are some.
  watch.start("compile");
  CompiledScene compiled = console.take(compile(scene));
  if (scene.mesh.bounds) compiled = console.take(clip_to_bounds(std::move(compiled), scene));
  watch.start("render");
  const RenderedImage image =
      request.mesh.empty() ? console.take(render(compiled, scene, render_options(request, console)))
                           : draw_mesh(request, compiled, scene, console);
  watch.start("export");
  write_images(request, image, console);
  watch.stop();

  Json report = {{"input", request.input.path},
                 {"outputs", outputs},
                 {"width", image.color.width()},
                 {"height", image.color.height()},
                 {"rays", to_json(image.statistics)}};
  const RayCost cost = [&] {
    RayCost sum = image.statistics.hit_cost;
    sum += image.statistics.miss_cost;
    return sum += image.statistics.shadow_cost;
  }();
  report["evaluations"] = {{"gradient", cost.jets}, {"enclosure", cost.bounds}};
  add_run(report, watch, console);
  if (image.statistics.uncertain > 0) {
    console.say("note: " + std::to_string(image.statistics.uncertain) +
                " places along rays could not be decided and count as no surface");
  }
  deliver(report, "", console);
  return kDone;
}

}  // namespace cs2mesh
