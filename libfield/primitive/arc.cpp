#include "libfield/primitive/arc.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libfield/base/check.h"

namespace cs2mesh {

namespace {

constexpr double kPi = std::numbers::pi;

// Coordinates of a point in the arc's own frame: rho and azimuth in its plane, z above it.
struct Cylindrical {
  double x, y, z, rho, azimuth;
};

Cylindrical local(const Arc& arc, const Vec3d& p) {
  const Vec3d d = p - arc.center;
  const double x = dot(d, arc.ex);
  const double y = dot(d, arc.ey);
  return {x, y, dot(d, arc.normal), std::hypot(x, y), std::atan2(y, x)};
}

// Cosine and sine of an angle in degrees, exact at multiples of 90.
struct Direction {
  double cos, sin;
};
Direction direction(double degrees) {
  const double reduced = std::remainder(degrees, 360.0);
  if (reduced == 0.0) return {1.0, 0.0};
  if (std::abs(reduced) == 180.0) return {-1.0, 0.0};
  if (std::abs(reduced) == 90.0) return {0.0, reduced > 0.0 ? 1.0 : -1.0};
  const double angle = reduced * (kPi / 180.0);
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

double measure(const Arc& arc) {
  return arc.radius * arc.sweep;
}

double distance(const Arc& arc, const Vec3d& p) {
  const Cylindrical at = local(arc, p);
  const double half = 0.5 * arc.sweep;
  if (std::abs(at.azimuth) <= half) return std::hypot(at.rho - arc.radius, at.z);
  const double end_x = arc.radius * std::cos(half);
  const double end_y = arc.radius * std::sin(half);
  return std::hypot(at.x - end_x, std::abs(at.y) - end_y, at.z);
}

Aabb bounds(const Arc& arc) {
  const double half = 0.5 * arc.sweep;
  const double cos_half = std::cos(half);
  const double sin_half = std::sin(half);
  Aabb box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // The coordinate is C + c * swing * cos(t - phase).
    const double ex = arc.ex[axis];
    const double ey = arc.ey[axis];
    const double swing = std::hypot(ex, ey);
    const double phase = std::atan2(ey, ex);
    const double end1 = ex * cos_half + ey * sin_half;
    const double end2 = ex * cos_half - ey * sin_half;
    const bool has_top = std::abs(phase) <= half;
    const bool has_bottom = kPi - std::abs(phase) <= half;
    const double hi = has_top ? swing : std::max(end1, end2);
    const double lo = has_bottom ? -swing : std::min(end1, end2);
    const double slack = 1e-15 * (std::abs(arc.center[axis]) + arc.radius);
    box.min[axis] = arc.center[axis] + arc.radius * lo - slack;
    box.max[axis] = arc.center[axis] + arc.radius * hi + slack;
  }
  return box;
}

Vec3d middle(const Arc& arc) {
  return arc.center + arc.radius * arc.ex;
}

double size(const Arc& arc) {
  const double diameter = 2.0 * arc.radius;
  return arc.sweep >= kPi ? diameter : diameter * std::sin(0.5 * arc.sweep);
}

Uv uv(const Arc& arc, const Vec3d& p) {
  const Cylindrical at = local(arc, p);
  const double along = at.azimuth / arc.sweep + 0.5;
  Uv result{std::clamp(along, 0.0, 1.0), turn(at.z, at.rho - arc.radius), {}, {}};
  if (at.rho > 0.0) {
    const Vec3d outward = (at.x / at.rho) * arc.ex + (at.y / at.rho) * arc.ey;
    const Vec3d around = (at.x / at.rho) * arc.ey - (at.y / at.rho) * arc.ex;
    if (0.0 < along && along < 1.0) result.grad_u = around / (at.rho * arc.sweep);
    const double beyond = at.rho - arc.radius;
    const double squared = beyond * beyond + at.z * at.z;
    if (squared > 0.0) {
      result.grad_v = (beyond * arc.normal - at.z * outward) / (2.0 * kPi * squared);
    }
  }
  return result;
}

UvIntervals enclose_uv(const Arc& arc, const Aabb& box) {
  const double slack = 1e-15 * (box.farthest_distance(arc.center) + arc.radius);
  const Interval x = widened(enclose_linear(arc.ex, arc.center, box), slack);
  const Interval y = widened(enclose_linear(arc.ey, arc.center, box), slack);
  const Interval z = widened(enclose_linear(arc.normal, arc.center, box), slack);
  const Interval azimuth = enclose_angle(y, x);
  const Interval along =
      widened({azimuth.lo / arc.sweep, azimuth.hi / arc.sweep}, 1e-14 / arc.sweep);
  const Interval beyond = widened(enclose_hypot(x, y) - Interval(arc.radius), slack);
  return {clamped_to_unit(along + Interval(0.5)), enclose_turn(z, beyond)};
}

Arc transformed(const Arc& arc, const Affine& map) {
  const double factor = similarity_factor(map.linear);
  require(factor > 0.0, "an arc needs a similarity");
  Arc image = arc;
  image.center = map(arc.center);
  image.radius = factor * arc.radius;
  image.ex = normalized(map.linear * arc.ex);
  image.ey = normalized(map.linear * arc.ey);
  image.normal = normalized(map.linear * arc.normal);
  return image;
}

Arc make_arc(const Vec3d& center, double radius, const Vec3d& normal, double start_degrees,
             double width_degrees) {
  return make_arc(center, radius, normal, reference_axis(normal), start_degrees, width_degrees);
}

Arc make_arc(const Vec3d& center, double radius, const Vec3d& normal, const Vec3d& x_axis,
             double start_degrees, double width_degrees) {
  const Vec3d n = normalized(normal);
  const Vec3d x = normalized(x_axis - dot(x_axis, n) * n);
  const Vec3d y = cross(n, x);
  const double width = std::clamp(width_degrees, -360.0, 360.0);
  const Direction mid = direction(start_degrees + 0.5 * width);
  Arc arc;
  arc.center = center;
  arc.radius = radius;
  arc.ex = mid.cos * x + mid.sin * y;
  arc.ey = mid.cos * y - mid.sin * x;
  arc.normal = n;
  arc.sweep = std::abs(width) == 360.0 ? 2.0 * kPi : std::abs(width) * (kPi / 180.0);
  return arc;
}

std::optional<std::variant<Segment, Arc>> make_arch(const Vec3d& p1, const Vec3d& p2,
                                                    const Vec3d& p3) {
  const Vec3d first = p2 - p1;
  const Vec3d last = p3 - p2;
  const Vec3d chord = p3 - p1;
  const Vec3d n = cross(first, last);  // = first x chord, with smaller terms
  const double area = norm(n);
  if (area <= 1e-9 * norm(first) * norm(chord)) {
    if (dot(first, last) < 0.0) return std::nullopt;
    return Segment{p1, p3};
  }
  // The angle between the two chords is half the sweep, |chord| = 2 c sin(sweep / 2).
  const double cos_part = dot(first, last);
  const double scale = norm(chord) / (2.0 * area);
  Arc arc;
  arc.sweep = 2.0 * std::atan2(area, cos_part);
  arc.radius = norm(first) * norm(last) * scale;
  arc.normal = n / area;
  arc.ex = normalized(cross(chord, arc.normal));
  arc.ey = cross(arc.normal, arc.ex);
  arc.center = p1 + 0.5 * chord - (cos_part * scale) * arc.ex;
  return arc;
}

}  // namespace cs2mesh
