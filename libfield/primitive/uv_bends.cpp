#include "libfield/primitive/uv_bends.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "libfield/primitive/uv_gradient.h"

namespace cs2mesh {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSlack = 1 + 1e-12;

/// Coordinates that are clamped to, or jump at, 0 and 1 are smooth strictly between these, and
/// where they are constant.
UvBends where_smooth(const UvBends& bends, const UvIntervals& at) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto of = [](const Interval& range, double bend) {
    if (range.lo == range.hi) return 0.0;
    return 0 < range.lo && range.hi < 1 ? kSlack * bend : kInfinity;
  };
  return {of(at.first, bends.u), of(at.second, bends.v)};
}

/// Of an angle around an axis that is no nearer than `rho`.
double bend_of_angle(double rho) {
  return rho > 0 ? 1 / (rho * rho) : std::numeric_limits<double>::infinity();
}

}  // namespace

UvBends bound_uv_bends(const Point& point, const Aabb& box) {
  const Vec3d d = box.center() - point.position;
  const double radius = ball_radius(box);
  const double r = norm(d) - radius, rho = std::hypot(d.x, d.y) - radius;
  if (!(r > 0 && rho > 0)) return where_smooth({}, {{0.0, 1.0}, {0.0, 1.0}});
  const double polar = (1 + (std::abs(d.z) + radius) / rho) * bend_of_angle(r);
  return where_smooth({bend_of_angle(rho) / (2 * kPi), polar / kPi}, enclose_uv(point, box));
}

UvBends bound_uv_bends(const Segment& segment, const Aabb& box) {
  const Vec3d axis = normalized(segment.b - segment.a);
  const double rho = norm(cross(axis, box.center() - segment.a)) - ball_radius(box);
  return where_smooth({0.0, bend_of_angle(rho) / (2 * kPi)}, enclose_uv(segment, box));
}

UvBends bound_uv_bends(const Arc& arc, const Aabb& box) {
  const Vec3d d = box.center() - arc.center;
  const double radius = ball_radius(box);
  const double far = std::hypot(dot(d, arc.ex), dot(d, arc.ey)), z = dot(d, arc.normal);
  const double rho = far - radius, r = std::hypot(far - arc.radius, z) - radius;
  if (!(r > 0 && rho > 0)) return where_smooth({}, {{0.0, 1.0}, {0.0, 1.0}});
  const double around = (1 + (std::abs(z) + radius) / rho) * bend_of_angle(r);
  return where_smooth({bend_of_angle(rho) / arc.sweep, around / (2 * kPi)}, enclose_uv(arc, box));
}

UvBends bound_uv_bends(const Triangle& triangle, const Aabb& box) {
  return where_smooth({}, enclose_uv(triangle, box));
}

UvBends bound_uv_bends(const Plane& /*plane*/, const Aabb& /*box*/) {
  return {};  // lengths along unit axes, without ends
}

}  // namespace cs2mesh
