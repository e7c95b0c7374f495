// A mesh, from any tool, against the scene it should show.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libfield/field/compile.h"
#include "polygonize/metrology.h"

namespace cs2mesh {

struct CompareOptions {
  std::size_t samples = 1'000'000;      ///< each way, over all parts; see MeasureOptions
  std::size_t certified_rays = 10'000;  ///< over all parts
  bool mesh_to_surface = true;          ///< false: that way is left out, and is 0
  bool silhouette = true;
  int largest_picture = 256;  ///< the longer side of the silhouette, pixels
  std::uint64_t seed = 1;
  Progress* progress = nullptr;
};

struct PartComparison {
  std::string name;
  MeasuredError error;
};

struct CompareReport {
  /// By name where the mesh has exactly the parts of the scene; else one entry, named "", for the
  /// whole mesh against the outside of all parts together.
  std::vector<PartComparison> parts;
  /// Maxima over the parts (p999 too, which bounds that of all samples), RMS over all samples, sums
  /// of the counts.
  MeasuredError total;
  /// Pixels that only the surface or only the mesh covers, as a share of those that either covers;
  /// in the scene's camera. Pixels where the ray solver is not certain are not counted.
  double silhouette_xor = 0;
  std::size_t silhouette_pixels = 0;  ///< covered by either
  std::size_t uncertain_pixels = 0;
};

/// Measures as measure() does. `compiled` is that of `scene`, with bounds (see clip_to_bounds).
/// Errors: a mesh without triangles (bad_input); stopped by the user (interrupted).
Result<CompareReport> compare(const CompiledScene& compiled, const Scene& scene, const Model& model,
                              const CompareOptions& options = {});

}  // namespace cs2mesh
