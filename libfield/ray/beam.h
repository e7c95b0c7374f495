// Bundles of rays that are cleared of empty space together.
#pragma once

#include <array>
#include <vector>

#include "libfield/base/interval.h"
#include "libfield/field/implicit_surface.h"
#include "libfield/ray/camera.h"
#include "libfield/ray/ray_solver.h"

namespace cs2mesh {

/// All rays of a view through a rectangle of its picture.
class Beam {
 public:
  /// The rectangle [x0, x1] x [y0, y1] in the coordinates of View::ray.
  Beam(const View& view, double x0, double y0, double x1, double y1);

  /// Contains ray.at(t) for all rays of the beam and t in [t0, t1], t0 >= 0.
  Aabb box(double t0, double t1) const;
  /// Upper bound of the distance between two points of the same t, at that t >= 0.
  double width(double t) const;

 private:
  std::array<Interval, 3> origin_;
  std::array<Interval, 3> direction_;
};

/// The stretches of `known`, which are in order and disjoint with t >= 0, less those where no ray
/// of the beam meets the surface, proved by enclosures of F on pieces of the beam about as long as
/// they are wide. `known` itself where the surface has no finite bounds; else the ranges are
/// finite.
std::vector<RayRange> occupied_ranges(const ImplicitSurface& surface, const Beam& beam,
                                      const std::vector<RayRange>& known, RayCost* cost = nullptr);

}  // namespace cs2mesh
