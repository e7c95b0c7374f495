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

void fail_if_off(const MeasuredError& error, double tolerance, const std::string& what,
                 const SourceLocation& where, Console& console) {
  console.stop_if_interrupted();
  if (error.max() <= tolerance) return;
  console.fail(Failure::tolerance,
               what + " is off by " + std::to_string(error.max()) +
                   ", more than the tolerance of " + std::to_string(tolerance) +
                   "; nothing was written",
               where);
}

MeasuredError verify_union(const Model& model, const CompiledScene& exact, double tolerance,
                           Console& console) {
  std::vector<const ImplicitSurface*> surfaces;
  for (const Part& part : exact.parts) surfaces.push_back(part.surface.get());
  const MeasuredError error = measure(surfaces, joined(model), for_parts(surfaces.size(), console));
  fail_if_off(error, tolerance, "the union", exact.parts.front().where, console);
  return error;
}

/// Part by part.
MeasuredError verify_parts(const Model& model, const MeshedScene& meshed,
                           const CompiledScene& exact, double tolerance, Console& console) {
  MeasuredError worst;
  for (std::size_t i = 0; i < model.parts.size(); ++i) {
    const Part& part = exact.parts[meshed.parts_of[i].front()];
    const MeasuredError error = measure(*part.surface, model.parts[i].mesh, for_parts(1, console));
    fail_if_off(error, tolerance, "part '" + part.name + "'", part.where, console);
    if (i == 0 || error.max() > worst.max()) worst = error;
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

MeasuredError verify(const MeshedScene& meshed, const CompiledScene& exact,
                     const VerifyOptions& options, Console& console) {
  MeasuredError worst;
  bool first = true;
  for (const std::string& path : paths_by_rounding(options.outputs)) {
    Model model = meshed.model;
    round_to_format(model, *mesh_format_of(path), options.file);
    const MeasuredError error =
        options.united && exact.parts.size() > 1
            ? verify_union(model, exact, options.tolerance, console)
            : verify_parts(model, meshed, exact, options.tolerance, console);
    if (first || error.max() > worst.max()) worst = error;
    first = false;
  }
  return worst;
}

}  // namespace cs2mesh
