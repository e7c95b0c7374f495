#include "libfield/solid/round_cone.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/base/check.h"
#include "libfield/base/image_box.h"
#include "libfield/solid/concave_range.h"
#include "libfield/solid/turning_gradient.h"

namespace cs2mesh {

RoundCone::RoundCone(const Segment& axis, double radius_a, double radius_b,
                     std::optional<Affine> to_local)
    : axis_(axis),
      radius_a_(radius_a),
      radius_b_(radius_b),
      length_(norm(axis.b - axis.a)),
      to_local_(to_local),
      stretch_(to_local_ ? stretch_bound(to_local_->linear) : 1.0) {
  require(std::min(radius_a, radius_b) >= 0, "a cone has no negative radius");
  require(std::abs(radius_a - radius_b) < length_, "a round cone is longer than its radii differ");
  along_ = (axis.b - axis.a) / length_;
  slope_ = (radius_b - radius_a) / length_;
  tangent_ = slope_ / std::sqrt((1 - slope_) * (1 + slope_));
}

Jet2 RoundCone::jet_at(const Vec3d& p) const {
  const Vec3d d = local(p) - axis_.a;
  const double foot = dot(d, along_);
  const Vec3d out = d - foot * along_;
  const double rho = norm(out);
  const double best = foot + rho * tangent_;
  const double t = std::clamp(best, 0.0, length_);
  const Vec3d away = d - t * along_;
  const double distance = norm(away);
  Jet2 jet{radius_a_ + slope_ * t - distance, slope_ * along_, {}};
  if (distance > 0) {
    // At the side only the direction around the axis bends, at the round ends both across do.
    const bool side = 0 < best && best < length_;
    jet.gradient = -away / distance;
    const Symmetric3 across = multiple_of_unit(1.0) - squared(away / distance);
    if (!side) {
      jet.hessian = (-1 / distance) * across;
    } else if (rho > 0) {
      jet.hessian =
          (-1 / distance) * (multiple_of_unit(1.0) - squared(along_) - squared(out / rho));
    }
  }
  if (!to_local_) return jet;
  return {jet.value, transpose(to_local_->linear) * jet.gradient,
          congruent(jet.hessian, to_local_->linear)};
}

void RoundCone::values(std::span<const Vec3d> points, std::span<double> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = jet_at(points[i]).value;
}

void RoundCone::jets(std::span<const Vec3d> points, std::span<Jet> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Jet2 jet = jet_at(points[i]);
    out[i] = {jet.value, jet.gradient};
  }
}

void RoundCone::second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = jet_at(points[i]);
}

Interval RoundCone::enclose(const Aabb& box) const {
  const double size = radius_a_ + radius_b_ + length_ + norm(local(box.center()) - axis_.a) +
                      norm(axis_.a) + stretch_ * (0.5 * box.diagonal());
  const auto jet = [this](const Vec3d& p) -> Jet {
    const Jet2 all = jet_at(p);
    return {all.value, all.gradient};
  };
  return widened(concave_range(jet, box), 1e-14 * (1 + std::abs(tangent_)) * size);
}

/// The distance from the center of the best ball is at least that from the axis.
double RoundCone::derivative_bound(int order, const Aabb& box) const {
  if (order == 1) return stretch_ * (1 + 1e-14);
  const double ball = 0.5 * box.diagonal() * stretch_ * (1 + 1e-15);
  const double nearest = distance(axis_, local(box.center())) * (1 - 1e-14) - ball;
  if (order > 2 || !(nearest > 0)) return std::numeric_limits<double>::infinity();
  return stretch_ * stretch_ / nearest * (1 + 1e-13);
}

std::array<Interval, 3> RoundCone::enclose_gradient(const Aabb& box) const {
  return turning_gradient(jet_at(box.center()).gradient, derivative_bound(2, box),
                          0.5 * box.diagonal(), stretch_);
}

Aabb RoundCone::bounds() const {
  const Vec3d a{radius_a_, radius_a_, radius_a_}, b{radius_b_, radius_b_, radius_b_};
  const Aabb local{min(axis_.a - a, axis_.b - b), max(axis_.a + a, axis_.b + b)};
  return to_local_ ? image_box(local, inverse(*to_local_)) : local;
}

std::unique_ptr<ImplicitSurface> RoundCone::restrict_to(const Aabb& /*box*/) const {
  return std::make_unique<RoundCone>(*this);
}

}  // namespace cs2mesh
