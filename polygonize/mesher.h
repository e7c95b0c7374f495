// The ways there are of making a mesh of a surface to a tolerance: one table, one signature.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "libfield/base/progress.h"
#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct MesherRequest {
  double tolerance = 0.0;        ///< largest distance, both ways; scene units, > 0
  double thinnest_radius = 0.0;  ///< the smallest radius of the surface's elements, > 0
  bool creased = false;          ///< whether the surface may have creases
  /// Necks, gaps and pieces thinner than this may be lost. The default mesher, where it proves that
  /// there are none, then cuts cells no further than this and the tolerance ask; others do not
  /// heed it. Scene units; 0: nothing may be lost.
  double min_feature = 0.0;
  /// Whether vertices may be off the surface, within the tolerance, where that saves triangles. Of
  /// the meshers below `adaptive` makes use of it.
  bool balance = false;
  std::size_t max_nodes = 400'000'000;     ///< samples held at once
  std::size_t max_triangles = 50'000'000;  ///< beyond either, Failure::limit
  Progress* progress = nullptr;
};

struct MesherResult {
  TriangleMesh mesh;
  double error = 0.0;    ///< estimated distance, scene units
  double cell = 0.0;     ///< side of the smallest cells, scene units
  bool reached = false;  ///< error <= tolerance
  /// With request.min_feature, cells that may hold more than one simple sheet, for all that could
  /// be shown before they were too small to be cut; none where nothing was proven in any case.
  std::optional<std::size_t> unresolved_cells{};
};

struct Mesher {
  std::string_view name;     ///< of --mesher
  std::string_view promise;  ///< a line for people
  /// Meshes {F = 0} of a surface with finite or empty bounds; triangles are counter-clockwise seen
  /// from {F < 0}. Where the tolerance is missed the best mesh comes with a warning of
  /// Failure::tolerance. Errors: Failure::limit, Failure::interrupted. The same mesh, to the bit,
  /// for any number of threads. Each stage reports under its name; who wants evaluations counted
  /// passes a CountedSurface.
  Result<MesherResult> (*mesh)(const ImplicitSurface& surface, const MesherRequest& request);
};

/// All of them, the default first.
std::span<const Mesher> meshers();
/// Null if there is none of that name.
const Mesher* find_mesher(std::string_view name);

}  // namespace cs2mesh
