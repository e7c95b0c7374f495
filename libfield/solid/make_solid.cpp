#include "libfield/solid/make_solid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libfield/solid/combination.h"
#include "libfield/solid/cone_side.h"
#include "libfield/solid/half_space.h"
#include "libfield/solid/offset.h"

namespace cs2mesh {
namespace {

using Surface = std::shared_ptr<const ImplicitSurface>;

/// Where a solid stands: M and, unless it is the identity, its inverse.
struct Placement {
  Affine to_world;
  std::optional<Affine> to_local;
};

/// The half-space dot(q - point, outward) <= 0 of local coordinates; F keeps the local slope 1.
Surface half_space(const Placement& placement, const Vec3d& point, const Vec3d& outward) {
  if (!placement.to_local) return std::make_shared<HalfSpace>(point, outward);
  return std::make_shared<HalfSpace>(placement.to_world(point),
                                     transpose(placement.to_local->linear) * outward);
}

/// A capsule long enough that its caps lie beyond the lids that cut it.
Surface capped_cylinder(const Placement& placement, const Segment& axis, double radius) {
  const Vec3d along = normalized(axis.b - axis.a);
  const Segment longer{axis.a - 2 * radius * along, axis.b + 2 * radius * along};
  return std::make_shared<Combination>(
      CombinationKind::intersection,
      std::vector<Surface>{std::make_shared<Offset>(longer, radius, placement.to_local),
                           half_space(placement, axis.a, -along),
                           half_space(placement, axis.b, along)});
}

/// The full torus cut by the wedge between the end planes of the arc, which both hold its axis.
Surface flat_ended_arc(const Placement& placement, const Arc& arc, double radius) {
  Arc circle = arc;
  circle.sweep = 2 * std::numbers::pi;
  Surface torus = std::make_shared<Offset>(circle, radius, placement.to_local);
  if (arc.sweep >= 2 * std::numbers::pi) return torus;
  const double c = std::cos(0.5 * arc.sweep);
  const double s = std::sin(0.5 * arc.sweep);
  const Surface end = half_space(placement, arc.center, c * arc.ey - s * arc.ex);
  const Surface start = half_space(placement, arc.center, -(c * arc.ey) - s * arc.ex);
  const auto kind =
      arc.sweep <= std::numbers::pi ? CombinationKind::intersection : CombinationKind::union_of;
  const Surface wedge = std::make_shared<Combination>(kind, std::vector<Surface>{end, start});
  return std::make_shared<Combination>(CombinationKind::intersection,
                                       std::vector<Surface>{torus, wedge});
}

/// Between the lids. The capsule is wide enough to decide nowhere on the surface; it bounds what
/// the side and the lids leave open in the eyes of bounds().
Surface capped_cone(const Placement& placement, const Segment& axis, double base, double apex) {
  const Vec3d along = normalized(axis.b - axis.a);
  const double wide = 2 * std::max(base, apex);
  return std::make_shared<Combination>(
      CombinationKind::intersection,
      std::vector<Surface>{std::make_shared<ConeSide>(axis, base, apex, placement.to_local),
                           half_space(placement, axis.a, -along),
                           half_space(placement, axis.b, along),
                           std::make_shared<Offset>(axis, wide, placement.to_local)});
}

/// Six half-spaces, and a ball around them for the sake of bounds().
Surface box(const Placement& placement, const Vec3d& low, const Vec3d& high) {
  std::vector<Surface> parts;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3d outward{};
    outward[axis] = 1;
    parts.push_back(half_space(placement, high, outward));
    parts.push_back(half_space(placement, low, -outward));
  }
  const Point middle{0.5 * low + 0.5 * high};
  parts.push_back(std::make_shared<Offset>(middle, norm(high - low), placement.to_local));
  return std::make_shared<Combination>(CombinationKind::intersection, std::move(parts));
}

/// A cone or a box, which have no single radius.
MadeSolid make_without_radius(const Placement& placement, const Element& element) {
  const auto& segment = std::get<Segment>(element.skeleton);
  MadeSolid made;
  made.creased = true;
  if (element.kind == ElementKind::cone) {
    const double base = element.own_radius.value_or(0.0);
    made.surface = capped_cone(placement, segment, base, element.apex_radius);
    made.radius = 0.5 * std::max(base, element.apex_radius);
  } else {
    made.surface = box(placement, segment.a, segment.b);
    const Vec3d sides = segment.b - segment.a;
    made.radius = 0.5 * std::min({sides.x, sides.y, sides.z});
  }
  if (placement.to_local) made.radius /= stretch_bound(placement.to_local->linear);
  return made;
}

/// Degenerate skeletons are spheres: they have no axis.
bool is_point_like(const Primitive& primitive, double radius) {
  const double extent = std::visit([](const auto& p) { return size(p); }, primitive);
  return extent <= 1e-12 * radius;
}

}  // namespace

Result<MadeSolid> make_solid(const Scene& scene, const Element& element, bool offset) {
  Placement placement{world_transform(scene, element), std::nullopt};
  if (!placement.to_world.is_identity()) placement.to_local = inverse(placement.to_world);
  MadeSolid made;

  if (element.kind == ElementKind::plane && !offset) {
    const auto& plane = std::get<Plane>(element.skeleton);
    made.surface = half_space(placement, plane.point, plane.normal);
    return made;
  }
  if (element.kind == ElementKind::cone || element.kind == ElementKind::box) {
    return make_without_radius(placement, element);
  }
  if (element.kind == ElementKind::triangle && !offset) {
    return error_at(element.where,
                    "a hard triangle has no thickness, expected a surface with 'blobbiness'");
  }
  if (element.taper && !offset) {
    return error_at(element.where, "a hard " + std::string(name_of(element.kind)) +
                                       " has no taper, expected a surface with 'blobbiness'");
  }
  const std::optional<double> radius = radius_of(scene, element);
  if (!radius) {
    return error_at(element.where, "a " + std::string(name_of(element.kind)) +
                                       " needs a radius to be solid, expected 'radius' in its "
                                       "surface");
  }
  made.radius = placement.to_local ? *radius / stretch_bound(placement.to_local->linear) : *radius;

  if (element.kind == ElementKind::cylinder && !is_point_like(element.skeleton, *radius)) {
    made.surface = capped_cylinder(placement, std::get<Segment>(element.skeleton), *radius);
    made.creased = true;
  } else if (const auto* arc = std::get_if<Arc>(&element.skeleton);
             arc && !offset && !is_point_like(element.skeleton, *radius)) {
    made.surface = flat_ended_arc(placement, *arc, *radius);
    made.creased = arc->sweep < 2 * std::numbers::pi;
  } else if (is_point_like(element.skeleton, *radius)) {
    const Vec3d at = std::visit([](const auto& p) { return middle(p); }, element.skeleton);
    made.surface = std::make_shared<Offset>(Point{at}, *radius, placement.to_local);
  } else {
    made.surface = std::make_shared<Offset>(element.skeleton, *radius, placement.to_local);
  }
  return made;
}

}  // namespace cs2mesh
