#include "libfield/ray/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libfield/base/random.h"

namespace cs2mesh {
namespace {

void expect_near(const Vec3d& a, const Vec3d& b, double error = 1e-14) {
  EXPECT_NEAR(a.x, b.x, error);
  EXPECT_NEAR(a.y, b.y, error);
  EXPECT_NEAR(a.z, b.z, error);
}

void expect_orthonormal(const View& view) {
  for (const Vec3d& axis : {view.forward, view.right, view.up}) EXPECT_NEAR(norm(axis), 1.0, 1e-14);
  expect_near(cross(view.right, view.forward), view.up);
}

Camera seahorse_camera() {
  Camera camera;
  camera.eye = {0, 0, 20};
  camera.has_eye = true;
  camera.look_at = {0, 0, 0};
  camera.up = {0, 1, 0};
  camera.fov_horizontal = 90.0;
  camera.fov_vertical = 60.0;
  return camera;
}

TEST(Camera, SpansTheFieldsOfViewWhateverTheFrameSize) {
  const View view = make_view(seahorse_camera(), {}, 320, 512);
  expect_orthonormal(view);
  const Ray center = view.ray(0.5, 0.5);
  expect_near(center.origin, {0, 0, 20});
  expect_near(center.direction, {0, 0, -1});
  // Right is +x, up +y; the borders are at half the angles.
  const double degree = std::acos(-1.0) / 180.0;
  expect_near(view.ray(1.0, 0.5).direction, {std::sin(45 * degree), 0, -std::cos(45 * degree)});
  expect_near(view.ray(0.5, 0.0).direction, {0, std::sin(30 * degree), -std::cos(30 * degree)});
  EXPECT_LT(view.ray(0.0, 0.5).direction.x, 0.0);
  EXPECT_LT(view.ray(0.5, 1.0).direction.y, 0.0);
}

TEST(Camera, ReplacesAnUpThatDoesNotSayWhichWayIsUp) {
  Camera camera = seahorse_camera();
  for (const Vec3d& up : {Vec3d{0, 0, 1}, Vec3d{0, 0, -3}, Vec3d{0, 0, 0}, Vec3d{1e-9, 0, 1}}) {
    camera.up = up;
    const View view = make_view(camera, {}, 10, 10);
    expect_orthonormal(view);
    expect_near(view.forward, {0, 0, -1});
  }
  camera.look_at = camera.eye;
  expect_orthonormal(make_view(camera, {}, 10, 10));
  const View towards = make_view(camera, {{9, 0, 20}, {11, 0, 20}}, 10, 10);
  expect_near(towards.forward, {1, 0, 0});
}

TEST(Camera, FramesTheSceneItselfWhereNoEyeIsSet) {
  const Aabb extent{{-1, 2, 3}, {4, 5, 9}};
  for (const Vec3d& up : {Vec3d{0, 0, 1}, Vec3d{0, 1, 0}, Vec3d{1, 0, 0}, Vec3d{0, 0, 0}}) {
    Camera camera;
    camera.up = up;
    const View view = make_view(camera, extent, 300, 200);
    expect_orthonormal(view);
    EXPECT_NEAR(view.half_height, std::tan(std::acos(-1.0) / 9.0), 1e-14);
    EXPECT_NEAR(view.half_width, 1.5 * view.half_height, 1e-14);
    expect_near(normalized(extent.center() - view.eye), view.forward, 1e-13);
    if (norm(up) > 0.0) {
      EXPECT_GT(dot(view.eye - extent.center(), up), 0.0);
    }
    double fill = 0.0;
    for (int i = 0; i < 8; ++i) {
      const Vec3d d = extent.corner(i) - view.eye;
      const double depth = dot(d, view.forward);
      EXPECT_GT(depth, 0.0);
      fill = std::max(fill, std::abs(dot(d, view.up)) / (view.half_height * depth));
      fill = std::max(fill, std::abs(dot(d, view.right)) / (view.half_width * depth));
    }
    EXPECT_NEAR(fill, 0.95, 0.1);
    EXPECT_LT(fill, 1.0);
  }
  EXPECT_TRUE(is_finite(make_view(Camera{}, Aabb{}, 20, 10).eye));
}

TEST(Camera, OrthographicRaysCoverTheExtentFromBeforeIt) {
  const Aabb extent{{-1, 2, 3}, {4, 5, 9}};
  Random random(1);
  for (int k = 0; k < 20; ++k) {
    const Vec3d direction = random.direction();
    const View view = orthographic_view(5.0 * direction, {0, 0, 1}, extent, 100, 200);
    expect_orthonormal(view);
    expect_near(view.ray(0.3, 0.9).direction, direction);
    for (int i = 0; i < 8; ++i) {
      const Vec3d d = extent.corner(i) - view.eye;
      EXPECT_GT(dot(d, view.forward), 0.0);
      EXPECT_LT(std::abs(dot(d, view.up)), view.half_height);
      EXPECT_LT(std::abs(dot(d, view.right)), view.half_width);
    }
  }
}

}  // namespace
}  // namespace cs2mesh
