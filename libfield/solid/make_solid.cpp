#include "libfield/solid/make_solid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libfield/solid/combination.h"
#include "libfield/solid/cone_side.h"
#include "libfield/solid/half_space.h"
#include "libfield/solid/offset.h"
#include "libfield/solid/quadric_solid.h"
#include "libfield/solid/round_cone.h"

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

MadeSolid make_box(const Placement& placement, const Segment& diagonal) {
  MadeSolid made;
  made.surface = box(placement, diagonal.a, diagonal.b);
  const Vec3d sides = diagonal.b - diagonal.a;
  made.radius = 0.5 * std::min({sides.x, sides.y, sides.z});
  if (placement.to_local) made.radius /= stretch_bound(placement.to_local->linear);
  made.creased = true;
  return made;
}

/// With lids, or rounded.
MadeSolid make_cone(const Placement& placement, const Segment& axis, const ConeRadii& radii,
                    bool rounded) {
  MadeSolid made;
  const double larger = std::max(radii.base, radii.apex);
  if (!rounded) {
    made.surface = capped_cone(placement, axis, radii.base, radii.apex);
  } else if (std::abs(radii.base - radii.apex) < norm(axis.b - axis.a)) {
    made.surface = std::make_shared<RoundCone>(axis, radii.base, radii.apex, placement.to_local);
  } else {
    const Point middle{radii.base > radii.apex ? axis.a : axis.b};
    made.surface = std::make_shared<Offset>(middle, larger, placement.to_local);
  }
  made.radius = 0.5 * larger;
  if (!rounded) made.radius = std::min(made.radius, 0.5 * norm(axis.b - axis.a));
  if (placement.to_local) made.radius /= stretch_bound(placement.to_local->linear);
  made.creased = !rounded;
  return made;
}

Result<MadeSolid> make_quadric(const Placement& placement, const Quadric& quadric,
                               const SourceLocation& where) {
  const auto solid = QuadricSolid::make(quadric, placement.to_world);
  if (!solid) {
    return error_at(where,
                    "the quadric leaves the range of double precision, expected less extreme"
                    " numbers");
  }
  if (has_no_inside(solid->form())) {
    return error_at(where,
                    "the quadric has no inside, expected a polynomial that is negative "
                    "somewhere");
  }
  MadeSolid made;
  made.surface = solid;
  made.radius = least_radius(solid->form());
  if (!quadric.bounds) return made;
  const MadeSolid walls = make_box(placement, {quadric.bounds->min, quadric.bounds->max});
  made.surface = std::make_shared<Combination>(CombinationKind::intersection,
                                               std::vector<Surface>{solid, walls.surface});
  if (made.surface->bounds().empty() || made.surface->enclose(made.surface->bounds()).hi < 0) {
    return error_at(where, "the quadric has no inside within its bounds, expected others");
  }
  made.radius = made.radius > 0 ? std::min(made.radius, walls.radius) : walls.radius;
  made.creased = true;
  return made;
}

/// Degenerate skeletons are spheres: they have no axis.
bool is_point_like(const Primitive& primitive, double radius) {
  const double extent = std::visit([](const auto& p) { return size(p); }, primitive);
  return extent <= 1e-12 * radius;
}

/// A polygon with a rounded rim, creased at its reflex corners.
MadeSolid thick(const Placement& placement, const Polygon& polygon, double radius) {
  MadeSolid made;
  made.surface = std::make_shared<Offset>(polygon, radius, placement.to_local);
  made.radius = placement.to_local ? radius / stretch_bound(placement.to_local->linear) : radius;
  made.creased = !is_convex(polygon);
  return made;
}

/// All within the radius of the skeleton, or with flat ends.
MadeSolid make_around(const Placement& placement, const Element& element, double radius,
                      bool offset) {
  MadeSolid made;
  made.radius = radius;
  const auto* segment = std::get_if<Segment>(&element.skeleton);
  const auto* arc = std::get_if<Arc>(&element.skeleton);
  const bool has_lids =
      element.kind == ElementKind::cylinder && element.spelling == Spelling::plain;
  if (is_point_like(element.skeleton, radius)) {
    const Vec3d at = std::visit([](const auto& p) { return middle(p); }, element.skeleton);
    made.surface = std::make_shared<Offset>(Point{at}, radius, placement.to_local);
  } else if (segment != nullptr && (!offset || has_lids)) {
    made.surface = capped_cylinder(placement, *segment, radius);
    made.radius = std::min(radius, 0.5 * size(*segment));
    made.creased = true;
  } else if (arc != nullptr && !offset) {
    made.surface = flat_ended_arc(placement, *arc, radius);
    made.radius = std::min(radius, 0.5 * arc->sweep * arc->radius);
    made.creased = arc->sweep < 2 * std::numbers::pi;
  } else {
    made.surface = std::visit(
        [&](const auto& p) { return std::make_shared<Offset>(p, radius, placement.to_local); },
        element.skeleton);
  }
  if (placement.to_local) made.radius /= stretch_bound(placement.to_local->linear);
  return made;
}

}  // namespace

Result<MadeSolid> make_solid(const Scene& scene, const Element& element, bool offset) {
  Placement placement{world_transform(scene, element), std::nullopt};
  if (!placement.to_world.is_identity()) placement.to_local = inverse(placement.to_world);
  const std::string name(name_of(element.kind));
  const auto shape = static_cast<std::size_t>(element.shape);
  const bool is_polygon = element.kind == ElementKind::polygon;

  // What has no radius, or more than one.
  if (element.kind == ElementKind::plane && !offset) {
    const auto& plane = std::get<Plane>(element.skeleton);
    return MadeSolid{half_space(placement, plane.point, plane.normal)};
  }
  if (element.kind == ElementKind::cone) {
    return make_cone(placement, std::get<Segment>(element.skeleton), cone_radii(scene, element),
                     offset);
  }
  if (element.kind == ElementKind::box) {
    return make_box(placement, std::get<Segment>(element.skeleton));
  }
  if (element.kind == ElementKind::quadric) {
    return make_quadric(placement, scene.quadrics[shape], element.where);
  }
  if ((element.kind == ElementKind::triangle || is_polygon) && !offset) {
    return error_at(element.where,
                    "a hard " + name + " has no thickness, expected a surface with 'blobbiness'");
  }
  if (element.taper && !offset) {
    return error_at(element.where,
                    "a hard " + name + " has no taper, expected a surface with 'blobbiness'");
  }
  const std::optional<double> radius = radius_of(scene, element);
  if (!radius) {
    return error_at(element.where, "a " + name +
                                       " needs a radius to be solid, expected 'radius' in its "
                                       "surface");
  }
  return is_polygon ? thick(placement, scene.polygons[shape], *radius)
                    : make_around(placement, element, *radius, offset);
}

}  // namespace cs2mesh
