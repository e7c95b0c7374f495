#include "libfield/ray/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
constexpr double kFramingAngle = 40.0;  // degrees

double tangent_of_half(double degrees) {
  return std::tan(0.5 * degrees * kRadiansPerDegree);
}

/// Sets the axes from a direction of any length but 0 and a wish for `up`.
void orient(View& view, const Vec3d& direction, const Vec3d& up) {
  view.forward = normalized(direction);
  const double length = norm(up);
  Vec3d right = length > 0.0 ? cross(view.forward, up / length) : Vec3d{};
  // 1e-6: an angle too small to be meant, large enough for the cross product to have digits.
  if (!(norm(right) > 1e-6)) {
    const Vec3d& f = view.forward;
    Vec3d axis{0, 0, 1};
    if (std::abs(f.y) < std::abs(f.z)) axis = {0, 1, 0};
    if (std::abs(f.x) < std::min(std::abs(f.y), std::abs(f.z))) axis = {1, 0, 0};
    right = cross(f, axis);
  }
  view.right = normalized(right);
  view.up = cross(view.right, view.forward);
}

/// Half sizes of a picture of square pixels whose shorter side is 2 `shorter`.
void set_square_pixels(View& view, double shorter, int width, int height) {
  const double least = std::min(width, height);
  view.half_width = shorter * width / least;
  view.half_height = shorter * height / least;
}

View frame(const Vec3d& wished_up, const Aabb& extent, int width, int height) {
  const bool known = !extent.empty() && extent.finite() && extent.diagonal() > 0.0;
  const Aabb box = known ? extent : Aabb{{-1, -1, -1}, {1, 1, 1}};

  // Slantwise from above in a frame whose third axis is `up`.
  const Vec3d up = norm(wished_up) > 0.0 ? normalized(wished_up) : Vec3d{0, 0, 1};
  View axes;
  orient(axes, up, std::abs(up.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1});
  const Vec3d from = normalized(0.5 * axes.right - 0.75 * axes.up + 0.45 * up);

  View view;
  orient(view, -from, up);
  set_square_pixels(view, tangent_of_half(kFramingAngle), width, height);

  // As near as lets every corner of the box keep this distance from the border.
  constexpr double kMargin = 0.95;
  double distance = 0.6 * box.diagonal();
  for (int i = 0; i < 8; ++i) {
    const Vec3d d = box.corner(i) - box.center();
    const double sideways = std::max(std::abs(dot(d, view.right)) / view.half_width,
                                     std::abs(dot(d, view.up)) / view.half_height);
    distance = std::max(distance, sideways / kMargin - dot(d, view.forward));
  }
  view.eye = box.center() + distance * from;
  return view;
}

}  // namespace

Ray View::ray(double x, double y) const {
  const Vec3d offset =
      ((2.0 * x - 1.0) * half_width) * right + ((1.0 - 2.0 * y) * half_height) * up;
  if (orthographic) return {eye + offset, forward};
  return {eye, normalized(forward + offset)};
}

View make_view(const Camera& camera, const Aabb& extent, int width, int height) {
  require(width > 0 && height > 0, "a picture has pixels");
  if (!camera.has_eye) return frame(camera.up, extent, width, height);
  View view;
  view.eye = camera.eye;
  Vec3d direction = camera.look_at - camera.eye;
  if (!(norm(direction) > 0.0) && !extent.empty() && extent.finite()) {
    direction = extent.center() - camera.eye;
  }
  if (!(norm(direction) > 0.0)) direction = {0, 0, -1};
  orient(view, direction, camera.up);
  view.half_width = tangent_of_half(camera.fov_horizontal);
  view.half_height = tangent_of_half(camera.fov_vertical);
  return view;
}

View orthographic_view(const Vec3d& direction, const Vec3d& up, const Aabb& extent, int width,
                       int height) {
  require(width > 0 && height > 0, "a picture has pixels");
  require(norm(direction) > 0.0, "a direction is not 0");
  require(!extent.empty() && extent.finite(), "an orthographic view needs an extent");
  View view;
  view.orthographic = true;
  orient(view, direction, up);
  const double radius = extent.diagonal() > 0.0 ? 0.5 * extent.diagonal() : 1.0;
  view.eye = extent.center() - 1.5 * radius * view.forward;
  set_square_pixels(view, radius, width, height);
  return view;
}

}  // namespace cs2mesh
