#include "libfield/primitive/segment.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cs2mesh {

double measure(const Segment& segment) {
  return norm(segment.b - segment.a);
}

double distance(const Segment& segment, const Vec3d& p) {
  const Vec3d axis = segment.b - segment.a;
  const double length = norm(axis);
  const Vec3d from_a = p - segment.a;
  const Vec3d from_b = p - segment.b;
  if (length == 0.0 || dot(from_a, axis) <= 0.0) return norm(from_a);
  if (dot(from_b, axis) >= 0.0) return norm(from_b);
  // The nearer end keeps more digits of the cross product.
  const bool a_nearer = squared_norm(from_a) < squared_norm(from_b);
  return norm(cross(axis / length, a_nearer ? from_a : from_b));
}

Aabb bounds(const Segment& segment) {
  return {min(segment.a, segment.b), max(segment.a, segment.b)};
}

Vec3d middle(const Segment& segment) {
  return segment.a + 0.5 * (segment.b - segment.a);
}

double size(const Segment& segment) {
  return measure(segment);
}

Uv uv(const Segment& segment, const Vec3d& p) {
  const double length = measure(segment);
  if (length == 0.0) return {};
  const Vec3d axis = (segment.b - segment.a) / length;
  const Vec3d d = p - segment.a;
  const double along = dot(d, axis) / length;
  const Vec3d x_axis = reference_axis(axis);
  const Vec3d y_axis = cross(axis, x_axis);
  const double x = dot(d, x_axis);
  const double y = dot(d, y_axis);
  Uv result{std::clamp(along, 0.0, 1.0), turn(y, x), {}, {}};
  if (0.0 < along && along < 1.0) result.grad_u = axis / length;
  const double rho2 = x * x + y * y;
  if (rho2 > 0.0) result.grad_v = (x * y_axis - y * x_axis) / (2.0 * std::numbers::pi * rho2);
  return result;
}

UvIntervals enclose_uv(const Segment& segment, const Aabb& box) {
  const double length = measure(segment);
  if (length == 0.0) return {0.0, 0.0};
  const Vec3d axis = (segment.b - segment.a) / length;
  const Vec3d x_axis = reference_axis(axis);
  const Vec3d y_axis = cross(axis, x_axis);
  const double slack = 1e-15 * (box.farthest_distance(segment.a) + length);
  const Interval along = widened(enclose_linear(axis, segment.a, box), slack);
  const Interval x = widened(enclose_linear(x_axis, segment.a, box), slack);
  const Interval y = widened(enclose_linear(y_axis, segment.a, box), slack);
  const Interval u{next_down(along.lo / length), next_up(along.hi / length)};
  return {clamped_to_unit(u), enclose_turn(y, x)};
}

Segment transformed(const Segment& segment, const Affine& map) {
  return {map(segment.a), map(segment.b)};
}

}  // namespace cs2mesh
