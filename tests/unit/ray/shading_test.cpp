#include "libfield/ray/shading.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/base/color.h"

namespace cs2mesh {
namespace {

TEST(Shading, IsPhongsFormula) {
  const Reflectance r{{0.1, 0.2, 0.3}, {0.5, 0.4, 0.3}, {1, 0.5, 0}, 3.0};
  const Vec3d n{0, 0, 1};
  const Vec3d eye = normalized(Vec3d{1, 0, 2});
  const Vec3d l = normalized(Vec3d{-1, 1, 2});
  const Vec3d light{2, 1, 1};
  const Vec3d mirrored{-l.x, -l.y, l.z};
  const double gloss = std::pow(dot(mirrored, eye), 3.0);
  const Vec3d color = phong(r, n, eye, {{l, light}});
  EXPECT_NEAR(color.x, 0.1 + 2 * (0.5 * l.z + gloss), 1e-14);
  EXPECT_NEAR(color.y, 0.2 + 0.4 * l.z + 0.5 * gloss, 1e-14);
  EXPECT_NEAR(color.z, 0.3 + 0.3 * l.z, 1e-14);
}

TEST(Shading, LightFromBehindAddsNothing) {
  const Reflectance r{{0.1, 0.1, 0.1}, {1, 1, 1}, {1, 1, 1}, 0.0};
  EXPECT_EQ(phong(r, {0, 0, 1}, {0, 0, 1}, {{{0, 0, -1}, {1, 1, 1}}}), r.ambient);
  EXPECT_EQ(phong(r, {0, 0, 1}, {0, 0, 1}, {}), r.ambient);
}

TEST(Shading, LightsAddUp) {
  const Reflectance r{{0, 0, 0}, {0.5, 0.5, 0.5}, {0.2, 0.2, 0.2}, 5.0};
  const Illumination a{normalized(Vec3d{1, 0, 1}), {1, 0, 0}};
  const Illumination b{normalized(Vec3d{0, 1, 3}), {0, 1, 1}};
  const Vec3d n{0, 0, 1};
  EXPECT_EQ(phong(r, n, n, {a, b}), phong(r, n, n, {a}) + phong(r, n, n, {b}));
}

TEST(Shading, MaterialsBlendByShareInLinearLight) {
  Scene scene;
  Material red;
  red.diffuse = {1, 0, 0};
  red.shine = 10;
  Material grey;
  grey.diffuse = {0.5, 0.5, 0.5};
  grey.shine = 30;
  scene.materials = {red, grey};
  const Reflectance mean = blend(scene, {{0, 0.25}, {1, 0.75}});
  EXPECT_NEAR(mean.diffuse.x, 0.25 + 0.75 * srgb_to_linear(0.5), 1e-15);
  EXPECT_NEAR(mean.diffuse.y, 0.75 * srgb_to_linear(0.5), 1e-15);
  EXPECT_NEAR(mean.shine, 25.0, 1e-13);
}

TEST(Shading, ASceneWithoutLightsHasOneAtTheEye) {
  Scene scene;
  const std::vector<Light> lights = lights_of(scene, {1, 2, 3});
  ASSERT_EQ(lights.size(), 1u);
  EXPECT_EQ(lights[0].position, (Vec3d{1, 2, 3}));
  EXPECT_FALSE(lights[0].shadow);
  scene.lights.resize(2);
  EXPECT_EQ(lights_of(scene, {1, 2, 3}).size(), 2u);
}

}  // namespace
}  // namespace cs2mesh
