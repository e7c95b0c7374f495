// The reference image of a scene: every pixel from the exact surfaces, no mesh in between.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "libfield/base/progress.h"
#include "libfield/field/compile.h"
#include "libfield/ray/camera.h"
#include "libfield/ray/image.h"
#include "libfield/ray/ray_solver.h"

namespace cs2mesh {

struct RenderOptions {
  std::optional<int> width, height;                  ///< in place of the scene's; 1..65536
  std::optional<int> samples;                        ///< in place of the scene's; 1..16
  std::optional<View> view;                          ///< in place of the scene's camera
  bool depth = false, normal = false, cost = false;  ///< which extra images are wanted
  /// A pixel gets samples x samples rays where a channel (R, G, B, linear light) of its first ray
  /// and that of a neighbour differ by more than this share of their sum.
  std::array<double, 3> contrast{0.25, 0.2, 0.4};
  RaySolverOptions solver;
  Progress* progress = nullptr;
};

struct RenderStatistics {
  std::uint64_t hits = 0, misses = 0;  ///< rays from the eye that meet a surface or none
  std::uint64_t shadow_rays = 0;
  /// Places that no bound could decide, counted as no surface: of rays from the eye, and of shadow
  /// rays, whose accuracy is but 1e-6 of the extent's diagonal.
  std::uint64_t uncertain = 0, shadow_uncertain = 0;
  RayCost hit_cost, miss_cost;  ///< of the rays from the eye, shading left out
  RayCost shadow_cost;
  std::uint64_t tree_bounds = 0;  ///< bounds taken before the first ray (see BoundTree)

  RenderStatistics& operator+=(const RenderStatistics& other);
};

struct RenderedImage {
  ColorImage color;  ///< linear RGB
  /// Distance from the eye along the ray through the pixel's centre (from the plane of the eye for
  /// an orthographic view); infinite where no surface is met. Empty unless wanted, as the next two.
  ScalarImage depth;
  ColorImage normal;  ///< unit, outward (-grad F); 0 where no surface is met
  ScalarImage cost;   ///< evaluations of value and gradient for the ray through the pixel's centre
  RenderStatistics statistics;
};

/// Traces all parts of `compiled`, which `scene` was compiled into. Every pixel has a ray through
/// its centre, from which come depth, normal and cost; pixels of high contrast to a neighbour get a
/// regular grid of samples x samples rays instead for their colour. Shadow rays go to each light
/// that casts shadows. The picture does not depend on the number of threads.
/// Errors: Failure::bad_input for a size or number of samples out of range, Failure::limit for more
/// than kMostPixels, Failure::interrupted when the progress says cancelled.
Result<RenderedImage> render(const CompiledScene& compiled, const Scene& scene,
                             const RenderOptions& options = {});

}  // namespace cs2mesh
