// A picture of a mesh as it is: flat triangles in a scene's camera and light.
#pragma once

#include "libfield/base/progress.h"
#include "libfield/ray/camera.h"
#include "libfield/ray/image.h"
#include "libfield/scene/scene.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct RenderMeshOptions {
  int width = 0, height = 0;  ///< pixels, 1 .. 65536 each, at most kMostPixels together
  int samples = 1;            ///< samples x samples rays a pixel, 1 .. 16
  Progress* progress = nullptr;
};

/// Diffuse light of the scene's lights on the triangles, without shadows; colours are those of the
/// vertices, white where the mesh has none. Linear RGB. Independent of the number of threads. A
/// size out of range is a ContractViolation. Rows not reached when cancelled stay black.
ColorImage render_mesh(const Model& model, const Scene& scene, const View& view,
                       const RenderMeshOptions& options);

}  // namespace cs2mesh
