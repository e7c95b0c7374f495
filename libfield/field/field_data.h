// What all views of a field share.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "libfield/base/box_tree.h"
#include "libfield/field/far_field.h"
#include "libfield/field/field.h"
#include "libfield/integral/bulk.h"

namespace cs2mesh {

/// The value at the surface, T.
inline constexpr double kThreshold = 1.0;

/// The block lattice spans the bounds of the surface.
struct BlockLattice {
  Aabb domain;
  double edge = 1.0;

  bool covers(const Vec3d& p) const { return domain.contains(p); }
  /// ceil - 1: a point on a shared face belongs to the lower block.
  long index(double x, double origin) const {
    return static_cast<long>(std::ceil((x - origin) / edge)) - 1;
  }
  Aabb block(const Vec3d& p) const {
    Aabb box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<double>(index(p[axis], domain.min[axis]));
      // A hair larger than the block, so that rounding of a face never loses a term.
      box.min[axis] = domain.min[axis] + (i - 1e-9) * edge;
      box.max[axis] = domain.min[axis] + (i + 1 + 1e-9) * edge;
    }
    return box;
  }
  /// The union of the blocks that meet `box`.
  Aabb snapped(const Aabb& box) const {
    Aabb all = block(domain.clamp(box.min));
    all.include(block(domain.clamp(box.max)));
    return all;
  }
};

struct FieldData {
  /// Those of far fields come last.
  std::vector<Term> terms;
  std::size_t plain_count = 0;  ///< of the others
  std::vector<FarField> far;    ///< at most one an exponent
  /// The first of the terms: points as they are, kernel by kernel.
  std::vector<PointSource> points;
  /// Where the points of each kernel begin, and where the last ones end.
  std::array<std::uint32_t, kAllKernels.size() + 1> point_begin{};
  double error_budget = 0.0;
  Aabb bounds;
  bool in_exponents = false;  ///< all terms have has_log_bounds()
  bool near_sums = false;     ///< small boxes are bounded by a NearSum
  bool cheap_bounds = false;  ///< as in has_cheap_bounds()
  bool cheap_hulls = false;   ///< as in has_cheap_hull_bounds()
  bool positive = false;      ///< no term is subtracted
  BoxTree reach;              ///< where each plain term's influence exceeds its share of the budget
  BlockLattice lattice;

  /// The box whose terms count at a point. Beyond the lattice that is all of space if there are
  /// few, or else the point.
  Aabb block_around(const Vec3d& p) const {
    constexpr std::size_t kFew = 1024;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (lattice.covers(p)) return lattice.block(p);
    if (plain_count > kFew) return {p, p};
    return {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
  }
};

/// Adds the terms of `list`, in ascending order, at each of the points.
void add_terms(const FieldData& data, std::span<const std::uint32_t> list,
               std::span<const Vec3d> points, std::span<Jet> sums);

}  // namespace cs2mesh
