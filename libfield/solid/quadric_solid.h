// The solid whose surface is a quadric: F(p) = -q(p) / k, with k the slope of q at its vertices, so
// that F is the distance from the surface to first order there.
#pragma once

#include <memory>

#include "libfield/field/implicit_surface.h"
#include "libfield/primitive/quadric.h"

namespace cs2mesh {

/// The bounds of the quadric are not looked at. F is a polynomial: enclosures are tight to
/// rounding, the second derivative is constant, third and fourth are 0.
class QuadricSolid final : public ImplicitSurface {
 public:
  /// The quadric transformed by `to_world`; null where all coefficients but the constant are 0, or
  /// where they are of so different a size that numbers on the way are not finite.
  static std::shared_ptr<const QuadricSolid> make(const Quadric& quadric,
                                                  const Affine& to_world = {});

  const QuadricForm& form() const { return form_; }

  void values(std::span<const Vec3d> points, std::span<double> out) const override;
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override;
  void second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const override;
  Interval enclose(const Aabb& box) const override;
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override;
  double derivative_bound(int order, const Aabb& box) const override;
  /// Finite where the quadric is, as for an ellipsoid and across a cylinder.
  Aabb bounds() const override;
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb& box) const override;

 private:
  QuadricSolid() = default;
  Jet2 at(const Vec3d& p) const { return evaluate(scaled_, p - form_.center); }
  /// What rounding may do to a value at up to that distance from the center.
  double rounding(double distance) const;

  QuadricForm form_;  ///< in scene coordinates, as all here
  Quadric scaled_;    ///< F as a polynomial of p - center
};

}  // namespace cs2mesh
