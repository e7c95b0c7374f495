#include "polygonize/mesher.h"

#include <algorithm>
#include <array>

#include "polygonize/dual_mesher.h"
#include "polygonize/tolerance.h"
#include "polygonize/vdb_mesher.h"

namespace cs2mesh {
namespace {

Result<MesherResult> mesh_on_cells(const ImplicitSurface& surface, const MesherRequest& request,
                                   ToleranceOptions options) {
  options.max_nodes = request.max_nodes;
  options.max_triangles = request.max_triangles;
  options.progress = request.progress;
  Result<ToleranceMesh> made = mesh_to_tolerance(surface, request.thinnest_radius, request.creased,
                                                 request.tolerance, options);
  if (!made) return Result<MesherResult>::failure(made.diagnostics());
  MesherResult result;
  result.error = made->error;
  result.cell = made->cell;
  result.reached = made->reached;
  result.values = made->statistics.value_evaluations;
  result.gradients = made->statistics.gradient_evaluations;
  result.mesh = std::move(made->mesh);
  return {std::move(result), made.diagnostics()};
}

Result<MesherResult> mesh_on_lattice(const ImplicitSurface& surface, const MesherRequest& request) {
  return mesh_on_cells(surface, request, {});
}

Result<MesherResult> mesh_by_dual(const ImplicitSurface& surface, const MesherRequest& request) {
  ToleranceOptions options;
  options.mesh_cells = mesh_dual;
  options.follows_creases = true;
  return mesh_on_cells(surface, request, options);
}

Result<MesherResult> mesh_by_vdb(const ImplicitSurface& surface, const MesherRequest& request) {
  ToleranceOptions options;
  options.mesh_cells = mesh_vdb;
  return mesh_on_cells(surface, request, options);
}

constexpr std::array<Mesher, 3> kMeshers{{
    {"lattice", "cells of one size, refined where the mesh is too far; measured both ways",
     mesh_on_lattice},
    {"dual", "a vertex in each cell, on creases where there are any; refined and measured likewise",
     mesh_by_dual},
    {"vdb",
     "an OpenVDB level set, with larger cells where it is flat; refined and measured likewise",
     mesh_by_vdb},
}};

}  // namespace

std::span<const Mesher> meshers() {
  return kMeshers;
}

const Mesher* find_mesher(std::string_view name) {
  const auto found = std::find_if(kMeshers.begin(), kMeshers.end(),
                                  [name](const Mesher& mesher) { return mesher.name == name; });
  return found == kMeshers.end() ? nullptr : &*found;
}

}  // namespace cs2mesh
