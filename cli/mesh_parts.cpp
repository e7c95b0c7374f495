#include "cli/mesh_parts.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "polygonize/attributes.h"
#include "polygonize/part_request.h"
#include "polygonize/source_patches.h"
#include "polygonize/tolerance.h"

namespace cs2mesh {
namespace {

constexpr double kDefaultTolerance = 0.001;  // of the diagonal

TriangleMesh mesh_with_cell(const Part& part, double cell, PartLog& log, Console& console) {
  LatticeOptions options;
  options.cell = cell;
  options.progress = &console.progress();
  TriangleMesh mesh = console.take(mesh_lattice(*part.surface, options));
  log.cell = cell;
  log.error = GradientEstimate().largest_distance(*part.surface, mesh);
  return mesh;
}

TriangleMesh mesh_within_tolerance(const Part& part, const Fineness& fineness, PartLog& log,
                                   Console& console) {
  const double tolerance = fineness.tolerance;
  MesherResult result = console.take(mesh_part(part, fineness, console));
  if (!result.reached) {
    // Infinite where triangles cross or nothing brings them near.
    const std::string what = std::isfinite(result.error)
                                 ? "is off by " + std::to_string(result.error) +
                                       ", more than the tolerance of " + std::to_string(tolerance)
                                 : "could not be meshed within the tolerance of " +
                                       std::to_string(tolerance) + " without triangles that cross";
    console.fail(Failure::tolerance,
                 "part '" + part.name + "' " + what +
                     "; nothing was written (--cell meshes without that promise)",
                 part.where);
  }
  log.cell = result.cell;
  log.error = result.error;
  log.unresolved_cells = result.unresolved_cells;
  return std::move(result.mesh);
}

}  // namespace

Fineness fineness_of(const MeshRequest& request, const Scene& scene,
                     const CompiledScene& compiled) {
  const double diagonal = compiled.extent.diagonal();
  Fineness fineness;
  fineness.balance = request.balance;
  fineness.mesher = find_mesher(request.mesher);
  fineness.tolerance = request.tolerance      ? request.tolerance->absolute(diagonal)
                       : scene.mesh.tolerance ? *scene.mesh.tolerance
                                              : kDefaultTolerance * diagonal;
  if (request.min_feature) fineness.min_feature = request.min_feature->absolute(diagonal);
  // A tolerance or a mesher on the command line wins over the scene's cell, and so do options that
  // need a tolerance.
  if (request.cell) {
    fineness.cell = request.cell->absolute(diagonal);
  } else if (scene.mesh.cell && !request.needs_tolerance() &&
             fineness.mesher == &meshers().front()) {
    fineness.cell = *scene.mesh.cell;
  }
  return fineness;
}

Result<MesherResult> mesh_part(const Part& part, const Fineness& fineness, Console& console) {
  MesherRequest request = request_for(part, fineness.tolerance, &console.progress());
  request.min_feature = fineness.min_feature;
  request.balance = fineness.balance;
  return fineness.mesher->mesh(*part.surface, request);
}

MeshedScene mesh_parts(const CompiledScene& compiled, const Scene& scene, const Fineness& fineness,
                       Console& console) {
  MeshedScene meshed;
  for (std::size_t i = 0; i < compiled.parts.size(); ++i) {
    const Part& part = compiled.parts[i];
    PartLog log;
    log.name = part.name;
    TriangleMesh mesh = fineness.cell > 0 ? mesh_with_cell(part, fineness.cell, log, console)
                                          : mesh_within_tolerance(part, fineness, log, console);
    console.stop_if_interrupted();
    if (mesh.empty()) {
      console.show({{Severity::warning, Failure::none, part.where,
                     "part '" + part.name + "' has no surface that the grid can see"}});
      continue;
    }
    meshed.model.parts.push_back({part.name, std::move(mesh)});
    meshed.log.push_back(std::move(log));
    meshed.parts_of.push_back({i});
  }
  if (meshed.model.parts.empty()) {
    console.fail(Failure::bad_input, "the scene has no surface, expected a field that reaches 1",
                 {scene.file, 0, 0});
  }
  return meshed;
}

void add_attributes(MeshedScene& meshed, const CompiledScene& compiled, const Scene& scene,
                    const MeshRequest& request) {
  const auto add = [&](TriangleMesh& mesh, std::size_t index) {
    const Part& part = compiled.parts[index];
    if (request.wants("normal")) add_normals(mesh, *part.surface);
    if (request.wants("color")) add_colors(mesh, *part.materials, scene.materials);
  };
  for (std::size_t i = 0; i < meshed.model.parts.size(); ++i) {
    MeshPart& part = meshed.model.parts[i];
    if (part.sources.empty()) {
      add(part.mesh, meshed.parts_of[i].front());
      continue;
    }
    std::vector<SourcePatch> patches = split_by_source(part);
    for (SourcePatch& patch : patches) add(patch.mesh, meshed.parts_of[i][patch.source]);
    take_attributes(part, std::move(patches));
  }
}

std::vector<PartLog> plan_parts(const CompiledScene& compiled, const Fineness& fineness) {
  std::vector<PartLog> plan;
  for (const Part& part : compiled.parts) {
    PartLog log;
    log.name = part.name;
    log.cell = fineness.cell > 0
                   ? fineness.cell
                   : expected_cell(length_scale(part), part.creased, fineness.tolerance);
    plan.push_back(std::move(log));
  }
  return plan;
}

Json to_json(const MeasuredError& error) {
  return {{"mesh_to_surface_max", error.mesh_to_surface_max},
          {"surface_to_mesh_max", error.surface_to_mesh_max},
          {"mesh_to_surface_at", to_json(error.mesh_to_surface_at)},
          {"surface_to_mesh_at", to_json(error.surface_to_mesh_at)},
          {"rms", error.rms},
          {"p999", error.p999},
          {"normal_deg_max", error.normal_deg_max},
          {"samples", error.mesh_samples + error.surface_samples}};
}

}  // namespace cs2mesh
