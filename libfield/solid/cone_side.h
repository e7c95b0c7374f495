// The inside of a cone's side, without lids: F(p) = (r(t) - rho) cos(alpha), the signed distance to
// the side, with t along the axis, rho the distance from it, r the radius there and alpha the angle
// between side and axis. A cylinder, where the radii are equal.
#pragma once

#include <optional>

#include "libfield/base/affine.h"
#include "libfield/field/implicit_surface.h"
#include "libfield/primitive/segment.h"

namespace cs2mesh {

/// Unbounded: it goes on beyond both ends of the axis, to the tip on one side. F is concave. Its
/// gradient is continuous but on the axis, where the part away from the axis is given as 0.
class ConeSide final : public ImplicitSurface {
 public:
  /// Radii at the ends of the axis, >= 0 and not both 0; the axis is not a point (else
  /// ContractViolation). `to_local`: M^-1 where the solid is transformed by M.
  ConeSide(const Segment& axis, double radius_a, double radius_b,
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
  /// From the axis to a point of local coordinates.
  Vec3d away(const Vec3d& q) const;
  Jet jet_at(const Vec3d& p) const;
  Symmetric3 hessian_at(const Vec3d& p) const;

  Vec3d start_, along_;  ///< of the axis, in local coordinates
  double radius_, slope_, cosine_;
  std::optional<Affine> to_local_;
  double stretch_;  ///< upper bound of |M^-1|
};

}  // namespace cs2mesh
