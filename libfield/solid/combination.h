// Intersections and unions of implicit surfaces: the minimum or maximum of their functions.
#pragma once

#include <memory>
#include <vector>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

enum class CombinationKind { intersection, union_of };

/// F = min F_i (intersection) or max F_i (union). Bounds of derivatives of second order exist where
/// one F_i provably decides alone; enclosures are those of the F_i that may decide.
class Combination final : public ImplicitSurface {
 public:
  /// `parts` must not be empty.
  Combination(CombinationKind kind, std::vector<std::shared_ptr<const ImplicitSurface>> parts);

  void values(std::span<const Vec3d> points, std::span<double> out) const override;
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override;
  void second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const override;
  Interval enclose(const Aabb& box) const override;
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override;
  double derivative_bound(int order, const Aabb& box) const override;
  Aabb bounds() const override;
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb& box) const override;

 private:
  /// The parts that may decide somewhere in the box.
  std::vector<const ImplicitSurface*> deciding(const Aabb& box) const;

  CombinationKind kind_;
  std::vector<std::shared_ptr<const ImplicitSurface>> parts_;
};

}  // namespace cs2mesh
