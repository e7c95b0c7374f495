#include "libfield/ray/shading.h"

#include <cmath>

#include "libfield/base/color.h"

namespace cs2mesh {
namespace {

Vec3d times(const Vec3d& a, const Vec3d& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

}  // namespace

Vec3d linear_color(const Color& color) {
  return {srgb_to_linear(color.r), srgb_to_linear(color.g), srgb_to_linear(color.b)};
}

Reflectance blend(const Scene& scene, const std::vector<MaterialShare>& shares) {
  Reflectance mean;
  mean.shine = 0.0;
  for (const MaterialShare& part : shares) {
    const Material& material = scene.materials[static_cast<std::size_t>(part.material)];
    mean.ambient += part.share * linear_color(material.ambient);
    mean.diffuse += part.share * linear_color(material.diffuse);
    mean.specular += part.share * linear_color(material.specular);
    mean.shine += part.share * material.shine;
  }
  return mean;
}

Vec3d phong(const Reflectance& reflectance, const Vec3d& normal, const Vec3d& eye,
            const std::vector<Illumination>& lights) {
  Vec3d sum = reflectance.ambient;
  for (const Illumination& light : lights) {
    const double facing = dot(normal, light.direction);
    if (!(facing > 0.0)) continue;
    const Vec3d mirrored = (2.0 * facing) * normal - light.direction;
    const double gloss = dot(mirrored, eye);
    Vec3d share = facing * reflectance.diffuse;
    if (gloss > 0.0) share += std::pow(gloss, reflectance.shine) * reflectance.specular;
    sum += times(light.color, share);
  }
  return sum;
}

std::vector<Light> lights_of(const Scene& scene, const Vec3d& eye) {
  if (!scene.lights.empty()) return scene.lights;
  Light headlight;
  headlight.position = eye;
  headlight.shadow = false;
  return {headlight};
}

}  // namespace cs2mesh
