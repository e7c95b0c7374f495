// Light reflected at a point of the surface: the Phong model of thesis 4.2.5.
//
//   I = a + sum over lights of  v i L ( d (n.l) + s (r.e)^m )
//
// n normal, l towards the light, e towards the eye, r = 2 (n.l) n - l the reflected light, L and i
// colour and intensity of the light, v = 1 where it is seen and 0 in its shadow; a, d, s, m the
// ambient, diffuse and specular colours and the shine of the surface. Where materials meet they are
// the means of those of the materials, weighted by their shares (thesis 4.12). All colours of a
// scene are sRGB-coded; everything here is reckoned in linear light, and images are coded when they
// are written.
#pragma once

#include <vector>

#include "libfield/field/compile.h"
#include "libfield/scene/scene.h"

namespace cs2mesh {

/// The colour in linear light.
Vec3d linear_color(const Color& color);

/// What Phong's model knows of a surface at a point, in linear light.
struct Reflectance {
  Vec3d ambient;
  Vec3d diffuse;
  Vec3d specular;
  double shine = 1.0;
};

/// A light as seen from a point.
struct Illumination {
  Vec3d direction;  ///< unit, towards the light
  Vec3d color;      ///< linear, times the intensity; 0 in shadow
};

/// The mean of the materials that meet, weighted by their shares, which sum to 1. Each index is one
/// of scene.materials.
Reflectance blend(const Scene& scene, const std::vector<MaterialShare>& shares);

/// The light that leaves the surface towards `eye`; `normal` and `eye` are unit vectors. Lights
/// behind the surface (n.l <= 0) add nothing. Not limited to 0..1.
Vec3d phong(const Reflectance& reflectance, const Vec3d& normal, const Vec3d& eye,
            const std::vector<Illumination>& lights);

/// The lights of the scene; where it has none, a white one at the eye without shadow.
std::vector<Light> lights_of(const Scene& scene, const Vec3d& eye);

}  // namespace cs2mesh
