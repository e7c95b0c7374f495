// A mesh and its surface brought within a distance of each other, as seen from both sides.
#pragma once

#include <cstddef>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/refine.h"
#include "polygonize/shell_probe.h"
#include "polygonize/surface_watch.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct BothWaysOptions {
  double enough = 0.0;  ///< the distance, scene units, > 0
  /// Triangles smaller than this are looked at in more places, and if it is not 0 all are that lean
  /// away from the surface, as across a crease; scene units.
  double small = 0.0;
  std::size_t surface_samples = 100'000;  ///< of SurfaceWatch
  std::size_t max_triangles = 50'000'000;
  Progress* progress = nullptr;  ///< cancelled: what is done so far stays
  /// Whether what is near is made of fewer and better triangles, where that goes (improve.h).
  bool improve = false;
};

/// Refines meshes of one surface.
class BothWays {
 public:
  /// `surface` outlives this and has finite bounds.
  BothWays(const ImplicitSurface& surface, const BothWaysOptions& options);

  /// Some points of the surface.
  std::vector<Vec3d> on_surface() const { return watch_.some(); }

  /// Refines the mesh where it is too far from the surface, improves it if asked to, and joins what
  /// there is of the surface too far from the mesh, as long as that helps and makes no triangles
  /// cross. Returns how far the surface is from the mesh; infinity, without a look, if the mesh
  /// cannot be brought near the surface. The mesh stays closed, oriented and 2-manifold.
  double run(TriangleMesh& mesh);

 private:
  using Index = TriangleMesh::Index;
  void improve_shapes(TriangleMesh& mesh);
  bool bring_near(TriangleMesh& mesh, Index first_new);
  bool join(TriangleMesh& mesh, std::vector<LostPoint> lost);
  SurfaceWatch::Look look_again(const ClosestPoint& tree, const SurfaceWatch::Look& last) const;

  const ImplicitSurface& surface_;
  SurfaceWatch watch_;
  bool improve_;
  ShellProbeOptions probe_;
  RefineOptions refinement_;
  std::vector<LostPoint> far_;  ///< what the last refinement could not bring near
};

}  // namespace cs2mesh
