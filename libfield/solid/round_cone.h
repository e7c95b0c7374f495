// All balls along an axis, of radii linear along it: the offset surface of a soft cone.
//   F(p) = max over t of r(t) - |p - q(t)|, the signed distance from the surface.
// With s = dr / dt, |s| < 1, the best t is where the foot of p is, plus rho s / sqrt(1 - s^2), rho
// the distance from the axis, clamped to the axis.
#pragma once

#include <optional>

#include "libfield/base/affine.h"
#include "libfield/field/implicit_surface.h"
#include "libfield/primitive/segment.h"

namespace cs2mesh {

/// Round ends; a tip where a radius is 0. F is concave. Its gradient is continuous but on the axis,
/// where the part away from the axis is given as 0.
class RoundCone final : public ImplicitSurface {
 public:
  /// Radii at the ends of the axis, >= 0 and less apart than the axis is long (else
  /// ContractViolation): otherwise one ball is all. `to_local`: M^-1 where the solid is transformed
  /// by M.
  RoundCone(const Segment& axis, double radius_a, double radius_b,
            std::optional<Affine> to_local = std::nullopt);

  void values(std::span<const Vec3d> points, std::span<double> out) const override;
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override;
  void second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const override;
  Interval enclose(const Aabb& box) const override;
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override;
  double derivative_bound(int order, const Aabb& box) const override;
  Aabb bounds() const override;
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb& box) const override;

 private:
  Vec3d local(const Vec3d& p) const { return to_local_ ? (*to_local_)(p) : p; }
  Jet2 jet_at(const Vec3d& p) const;

  Segment axis_;
  double radius_a_, radius_b_;
  Vec3d along_;  ///< unit, from a to b
  double length_, slope_, tangent_;
  std::optional<Affine> to_local_;
  double stretch_;  ///< upper bound of |M^-1|
};

}  // namespace cs2mesh
