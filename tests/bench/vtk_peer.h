// VTK's flying edges (marching cubes) over a dense image of samples as a peer in benchmarks.
#pragma once

#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh::bench {

/// Voxels of side `cell`.
TriangleMesh vtk_flying_edges_mesh(const ImplicitSurface& surface, double cell);

}  // namespace cs2mesh::bench
