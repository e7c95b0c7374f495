#include "libfield/solid/offset.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The nearest point of a primitive, and how strongly the distance to it curves at `distance`.
Vec3d nearest_point(const Point& point, const Vec3d& /*p*/) {
  return point.position;
}

Vec3d nearest_point(const Segment& segment, const Vec3d& p) {
  const Vec3d ab = segment.b - segment.a;
  const double t = dot(p - segment.a, ab) / squared_norm(ab);
  return t >= 0.5 ? segment.b - std::clamp(1 - t, 0.0, 1.0) * ab
                  : segment.a + std::clamp(t, 0.0, 1.0) * ab;
}

/// The offset is of the axis: it has no strength that a weight could change.
Vec3d nearest_point(const TaperedSegment& segment, const Vec3d& p) {
  return nearest_point(segment.axis, p);
}

Vec3d nearest_point(const Arc& arc, const Vec3d& p) {
  const Vec3d d = p - arc.center;
  const double half = 0.5 * arc.sweep;
  const double angle = std::clamp(std::atan2(dot(d, arc.ey), dot(d, arc.ex)), -half, half);
  return arc.center + arc.radius * (std::cos(angle) * arc.ex + std::sin(angle) * arc.ey);
}

Vec3d nearest_point(const Triangle& triangle, const Vec3d& p) {
  const auto& [a, b, c] = triangle.vertex;
  const Vec3d n = cross(b - a, c - a);
  // Inside the prism over the triangle the foot is the projection, elsewhere it is on an edge.
  const bool above = dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 &&
                     dot(cross(a - c, p - c), n) >= 0;
  if (above) return p - (dot(p - a, n) / squared_norm(n)) * n;
  Vec3d best = nearest_point(Segment{a, b}, p);
  for (const Segment& edge : {Segment{b, c}, Segment{c, a}}) {
    const Vec3d q = nearest_point(edge, p);
    if (squared_norm(q - p) < squared_norm(best - p)) best = q;
  }
  return best;
}

Vec3d nearest_point(const Plane& plane, const Vec3d& p) {
  return p - dot(p - plane.point, plane.normal) * plane.normal;
}

/// sup |D^2 distance| over the points of a ball, none of which is nearer than `nearest`: the
/// distance to a convex set curves by at most 1 / distance.
template <class P>
double curvature_bound(const P& /*convex*/, const Vec3d& /*center*/, double /*ball_radius*/,
                       double nearest) {
  return nearest > 0 ? 1 / nearest : kInfinity;
}

double curvature_bound(const Plane& /*plane*/, const Vec3d& /*center*/, double /*ball_radius*/,
                       double nearest) {
  return nearest > 0 ? 0.0 : kInfinity;
}

/// Beside the arc also 1 / (distance from the axis); behind it, the nearest end changes.
double curvature_bound(const Arc& arc, const Vec3d& center, double ball_radius, double nearest) {
  const Vec3d d = center - arc.center;
  const double x = dot(d, arc.ex);
  const double y = dot(d, arc.ey);
  const double rho = std::hypot(x, y) - ball_radius;
  if (!(nearest > 0) || !(rho > 0)) return kInfinity;
  const bool full = arc.sweep >= 2 * std::numbers::pi;
  const bool behind = x < ball_radius && std::abs(y) <= ball_radius;
  return behind && !full ? kInfinity : std::max(1 / nearest, 1 / rho);
}

}  // namespace

Offset::Offset(Primitive primitive, double radius, std::optional<Affine> to_local)
    : primitive_(primitive),
      radius_(radius),
      to_local_(to_local),
      stretch_(to_local_ ? stretch_bound(to_local_->linear) : 1.0) {
  require(radius > 0, "an offset needs a positive radius");
}

Jet Offset::jet_at(const Vec3d& p) const {
  const Vec3d local = to_local_ ? (*to_local_)(p) : p;
  const Vec3d nearest = std::visit(
      [&](const auto& primitive) { return nearest_point(primitive, local); }, primitive_);
  const Vec3d away = local - nearest;
  const double distance = norm(away);
  if (!(distance > 0)) return {radius_, {}};
  const Vec3d gradient = -(away / distance);
  return {radius_ - distance, to_local_ ? transpose(to_local_->linear) * gradient : gradient};
}

void Offset::values(std::span<const Vec3d> points, std::span<double> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = jet_at(points[i]).value;
}

void Offset::jets(std::span<const Vec3d> points, std::span<Jet> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = jet_at(points[i]);
}

Interval Offset::enclose(const Aabb& box) const {
  const double reach = 0.5 * box.diagonal() * stretch_ * (1 + 1e-15);
  const double middle = jet_at(box.center()).value;
  return widened(Interval(middle), reach + 1e-14 * (radius_ + std::abs(middle)));
}

double Offset::derivative_bound(int order, const Aabb& box) const {
  if (order == 1) return stretch_;
  const Vec3d center = to_local_ ? (*to_local_)(box.center()) : box.center();
  const double ball = 0.5 * box.diagonal() * stretch_ * (1 + 1e-15);
  const double nearest = (radius_ - jet_at(box.center()).value) * (1 - 1e-14) - ball;
  return stretch_ * stretch_ *
         std::visit(
             [&](const auto& primitive) {
               return curvature_bound(primitive, center, ball, nearest);
             },
             primitive_);
}

std::array<Interval, 3> Offset::enclose_gradient(const Aabb& box) const {
  const Vec3d g = jet_at(box.center()).gradient;
  const double turn =
      derivative_bound(2, box) * 0.5 * box.diagonal() * (1 + 1e-15) + 1e-14 * stretch_;
  const double most = stretch_ * (1 + 1e-14);
  const Interval all(-most, most);
  if (!(turn < 2 * most)) return {all, all, all};
  return {intersection(all, widened(g.x, turn)), intersection(all, widened(g.y, turn)),
          intersection(all, widened(g.z, turn))};
}

Aabb Offset::bounds() const {
  const Aabb local =
      std::visit([](const auto& primitive) { return cs2mesh::bounds(primitive); }, primitive_)
          .grown(radius_);
  if (!to_local_ || !local.finite()) return local;
  const Affine to_world = inverse(*to_local_);
  Aabb box;
  for (int corner = 0; corner < 8; ++corner) box.include(to_world(local.corner(corner)));
  return box;
}

std::unique_ptr<ImplicitSurface> Offset::restrict_to(const Aabb& /*box*/) const {
  return std::make_unique<Offset>(*this);
}

}  // namespace cs2mesh
