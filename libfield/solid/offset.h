// The offset solid of a primitive: every point within the radius of it (thesis 3.3.5).
// F(p) = R - distance(M^-1 p, primitive).
#pragma once

#include <optional>
#include <variant>

#include "libfield/base/affine.h"
#include "libfield/field/implicit_surface.h"
#include "libfield/primitive/polygon.h"
#include "libfield/primitive/primitive.h"

namespace cs2mesh {

/// A sphere, a capsule, an arc tube with round ends, a thick triangle or polygon with a round rim,
/// a slab. Smooth but for the creases at the reflex corners of a polygon and across from an arc.
/// Gradient and second derivative are 0 on the primitive itself, where F has its ridge.
class Offset final : public ImplicitSurface {
 public:
  using Shape = std::variant<Point, Segment, Arc, Triangle, Plane, TaperedSegment, Polygon>;
  /// `to_local`: M^-1 where the solid is transformed by M, none for the identity; radius > 0.
  Offset(Shape shape, double radius, std::optional<Affine> to_local = std::nullopt);

  void values(std::span<const Vec3d> points, std::span<double> out) const override;
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override;
  void second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const override;
  Interval enclose(const Aabb& box) const override;
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override;
  double derivative_bound(int order, const Aabb& box) const override;
  Aabb bounds() const override;
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb& box) const override;

 private:
  Jet jet_at(const Vec3d& p) const;
  Symmetric3 hessian_at(const Vec3d& p) const;

  Shape shape_;
  double radius_;
  std::optional<Affine> to_local_;
  double stretch_;  ///< upper bound of |M^-1|
};

}  // namespace cs2mesh
