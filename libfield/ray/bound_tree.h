// Bounds of a surface, taken once for the cells of an octree: for whoever sends many rays.
#pragma once

#include <cstdint>
#include <vector>

#include "libfield/field/implicit_surface.h"
#include "libfield/ray/ray.h"

namespace cs2mesh {

/// An octree over the bounds of a surface. Cells that the surface's enclosure proves empty are left
/// out; the others are divided while |D^2 F| over a cell is large against F's own variation there,
/// so that value and slope at the ends of a ray's way through a cell mostly decide what lies
/// between. Immutable once built; safe to use from any number of threads.
class BoundTree {
 public:
  /// Part of a ray in one cell that may hold surface.
  struct Stretch {
    double t0 = 0.0;
    double t1 = 0.0;
    double hessian = 0.0;  ///< upper bound of |D^2 F| over the cell; infinite where there is none
    double cell_edge = 0.0;
  };

  /// Takes one or two bounds for each cell, in parallel, and stops dividing at `most_cells`. The
  /// tree keeps a reference to the surface. The cells do not depend on the number of threads.
  explicit BoundTree(const ImplicitSurface& surface, std::size_t most_cells = 40000);

  const ImplicitSurface& surface() const { return surface_; }
  /// False where the surface has no finite bounds or the ray's positions, up to t1, are rounded
  /// more coarsely than the cells allow; walk() must not be called then.
  bool serves(const Ray& ray, double t1) const;
  /// Replaces `stretches` by the parts of the ray's `range` that may meet the surface, in order;
  /// neighbours share a bit-equal end. Outside them there is no surface.
  void walk(const Ray& ray, RayRange range, std::vector<Stretch>& stretches) const;

  /// |lower end| of F's enclosure over the bounds: a scale of F.
  double scale() const { return scale_; }
  std::uint64_t bounds_taken() const { return bounds_taken_; }

 private:
  struct Cell {
    std::int32_t first_child = -1;  ///< of eight; -1 for a leaf
    bool empty = false;
    double hessian = 0.0;
  };
  struct Place {
    std::size_t cell;
    Vec3d center;
    double half;  ///< half an edge
  };

  bool examine(const Place& place, Cell& cell) const;
  void descend(const Ray& ray, const Place& place, RayRange range,
               std::vector<Stretch>& stretches) const;
  static Vec3d child_center(const Place& parent, int child);

  const ImplicitSurface& surface_;
  Aabb bounds_;          ///< of the surface, with a margin
  double margin_ = 0.0;  ///< by which the cells' bounds reach beyond the cells
  double scale_ = 0.0;
  std::uint64_t bounds_taken_ = 0;
  Place root_{};
  std::vector<Cell> cells_;
};

}  // namespace cs2mesh
