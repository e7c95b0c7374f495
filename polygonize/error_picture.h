// Pictures of how far a mesh is from its surface, in false colours.
#pragma once

#include "libfield/base/progress.h"
#include "libfield/field/compile.h"
#include "libfield/ray/camera.h"
#include "libfield/ray/image.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// For the ray through each pixel's centre the distance from where it meets the mesh to the surface
/// of that part, as project() finds it, scene units; NaN where it meets none. The parts of `model`
/// are those of `compiled`, in their order (ContractViolation), and may be without triangles.
/// Independent of the number of threads. What is not reached when cancelled is NaN.
ScalarImage error_picture(const Model& model, const CompiledScene& compiled, const View& view,
                          int width, int height, Progress* progress = nullptr);

/// Sets pixels to infinity where `depth` (see RenderedImage) is finite and `errors` is NaN: there
/// is surface and no mesh. Both pictures are of one size (ContractViolation).
void mark_missing_mesh(const ScalarImage& depth, ScalarImage& errors);

/// Linear RGB: dark blue at `low` and below over green to yellow at `high` and above, by the
/// logarithm (the colours of viridis, evenly rising in lightness); NaN pale grey, infinity magenta.
/// 0 < low < high (ContractViolation).
ColorImage false_colors(const ScalarImage& errors, double low, double high);

/// The colours from low at the left to high at the right, a pixel high.
ColorImage false_color_scale(int width);

}  // namespace cs2mesh
