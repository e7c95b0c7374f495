#include "libfield/scene/scene.h"

#include <algorithm>

namespace cs2mesh {

std::string_view name_of(ElementKind kind) {
  constexpr std::array<std::string_view, 13> kNames = {
      "sphere",   "cylinder", "arc",  "arch", "line",    "dot",    "gauss",
      "triangle", "plane",    "cone", "box",  "polygon", "quadric"};
  return kNames[static_cast<std::size_t>(kind)];
}

Affine world_transform(const Scene& scene, const Element& element) {
  Affine map = element.transform;
  for (int i = element.object; i >= 0; i = scene.objects[static_cast<std::size_t>(i)].parent) {
    map = scene.objects[static_cast<std::size_t>(i)].transform * map;
  }
  return map;
}

bool is_soft(const Scene& scene, const Element& element) {
  switch (element.kind) {
    case ElementKind::dot:
    case ElementKind::gauss:
    case ElementKind::line:
      return true;
    case ElementKind::box:
    case ElementKind::quadric:
      return false;
    default:
      break;
  }
  const Material& material = scene.materials[static_cast<std::size_t>(element.material)];
  return material.blobbiness.has_value() || material.width.has_value();
}

std::optional<double> radius_of(const Scene& scene, const Element& element) {
  const Material& material = scene.materials[static_cast<std::size_t>(element.material)];
  if (!element.own_radius) return material.radius;
  bool fragile = false;
  switch (element.kind) {
    case ElementKind::sphere:
      fragile = scene.fragile.sphere;
      break;
    case ElementKind::cylinder:
      fragile = element.spelling == Spelling::pipe ? scene.fragile.pipe : scene.fragile.cylinder;
      break;
    case ElementKind::arc:
      fragile = element.spelling == Spelling::torus ? scene.fragile.torus : scene.fragile.arc;
      break;
    case ElementKind::arch:
      fragile = scene.fragile.arch;
      break;
    case ElementKind::cone:
      fragile = scene.fragile.cone;
      break;
    default:
      break;
  }
  if (fragile && material.radius) return material.radius;
  return std::max(*element.own_radius, element.apex_radius);
}

ConeRadii cone_radii(const Scene& scene, const Element& element) {
  const double base = element.own_radius.value_or(0.0);
  const double scale =
      radius_of(scene, element).value_or(0.0) / std::max(base, element.apex_radius);
  return {scale * base, scale * element.apex_radius};
}

KernelKind kernel_of(const Scene& scene, const Element& element) {
  const Material& material = scene.materials[static_cast<std::size_t>(element.material)];
  if (material.kernel) return *material.kernel;
  switch (element.kind) {
    case ElementKind::dot:
      return KernelKind::quartic;
    case ElementKind::gauss:
    case ElementKind::line:
      return KernelKind::gaussian;
    default:
      return KernelKind::cauchy;
  }
}

}  // namespace cs2mesh
