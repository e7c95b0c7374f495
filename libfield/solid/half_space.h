// The half-space below a plane: F(p) = k * (signed distance below it).
#pragma once

#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

class HalfSpace final : public ImplicitSurface {
 public:
  /// Inside where dot(p - point, normal) <= 0; |normal| is the slope of F, not 0.
  HalfSpace(const Vec3d& point, const Vec3d& normal) : point_(point), normal_(normal) {}

  void values(std::span<const Vec3d> points, std::span<double> out) const override;
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override;
  void second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const override;
  Interval enclose(const Aabb& box) const override;
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override;
  double derivative_bound(int order, const Aabb& box) const override;
  /// Finite on one side where the normal is along an axis.
  Aabb bounds() const override;
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb& box) const override;

 private:
  double at(const Vec3d& p) const { return -dot(p - point_, normal_); }

  Vec3d point_, normal_;
};

}  // namespace cs2mesh
