#include "libfield/primitive/uv_hessian.h"

#include <cmath>
#include <numbers>

namespace cs2mesh {
namespace {

constexpr double kPi = std::numbers::pi;

/// That of the angle in a plane, at distance rho from its axis: `outward` and `around` are the unit
/// vectors there. (The gradient around / rho turns and shrinks.)
Symmetric3 angle_hessian(const Vec3d& outward, const Vec3d& around, double rho) {
  return (-1.0 / (rho * rho)) * symmetric_product(outward, around);
}

}  // namespace

UvHessian uv_hessian(const Point& point, const Vec3d& p) {
  const Vec3d d = p - point.position;
  const double rho = std::hypot(d.x, d.y), r = std::hypot(rho, d.z);
  if (!(rho > 0.0)) return {};
  const Vec3d outward{d.x / rho, d.y / rho, 0.0};
  const Vec3d around{-outward.y, outward.x, 0.0};
  const Vec3d away = d / r;
  const Vec3d down = (d.z / r) * outward - Vec3d{0.0, 0.0, rho / r};
  // The polar angle: its gradient down / r also turns with the azimuth, by cot(angle) / r.
  const Symmetric3 polar = angle_hessian(away, down, r) + (d.z / (rho * r * r)) * squared(around);
  return {(0.5 / kPi) * angle_hessian(outward, around, rho), (1.0 / kPi) * polar};
}

UvHessian uv_hessian(const Segment& segment, const Vec3d& p) {
  const double length = measure(segment);
  if (!(length > 0.0)) return {};
  const Vec3d axis = (segment.b - segment.a) / length;
  const Vec3d perp = cross(axis, cross(p - segment.a, axis));
  const double rho = norm(perp);
  if (!(rho > 0.0)) return {};
  const Vec3d outward = perp / rho;
  return {{}, (0.5 / kPi) * angle_hessian(outward, cross(axis, outward), rho)};
}

UvHessian uv_hessian(const Arc& arc, const Vec3d& p) {
  const Vec3d d = p - arc.center;
  const double x = dot(d, arc.ex), y = dot(d, arc.ey), z = dot(d, arc.normal);
  const double rho = std::hypot(x, y);
  if (!(rho > 0.0)) return {};
  const Vec3d outward = (x / rho) * arc.ex + (y / rho) * arc.ey;
  const Vec3d around = (x / rho) * arc.ey - (y / rho) * arc.ex;
  UvHessian hessian;
  if (std::abs(std::atan2(y, x)) < 0.5 * arc.sweep) {
    hessian.u = (1.0 / arc.sweep) * angle_hessian(outward, around, rho);
  }
  const double beyond = rho - arc.radius;
  const double r = std::hypot(beyond, z);
  if (r > 0.0) {
    const Vec3d away = (beyond / r) * outward + (z / r) * arc.normal;
    const Vec3d onward = (beyond / r) * arc.normal - (z / r) * outward;
    // The part of the gradient along `outward` turns with the azimuth.
    hessian.v =
        (0.5 / kPi) * (angle_hessian(away, onward, r) - (z / (r * r * rho)) * squared(around));
  }
  return hessian;
}

UvHessian uv_hessian(const Triangle& /*triangle*/, const Vec3d& /*p*/) {
  return {};
}

UvHessian uv_hessian(const Plane& /*plane*/, const Vec3d& /*p*/) {
  return {};
}

}  // namespace cs2mesh
