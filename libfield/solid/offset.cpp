#include "libfield/solid/offset.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "libfield/base/check.h"
#include "libfield/base/image_box.h"
#include "libfield/primitive/nearest_point.h"
#include "libfield/solid/turning_gradient.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The second derivative of the distance at p, whose nearest point is `nearest`: with e the unit
// vector from there, (I - e e^T - what runs along the primitive) / distance.

Symmetric3 distance_hessian(const Point& /*point*/, const Vec3d& p, const Vec3d& nearest) {
  const double d = norm(p - nearest);
  return (1 / d) * (multiple_of_unit(1.0) - squared((p - nearest) / d));
}

Symmetric3 distance_hessian(const Segment& segment, const Vec3d& p, const Vec3d& nearest) {
  const Symmetric3 round = distance_hessian(Point{nearest}, p, nearest);
  if (nearest == segment.a || nearest == segment.b) return round;
  return round - (1 / norm(p - nearest)) * squared(normalized(segment.b - segment.a));
}

Symmetric3 distance_hessian(const TaperedSegment& segment, const Vec3d& p, const Vec3d& nearest) {
  return distance_hessian(segment.axis, p, nearest);
}

/// Beside the arc the circle bends away: along it 1 / rho of the part of e that is away from the
/// axis.
Symmetric3 distance_hessian(const Arc& arc, const Vec3d& p, const Vec3d& nearest) {
  const Vec3d d = p - arc.center;
  const double x = dot(d, arc.ex), y = dot(d, arc.ey), rho = std::hypot(x, y);
  const Symmetric3 round = distance_hessian(Point{nearest}, p, nearest);
  if (!(std::abs(std::atan2(y, x)) < 0.5 * arc.sweep) || !(rho > 0)) return round;
  const Vec3d around = (x / rho) * arc.ey - (y / rho) * arc.ex;
  const double distance = norm(p - nearest);
  const double bend = (rho - arc.radius) / (distance * rho);
  return round + (bend - 1 / distance) * squared(around);
}

/// Over a flat shape the distance is that from its plane, beside it that from an edge.
template <class Flat>
Symmetric3 flat_distance_hessian(const Flat& flat, const Vec3d& p, const Vec3d& nearest) {
  if (is_above(flat, p)) return {};
  return distance_hessian(nearest_edge(flat, p), p, nearest);
}

Symmetric3 distance_hessian(const Triangle& triangle, const Vec3d& p, const Vec3d& nearest) {
  return flat_distance_hessian(triangle, p, nearest);
}

Symmetric3 distance_hessian(const Polygon& polygon, const Vec3d& p, const Vec3d& nearest) {
  return flat_distance_hessian(polygon, p, nearest);
}

Symmetric3 distance_hessian(const Plane& /*plane*/, const Vec3d& /*p*/, const Vec3d& /*nearest*/) {
  return {};
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

/// As of a convex set where the nearest points all belong to a convex part of the polygon: within
/// their reach it has no edge, one, or two that meet in a corner of less than 180 degrees. There
/// may be creases elsewhere.
double curvature_bound(const Polygon& polygon, const Vec3d& center, double ball_radius,
                       double nearest) {
  if (!(nearest > 0)) return kInfinity;
  if (is_convex(polygon)) return 1 / nearest;
  const double reach =
      (norm(nearest_point(polygon, center) - center) + 2 * ball_radius) * (1 + 1e-12);
  const std::size_t n = polygon.size();
  std::size_t count = 0;
  std::size_t first = 0, last = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (distance(polygon.edge(i), center) > reach) continue;
    if (count == 0) first = i;
    last = i;
    ++count;
  }
  if (count <= 1) return 1 / nearest;
  const bool wraps = first == 0 && last == n - 1;
  const bool neighbours = count == 2 && (last == first + 1 || wraps);
  return neighbours && !is_reflex(polygon, wraps ? 0 : last) ? 1 / nearest : kInfinity;
}

/// sup |D^order distance| for orders 3 and 4 where nothing is nearer than `nearest`. Along a line
/// whose cosine with the ray from a point is c it is 3 c (1 - c^2) / r^2, then
/// 3 (1 - 6 c^2 + 5 c^4) / r^3. The curvature of the distance to most shapes jumps where the
/// nearest point passes from a side to an end.
template <class P>
double higher_bound(const P& /*primitive*/, int order, double nearest) {
  if (!(nearest > 0)) return kInfinity;
  if (std::is_same_v<P, Plane>) return 0.0;
  if (!std::is_same_v<P, Point>) return kInfinity;
  const double most = order == 3 ? 2.0 / std::numbers::sqrt3 : 3.0;
  return most / (order == 3 ? nearest * nearest : nearest * nearest * nearest) * (1 + 1e-14);
}

}  // namespace

Offset::Offset(Shape shape, double radius, std::optional<Affine> to_local)
    : shape_(std::move(shape)),
      radius_(radius),
      to_local_(to_local),
      stretch_(to_local_ ? stretch_bound(to_local_->linear) : 1.0) {
  require(radius > 0, "an offset needs a positive radius");
}

Jet Offset::jet_at(const Vec3d& p) const {
  const Vec3d local = to_local_ ? (*to_local_)(p) : p;
  const Vec3d nearest =
      std::visit([&](const auto& shape) { return nearest_point(shape, local); }, shape_);
  const Vec3d away = local - nearest;
  const double distance = norm(away);
  if (!(distance > 0)) return {radius_, {}};
  const Vec3d gradient = -(away / distance);
  return {radius_ - distance, to_local_ ? transpose(to_local_->linear) * gradient : gradient};
}

Symmetric3 Offset::hessian_at(const Vec3d& p) const {
  const Vec3d local = to_local_ ? (*to_local_)(p) : p;
  return std::visit(
      [&](const auto& shape) -> Symmetric3 {
        const Vec3d nearest = nearest_point(shape, local);
        if (!(norm(local - nearest) > 0)) return {};
        const Symmetric3 h = -1.0 * distance_hessian(shape, local, nearest);
        return to_local_ ? congruent(h, to_local_->linear) : h;
      },
      shape_);
}

void Offset::second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Jet jet = jet_at(points[i]);
    out[i] = {jet.value, jet.gradient, hessian_at(points[i])};
  }
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
  return std::pow(stretch_, order) * (1 + 1e-14) *
         std::visit(
             [&](const auto& shape) {
               return order == 2 ? curvature_bound(shape, center, ball, nearest)
                                 : higher_bound(shape, order, nearest);
             },
             shape_);
}

std::array<Interval, 3> Offset::enclose_gradient(const Aabb& box) const {
  return turning_gradient(jet_at(box.center()).gradient, derivative_bound(2, box),
                          0.5 * box.diagonal(), stretch_);
}

Aabb Offset::bounds() const {
  const Aabb local =
      std::visit([](const auto& shape) { return cs2mesh::bounds(shape); }, shape_).grown(radius_);
  if (!to_local_ || !local.finite()) return local;
  return image_box(local, inverse(*to_local_));
}

std::unique_ptr<ImplicitSurface> Offset::restrict_to(const Aabb& /*box*/) const {
  return std::make_unique<Offset>(*this);
}

}  // namespace cs2mesh
