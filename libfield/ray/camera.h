// From places in the picture to rays.
#pragma once

#include "libfield/base/aabb.h"
#include "libfield/ray/ray.h"
#include "libfield/scene/scene.h"

namespace cs2mesh {

/// A pinhole or an orthographic camera. The picture is the rectangle
///   eye + forward + x right + y up,  -half_width <= x <= half_width, |y| <= half_height
/// for a pinhole (so that the half sizes are tangents of half the fields of view), and
///   eye + x right + y up
/// for orthographic rays, which all go along `forward`. forward, right, up are orthonormal.
struct View {
  Vec3d eye;
  Vec3d forward{0, 1, 0};
  Vec3d right{1, 0, 0};
  Vec3d up{0, 0, 1};
  double half_width = 1.0;
  double half_height = 1.0;
  bool orthographic = false;

  /// The ray through the place (x, y) of the picture, (0, 0) its top left corner, (1, 1) its bottom
  /// right one. The centre of pixel (i, j) of w x h is ((i + 0.5) / w, (j + 0.5) / h).
  Ray ray(double x, double y) const;
};

/// The view that the scene's camera has: the picture spans fov_horizontal by fov_vertical degrees,
/// so that pixels are square only if the frame's size fits. Where the scene sets no eye: a
/// width x height picture of square pixels, its shorter side 40 degrees, that the box `extent` just
/// fills, seen slantwise from above (`up` is above). An `up` along the line of sight, or of length
/// 0, is replaced by the coordinate axis farthest from that line; an eye at look_at looks at the
/// centre of the extent.
View make_view(const Camera& camera, const Aabb& extent, int width, int height);

/// Parallel rays along `direction` (any length but 0) whose width x height picture of square pixels
/// shows all of the sphere around `extent`, which is not empty and finite. Rays start before it.
View orthographic_view(const Vec3d& direction, const Vec3d& up, const Aabb& extent, int width,
                       int height);

}  // namespace cs2mesh
