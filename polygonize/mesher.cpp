#include "polygonize/mesher.h"

#include <algorithm>
#include <array>

#include "polygonize/adaptive_mesher.h"
#include "polygonize/tolerance.h"

namespace cs2mesh {
namespace {

Result<MesherResult> mesh_by_octree(const ImplicitSurface& surface, const MesherRequest& request) {
  return mesh_adaptive(surface, request);
}

constexpr std::array<Mesher, 2> kMeshers{{
    {"adaptive", "cells that follow the surface, as few triangles as the tolerance allows",
     mesh_by_octree},
    {"lattice", "cells of one size, refined where the mesh is too far; measured both ways",
     mesh_by_lattice},
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
