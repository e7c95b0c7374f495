#include "polygonize/mesher.h"

#include <algorithm>
#include <array>

#include "polygonize/adaptive_mesher.h"
#include "polygonize/dual_mesher.h"
#include "polygonize/tolerance.h"
#include "polygonize/vdb_mesher.h"

namespace cs2mesh {
namespace {

Result<MesherResult> mesh_by_octree(const ImplicitSurface& surface, const MesherRequest& request) {
  return mesh_adaptive(surface, request);
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

constexpr std::array<Mesher, 4> kMeshers{{
    {"adaptive", "cells that follow the surface, as few triangles as the tolerance allows",
     mesh_by_octree},
    {"lattice", "cells of one size, refined where the mesh is too far; measured both ways",
     mesh_by_lattice},
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
