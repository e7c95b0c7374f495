#include "libfield/primitive/point.h"

#include <cmath>
#include <numbers>

namespace cs2mesh {

double measure(const Point&) {
  return 1.0;
}

double distance(const Point& point, const Vec3d& p) {
  return norm(p - point.position);
}

Aabb bounds(const Point& point) {
  return {point.position, point.position};
}

Vec3d middle(const Point& point) {
  return point.position;
}

double size(const Point&) {
  return 0.0;
}

Uv uv(const Point& point, const Vec3d& p) {
  const Vec3d d = p - point.position;
  const double rho = std::hypot(d.x, d.y);
  const double r = std::hypot(rho, d.z);
  Uv result{turn(d.y, d.x), std::atan2(rho, d.z) / std::numbers::pi, {}, {}};
  if (rho > 0.0) {
    const Vec3d outward{d.x / rho, d.y / rho, 0.0};
    const Vec3d around{-outward.y, outward.x, 0.0};
    result.grad_u = around / (2.0 * std::numbers::pi * rho);
    const Vec3d down = (d.z / r) * outward - Vec3d{0.0, 0.0, rho / r};
    result.grad_v = down / (std::numbers::pi * r);
  }
  return result;
}

UvIntervals enclose_uv(const Point& point, const Aabb& box) {
  const Interval x = Interval(box.min.x, box.max.x) - point.position.x;
  const Interval y = Interval(box.min.y, box.max.y) - point.position.y;
  const Interval z = Interval(box.min.z, box.max.z) - point.position.z;
  const Interval rho = enclose_hypot(x, y);
  Interval v{0.0, 1.0};
  if (rho.lo > 0.0) {
    const Interval polar = enclose_angle(rho, z);
    v = clamped_to_unit(
        {next_down(polar.lo / std::numbers::pi), next_up(polar.hi / std::numbers::pi)});
  }
  return {enclose_turn(y, x), v};
}

Point transformed(const Point& point, const Affine& map) {
  return {map(point.position)};
}

}  // namespace cs2mesh
