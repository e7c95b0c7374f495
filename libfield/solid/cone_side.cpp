#include "libfield/solid/cone_side.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libfield/base/check.h"
#include "libfield/solid/concave_range.h"
#include "libfield/solid/turning_gradient.h"

namespace cs2mesh {

ConeSide::ConeSide(const Segment& axis, double radius_a, double radius_b,
                   std::optional<Affine> to_local)
    : start_(axis.a),
      radius_(radius_a),
      to_local_(to_local),
      stretch_(to_local_ ? stretch_bound(to_local_->linear) : 1.0) {
  const double length = norm(axis.b - axis.a);
  require(length > 0, "a cone needs an axis");
  require(std::min(radius_a, radius_b) >= 0 && std::max(radius_a, radius_b) > 0,
          "a cone needs a radius");
  along_ = (axis.b - axis.a) / length;
  slope_ = (radius_b - radius_a) / length;
  cosine_ = 1 / std::hypot(1.0, slope_);
}

Vec3d ConeSide::away(const Vec3d& q) const {
  const Vec3d d = q - start_;
  return d - dot(d, along_) * along_;
}

Jet ConeSide::jet_at(const Vec3d& p) const {
  const Vec3d q = local(p);
  const Vec3d out = away(q);
  const double rho = norm(out);
  const double value = cosine_ * (radius_ + slope_ * dot(q - start_, along_) - rho);
  Vec3d gradient = (cosine_ * slope_) * along_;
  if (rho > 0) gradient -= (cosine_ / rho) * out;
  return {value, to_local_ ? transpose(to_local_->linear) * gradient : gradient};
}

/// -cos(alpha) (I - w w^T - e e^T) / rho, with w along the axis and e away from it.
Symmetric3 ConeSide::hessian_at(const Vec3d& p) const {
  const Vec3d out = away(local(p));
  const double rho = norm(out);
  if (!(rho > 0)) return {};
  const Symmetric3 around = multiple_of_unit(1.0) - squared(along_) - squared(out / rho);
  const Symmetric3 h = (-cosine_ / rho) * around;
  return to_local_ ? congruent(h, to_local_->linear) : h;
}

void ConeSide::values(std::span<const Vec3d> points, std::span<double> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = jet_at(points[i]).value;
}

void ConeSide::jets(std::span<const Vec3d> points, std::span<Jet> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = jet_at(points[i]);
}

void ConeSide::second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Jet jet = jet_at(points[i]);
    out[i] = {jet.value, jet.gradient, hessian_at(points[i])};
  }
}

Interval ConeSide::enclose(const Aabb& box) const {
  const Vec3d q = local(box.center());
  const double size = radius_ + norm(q) + norm(start_) + stretch_ * (0.5 * box.diagonal());
  return widened(concave_range([this](const Vec3d& p) { return jet_at(p); }, box),
                 1e-14 * (1 + std::abs(slope_)) * size);
}

double ConeSide::derivative_bound(int order, const Aabb& box) const {
  if (order == 1) return stretch_ * (1 + 1e-14);
  const double ball = 0.5 * box.diagonal() * stretch_ * (1 + 1e-15);
  const double rho = norm(away(local(box.center()))) * (1 - 1e-14) - ball;
  if (!(rho > 0)) return std::numeric_limits<double>::infinity();
  // As for the distance from a point, in the plane across the axis; see offset.cpp.
  const double share = order == 2   ? 1 / rho
                       : order == 3 ? 2 / std::numbers::sqrt3 / (rho * rho)
                                    : 3 / (rho * rho * rho);
  return cosine_ * std::pow(stretch_, order) * share * (1 + 1e-13);
}

std::array<Interval, 3> ConeSide::enclose_gradient(const Aabb& box) const {
  return turning_gradient(jet_at(box.center()).gradient, derivative_bound(2, box),
                          0.5 * box.diagonal(), stretch_);
}

Aabb ConeSide::bounds() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
}

std::unique_ptr<ImplicitSurface> ConeSide::restrict_to(const Aabb& /*box*/) const {
  return std::make_unique<ConeSide>(*this);
}

}  // namespace cs2mesh
