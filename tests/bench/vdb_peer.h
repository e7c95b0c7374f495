// OpenVDB's volumeToMesh of a narrow band of samples as a peer in benchmarks: what a user of
// OpenVDB would write, without a step back to the exact surface.
#pragma once

#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh::bench {

/// Voxels of side `cell`, adaptivity 0; quadrilaterals are cut in two.
TriangleMesh vdb_level_set_mesh(const ImplicitSurface& surface, double cell);

}  // namespace cs2mesh::bench
