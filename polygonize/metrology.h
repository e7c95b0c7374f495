// How far a mesh and an exact surface are apart.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "libfield/base/progress.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct MeasureOptions {
  /// Samples each way, roughly. Mesh to surface: every vertex, edge middle and centroid is one, in
  /// any case; points drawn evenly over the area fill up the number. Surface to mesh: crossings of
  /// the surface with a lattice that is fine enough to give that many.
  std::size_t samples = 0;
  bool at_vertices = true;
  bool mesh_to_surface = true;
  bool surface_to_mesh = true;
  /// Random lines through the bounds whose crossings are added to surface to mesh; found by the
  /// certified solver, they miss no sheet, however thin, that they cross.
  std::size_t certified_rays = 0;
  std::uint64_t seed = 1;
  Progress* progress = nullptr;
};

/// Lengths in scene units. A maximum is infinite where there is a mesh but no surface, or a surface
/// but no mesh.
struct MeasuredError {
  double mesh_to_surface_max = 0;
  double surface_to_mesh_max = 0;
  Vec3d mesh_to_surface_at;  ///< the point of the mesh
  Vec3d surface_to_mesh_at;  ///< the point of the surface
  double rms = 0;            ///< over the samples of both ways
  double p999 = 0;           ///< 99.9 % of the samples of both ways are no farther
  /// Angles between triangle and surface normal (at the foot), at centroids and random points.
  double normal_deg_max = 0;
  double normal_deg_mean = 0;
  Vec3d normal_deg_at;
  std::size_t mesh_samples = 0, surface_samples = 0;
  std::size_t ray_samples = 0;     ///< of surface_samples, from certified rays
  std::size_t uncertain_rays = 0;  ///< places on them that the solver could not decide
  bool complete = true;            ///< false if the user stopped it

  double max() const {
    return mesh_to_surface_max > surface_to_mesh_max ? mesh_to_surface_max : surface_to_mesh_max;
  }
};

/// Measures both ways. Mesh to surface: from each sample along the gradient of F until F changes
/// its sign, so that the distance is to a point that is proven to lie on the surface: an upper
/// bound for the sample, nearly exact where the distance is small against the radius of curvature.
/// Surface to mesh: exact for each sample, to rounding.
///
/// The maxima are over samples: between them the mesh or the surface may be farther. Deterministic
/// for a seed and any number of threads. About two jets a sample mesh to surface, five values and
/// four jets a sample back.
MeasuredError measure(const ImplicitSurface& surface, const TriangleMesh& mesh,
                      const MeasureOptions& options = {});

/// The same against the outside of several surfaces together: a sample of the mesh counts its
/// nearest surface, and surface inside another, or where two lie
/// back to back, is left out. (A mesh of the surfaces one by one and
/// a mesh of their union are both at distance 0.)
MeasuredError measure(std::span<const ImplicitSurface* const> surfaces, const TriangleMesh& mesh,
                      const MeasureOptions& options = {});

}  // namespace cs2mesh
