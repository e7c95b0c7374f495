// A mesh with the topology of its surface brought within a distance of it, as seen from both sides.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// The part of a tolerance that a distance may take which is measured at points.
inline constexpr double kAcceptedPart = 0.97;

struct BringNearOptions {
  double tolerance = 0.0;  ///< the distance, scene units, > 0
  double reach = 0.0;      ///< how far from the surface vertices may come to be; scene units, > 0
  double small = 0.0;      ///< triangles smaller than this are looked at closely; scene units
  std::size_t max_triangles = 50'000'000;
  Progress* progress = nullptr;  ///< cancelled: what is done so far stays
};

struct BroughtNear {
  /// How far mesh and surface are from each other at most, as far as that was looked at: never less
  /// than what triangles are refined to. Infinite if triangles cross, or nothing helped.
  double error = 0.0;
  std::vector<Vec3d> trouble;  ///< where it was hard
  std::size_t jets = 0;        ///< some jets of F that it took
};

/// Refines triangles that are too far from the surface, makes them good (improve.h), parts those
/// that cross and joins those of `on_surface` that the mesh misses, as long as that helps; `mesh`
/// stays closed, oriented and 2-manifold, as it must be. `on_surface` is not part of `mesh`.
///
/// Not promised: that no part of the surface is farther away which none of the points is on, nor
/// what happens to the topology where triangles that cross are taken apart.
BroughtNear bring_near(const ImplicitSurface& surface, TriangleMesh& mesh,
                       std::span<const Vec3d> on_surface, const BringNearOptions& options);

}  // namespace cs2mesh
