// A scene as the language describes it: materials, elements, transforms, a tree of objects, camera,
// lights. A description only: nothing is evaluated here, and it can be printed back.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libfield/base/aabb.h"
#include "libfield/base/affine.h"
#include "libfield/base/diagnostics.h"
#include "libfield/kernel/kind.h"
#include "libfield/primitive/polygon.h"
#include "libfield/primitive/primitive.h"
#include "libfield/primitive/quadric.h"
#include "libfield/profile/profile.h"

namespace cs2mesh {

/// sRGB-coded, nominally 0..1 a channel.
struct Color {
  double r = 0, g = 0, b = 0;
  friend bool operator==(const Color&, const Color&) = default;
};

/// A `surface` of the language: what a skeleton is covered with.
struct Material {
  std::string name;
  SourceLocation where;
  // Light (Phong model, thesis 4.2.5).
  Color diffuse{1, 1, 1};
  Color ambient{0, 0, 0};
  Color specular{0, 0, 0};
  double shine = 1.0;
  // Shape.
  std::optional<KernelKind> kernel;
  std::optional<double> radius;      ///< R > 0, radius in isolation
  std::optional<double> blobbiness;  ///< B < 0
  std::optional<double> width;       ///< s, a or support radius; > 0
  double strength = 1.0;             ///< S; negative carves
  std::vector<StrengthProfile> profiles;
};

/// The command that made an element; soft or hard follows from it, the material and Scene::soft.
enum class ElementKind {
  sphere,
  cylinder,
  arc,
  arch,
  line,
  dot,
  gauss,
  triangle,
  plane,
  cone,
  box,
  polygon,
  quadric
};

/// The word of the language for it.
std::string_view name_of(ElementKind kind);

/// The command an element was written with, where `fragile` has a word of its own for it: a `pipe`
/// is a cylinder, a `torus` the arc of a full circle.
enum class Spelling { plain, pipe, torus };

/// One primitive command, in the coordinates of the object that holds it.
struct Element {
  ElementKind kind = ElementKind::sphere;
  Spelling spelling = Spelling::plain;
  /// Of a cone its axis, of a box the diagonal from the least corner, of a polygon the triangle of
  /// its first, second and last vertex; nothing of a quadric.
  Primitive skeleton;
  int shape = -1;                    ///< index into Scene::polygons or Scene::quadrics
  std::optional<double> own_radius;  ///< > 0; sphere, cylinder, arc, arch have one, cones may be 0
  double apex_radius = 0.0;          ///< of a cone, >= 0; own_radius is that at its base
  /// The weight along a segment of a line or cylinder, inside the convolution integral.
  std::optional<SegmentWeight> taper;
  Affine transform;  ///< applied to this element alone
  int material = 0;  ///< index into Scene::materials
  int object = -1;   ///< index into Scene::objects; -1: outside every object
  SourceLocation where;
};

/// A compound object. Elements and objects below it are moved by `transform`.
struct Object {
  std::string name;
  int parent = -1;  ///< index into Scene::objects, always less than the object's own
  Affine transform;
  /// Set where the object has a `blend` line: its group's name, "" for a group of its own.
  std::optional<std::string> blend;
  SourceLocation where;
};

struct Camera {
  Vec3d eye{0, 0, 0};
  bool has_eye = false;    ///< false: the scene sets none, a renderer frames the scene itself
  Vec3d look_at{0, 0, 0};  ///< vrp
  Vec3d up{0, 0, 1};       ///< vup
  double fov_horizontal = 45.0, fov_vertical = 45.0;  ///< degrees, in (0, 180)
  int width = 128, height = 128;                      ///< pixels
  int samples = 1;                                    ///< `sample n`: up to n x n rays a pixel
};

struct Light {
  Color color{1, 1, 1};
  Vec3d position;
  double intensity = 1.0;
  bool shadow = true;
};

/// `fragile`: kinds of primitives whose own radius yields to the material's.
struct Fragile {
  bool arc = false, arch = false, torus = false, pipe = false, cylinder = false, cone = false,
       sphere = false;
};

/// `mesh` lines: what the command line can also say.
struct MeshSettings {
  std::optional<double> tolerance;  ///< scene units
  std::optional<double> cell;       ///< scene units
  std::optional<Aabb> bounds;
};

struct Scene {
  std::string file;  ///< the file read first
  std::vector<Material> materials;
  std::vector<Element> elements;
  std::vector<Object> objects;
  std::vector<Polygon> polygons;
  std::vector<Quadric> quadrics;
  Camera camera;
  std::vector<Light> lights;
  Color background{0, 0, 0};
  bool soft = true;
  Fragile fragile;
  MeshSettings mesh;
};

/// The map from the coordinates of scene.elements[i] to those of the scene.
Affine world_transform(const Scene& scene, const Element& element);

/// Whether the element contributes to a soft field (art-language 2): always for dot, gauss, line;
/// never for box and quadric; for the others when its material has a blobbiness or a width.
/// Scene::soft is not looked at.
bool is_soft(const Scene& scene, const Element& element);

/// R of the element (art-language 3): its own radius unless `fragile` prefers the material's; of a
/// cone the larger of its radii.
std::optional<double> radius_of(const Scene& scene, const Element& element);

/// The radii of a cone, > 0 for one of them at least: where `fragile` prefers the material's, that
/// is the larger one, and the other in proportion.
struct ConeRadii {
  double base = 0.0, apex = 0.0;
};
ConeRadii cone_radii(const Scene& scene, const Element& element);

/// The kernel of a soft element: the material's, or the default of its command.
KernelKind kernel_of(const Scene& scene, const Element& element);

}  // namespace cs2mesh
