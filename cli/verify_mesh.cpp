#include "cli/verify_mesh.h"

#include <algorithm>

namespace cs2mesh {
namespace {

/// Samples each way and part.
constexpr std::size_t kSamples = 100000;
constexpr std::size_t kRays = 2000;

/// Formats that store the same coordinates are looked at once.
enum class Rounding { none, stl, glb };

Rounding rounding_of(MeshFormat format) {
  if (format == MeshFormat::stl) return Rounding::stl;
  return format == MeshFormat::glb ? Rounding::glb : Rounding::none;
}

MeasureOptions for_parts(std::size_t count, Console& console) {
  MeasureOptions options;
  options.samples = kSamples * count;
  options.certified_rays = kRays * count;
  options.progress = &console.progress();
  return options;
}

Measured measure_union(const Model& model, const CompiledScene& exact, Console& console) {
  std::vector<const ImplicitSurface*> surfaces;
  for (const Part& part : exact.parts) surfaces.push_back(part.surface.get());
  return {measure(surfaces, joined(model), for_parts(surfaces.size(), console)), "the union",
          exact.parts.front().where};
}

/// Part by part.
Measured measure_parts(const Model& model, const MeshedScene& meshed, const CompiledScene& exact,
                       Console& console) {
  Measured worst;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const Part& part = exact.parts[meshed.parts_of[i].front()];
    Measured measured{measure(*part.surface, model.parts[i].mesh, for_parts(1, console)),
                      "part '" + part.name + "'", part.where};
    console.stop_if_interrupted();
    if (i == 0 || measured.error.max() > worst.error.max()) worst = std::move(measured);
  }
  return worst;
}

}  // namespace

std::vector<std::string> paths_by_rounding(const std::vector<std::string>& paths) {
  std::vector<Rounding> seen;
  std::vector<std::string> first;
  for (const std::string& path : paths) {
    const Rounding rounding = rounding_of(*mesh_format_of(path));
    if (std::find(seen.begin(), seen.end(), rounding) != seen.end()) continue;
    seen.push_back(rounding);
    first.push_back(path);
  }
  return first;
}

Measured measure_outputs(const MeshedScene& meshed, const CompiledScene& exact,
                         const OutputRounding& rounding, bool united, Console& console) {
  Measured worst;
  bool first = true;
  for (const std::string& path : paths_by_rounding(rounding.outputs)) {
    Model model = meshed.model;
    round_to_format(model, *mesh_format_of(path), rounding.file);
    Measured measured = united && exact.parts.size() > 1
                            ? measure_union(model, exact, console)
                            : measure_parts(model, meshed, exact, console);
    console.stop_if_interrupted();
    if (first || measured.error.max() > worst.error.max()) worst = std::move(measured);
    first = false;
  }
  return worst;
}

}  // namespace cs2mesh
