#include "libfield/primitive/uv_gradient.h"

#include <cmath>
#include <numbers>

namespace cs2mesh {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSlack = 1 + 1e-12;

using Components = std::array<Interval, 3>;

Components around_zero(double magnitude) {
  const Interval r(-magnitude, magnitude);
  return {r, r, r};
}

Components near(const Vec3d& center, double radius) {
  return {widened(center.x, radius), widened(center.y, radius), widened(center.z, radius)};
}

/// A constant gradient g where the coordinate runs, and 0 where it is clamped.
Components clamped(const Vec3d& g) {
  return {hull(0.0, g.x), hull(0.0, g.y), hull(0.0, g.z)};
}

/// sup of k / rho over the points whose rho is at least `rho`.
double reciprocal(double k, double rho) {
  return rho > 0 ? kSlack * k / rho : std::numeric_limits<double>::infinity();
}

}  // namespace

double ball_radius(const Aabb& box) {
  return 0.5 * box.diagonal() * kSlack;
}

UvGradientBound enclose_uv_gradient(const Point& point, const Aabb& box) {
  const Vec3d d = box.center() - point.position;
  const double radius = ball_radius(box);
  UvGradientBound bound;
  bound.u = around_zero(reciprocal(1 / (2 * kPi), std::hypot(d.x, d.y) - radius));
  bound.v = around_zero(reciprocal(1 / kPi, norm(d) - radius));
  bound.seam_u = d.x + radius >= 0 && std::abs(d.y) <= radius;
  return bound;
}

UvGradientBound enclose_uv_gradient(const Segment& segment, const Aabb& box) {
  const Vec3d ab = segment.b - segment.a;
  const double length = norm(ab);
  const Vec3d d = box.center() - segment.a;
  const double radius = ball_radius(box);
  UvGradientBound bound;
  const Vec3d axis = ab / length;
  const double x = dot(d, axis);
  const Vec3d g = axis / length;
  const bool inside = x - radius > 0 && x + radius < length;
  const bool outside = x + radius < 0 || x - radius > length;
  bound.u = inside ? near(g, 1e-15 * norm(g)) : outside ? around_zero(0.0) : clamped(g);
  bound.v = around_zero(reciprocal(1 / (2 * kPi), norm(cross(axis, d)) - radius));
  bound.seam_v = true;
  return bound;
}

UvGradientBound enclose_uv_gradient(const Arc& arc, const Aabb& box) {
  const Vec3d d = box.center() - arc.center;
  const double radius = ball_radius(box);
  const double x = dot(d, arc.ex);
  const double y = dot(d, arc.ey);
  const double rho = std::hypot(x, y);
  UvGradientBound bound;

  // u: the azimuth phi over the sweep; |grad phi| = 1 / rho, |D^2 phi| <= 1 / rho^2.
  const double rho_min = rho - radius;
  if (rho_min > 0) {
    const Vec3d e_phi = (x * arc.ey - y * arc.ex) / rho;
    const double turn = std::asin(std::min(1.0, radius / rho)) * kSlack;
    const double from_middle = std::abs(std::atan2(y, x));
    const Vec3d g = e_phi / (rho * arc.sweep);
    bound.u = near(g, kSlack * radius / (rho_min * rho_min * arc.sweep));
    if (from_middle - turn > arc.sweep / 2 && from_middle + turn < kPi) {
      bound.u = around_zero(0.0);  // clamped throughout
    } else if (from_middle + turn >= arc.sweep / 2) {
      for (Interval& component : bound.u) component = hull(component, 0.0);
    }
    bound.seam_u = from_middle + turn >= kPi;
  } else {
    bound.u = around_zero(std::numeric_limits<double>::infinity());
    bound.seam_u = true;
  }

  // v: the angle around the tube of the full circle.
  const double z = dot(d, arc.normal);
  bound.v = around_zero(reciprocal(1 / (2 * kPi), std::hypot(rho - arc.radius, z) - radius));
  bound.seam_v = true;
  return bound;
}

UvGradientBound enclose_uv_gradient(const Triangle& triangle, const Aabb& /*box*/) {
  // Dual basis of the two edges from the first vertex.
  const Vec3d e1 = triangle.vertex[1] - triangle.vertex[0];
  const Vec3d e2 = triangle.vertex[2] - triangle.vertex[0];
  const Vec3d n = cross(e1, e2);
  const double n2 = squared_norm(n);
  return {clamped(cross(e2, n) / n2), clamped(cross(n, e1) / n2)};
}

UvGradientBound enclose_uv_gradient(const Plane& /*plane*/, const Aabb& /*box*/) {
  // u and v are lengths along unit axes.
  return {around_zero(kSlack), around_zero(kSlack)};
}

}  // namespace cs2mesh
