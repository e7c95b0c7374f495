#include "libfield/solid/half_space.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cs2mesh {

void HalfSpace::values(std::span<const Vec3d> points, std::span<double> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = at(points[i]);
}

void HalfSpace::jets(std::span<const Vec3d> points, std::span<Jet> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = {at(points[i]), -normal_};
}

void HalfSpace::second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = {at(points[i]), -normal_, {}};
}

Interval HalfSpace::enclose(const Aabb& box) const {
  const Vec3d half = 0.5 * box.extent();
  const double reach =
      std::abs(normal_.x) * half.x + std::abs(normal_.y) * half.y + std::abs(normal_.z) * half.z;
  const double rounding = 1e-15 * norm(normal_) * (norm(box.center() - point_) + norm(half));
  return widened(Interval(at(box.center())), reach * (1 + 1e-15) + rounding);
}

std::array<Interval, 3> HalfSpace::enclose_gradient(const Aabb& /*box*/) const {
  return {Interval(-normal_.x), Interval(-normal_.y), Interval(-normal_.z)};
}

double HalfSpace::derivative_bound(int order, const Aabb& /*box*/) const {
  return order == 1 ? norm(normal_) * (1 + 1e-15) : 0.0;
}

Aabb HalfSpace::bounds() const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Aabb box{{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool along = normal_[(axis + 1) % 3] == 0 && normal_[(axis + 2) % 3] == 0;
    if (along) (normal_[axis] > 0 ? box.max : box.min)[axis] = point_[axis];
  }
  return box;
}

std::unique_ptr<ImplicitSurface> HalfSpace::restrict_to(const Aabb& /*box*/) const {
  return std::make_unique<HalfSpace>(*this);
}

}  // namespace cs2mesh
