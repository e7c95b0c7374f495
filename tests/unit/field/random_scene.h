// Random small scenes for the laws of fields.
#pragma once

#include <string>

#include "libfield/base/random.h"
#include "libfield/scene/scene.h"

namespace cs2mesh::testing {

inline Vec3d random_point(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach),
          random.uniform(-reach, reach)};
}

inline Primitive random_primitive(Random& random, int kind) {
  const Vec3d a = random_point(random, 1);
  switch (kind % 4) {
    case 0:
      return Point{a};
    case 1:
      return Segment{a, a + random.uniform(0.05, 2) * random.direction()};
    case 2:
      return make_arc(a, random.uniform(0.2, 1.5), random.direction(), random.uniform(0, 360),
                      random.uniform(5, 360));
    default:
      return Triangle{{a, random_point(random, 1), random_point(random, 1)}};
  }
}

struct SceneKind {
  bool profiles = false;
  bool transforms = false;
  bool carving = false;
  bool tapers = false;
};

/// Elements of the Cauchy kernel on every bounded primitive, the Gaussian on points and segments.
inline Scene random_scene(std::uint64_t seed, int elements, SceneKind kind = {}) {
  Random random(seed);
  Scene scene;
  scene.file = "random.art";
  for (int i = 0; i < elements; ++i) {
    Material material;
    material.name = "m" + std::to_string(i);
    material.radius = random.uniform(0.05, 0.4);
    material.blobbiness = -random.uniform(0.5, 12);
    if (kind.carving && i % 3 == 2) material.strength = -0.5;
    if (kind.profiles && i % 2 == 0) {
      StrengthProfile profile;
      profile.along_u = ProfileFunction::sin;
      profile.scale_u = std::floor(random.uniform(1, 8));
      profile.lower = 0.4;
      profile.upper = 0.8;
      material.profiles.push_back(profile);
    }
    Element element;
    element.skeleton = random_primitive(random, i);
    const bool thin = element.skeleton.index() <= 1;
    if (thin && i % 3 == 0) material.kernel = KernelKind::gaussian;
    if (kind.tapers && std::holds_alternative<Segment>(element.skeleton)) {
      Random weights(seed, static_cast<std::uint64_t>(i));
      const auto weight = [&] { return weights.uniform(-0.4, 1.5); };
      element.taper = quadratic_weight(weight(), weight(), weight());
    }
    element.kind = std::holds_alternative<Triangle>(element.skeleton) ? ElementKind::triangle
                                                                      : ElementKind::sphere;
    element.material = i;
    element.where = {scene.file, i + 1, 1};
    if (kind.transforms && i % 2 == 1) {
      element.transform =
          Affine::rotate(random.direction(), random.uniform(0, 360)) *
          Affine::scale({random.uniform(0.3, 2), random.uniform(0.3, 2), -random.uniform(0.3, 2)});
    }
    scene.materials.push_back(material);
    scene.elements.push_back(element);
  }
  return scene;
}

}  // namespace cs2mesh::testing
