// The OpenVDB mesher: a narrow-band level set of signed first-order distances F / |grad F|, meshed
// by openvdb::tools::volumeToMesh with larger cells where the surface is flat, its vertices then
// moved to the surface proper.
#pragma once

#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/lattice_mesher.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Meshes {F = 0}; triangles are counter-clockwise seen from {F < 0}. Vertices are on the surface
/// to about 1e-4 of a voxel or better. The same mesh, to the bit, for any number of threads.
///
/// volumeToMesh does not promise a manifold. The mesh is checked; where it fails, it is made anew
/// with voxels of one size; where that fails too, Failure::check_failed. So a mesh that is returned
/// is closed, oriented and 2-manifold and, in a build that can tell, free of self-intersections.
///
/// options.cell is the side of a voxel. Requires (ContractViolation): cell > 0, finite or empty
/// bounds. Errors besides: Failure::limit, Failure::interrupted. An empty mesh if no voxel is
/// inside. Not promised: that features smaller than a voxel are seen; creases are cut off.
Result<TriangleMesh> mesh_vdb(const ImplicitSurface& surface, const LatticeOptions& options,
                              LatticeStatistics* statistics = nullptr);

}  // namespace cs2mesh
