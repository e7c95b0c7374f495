// What is known of a term, and of sums of terms, over boxes. Rounding of the evaluation included.
//
// Over a box with centre p0, a term is either a Taylor polynomial with a bound of its remainder or,
// where the box is large against the term's kernel, a range. Polynomials add up before they are
// bounded, so that gradients of neighbours cancel.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "libfield/base/interval.h"
#include "libfield/field/term.h"

namespace cs2mesh {

/// Neighbouring boxes, bounded together: what the bounds of a term need of each primitive is
/// computed once for all of them, over their hull.
struct BoxBatch {
  explicit BoxBatch(std::span<const Aabb> boxes);
  std::span<const Aabb> boxes;  ///< finite
  std::vector<Vec3d> centers;
  double radius = 0.0;  ///< the largest half diagonal, rounded up
  Aabb hull;
};

/// For every p in the box, the sum is
///   center.value + center.gradient . (p - p0) + e + some number of `range`,
///   |e| <= 1/2 hessian |p - p0|^2 + deviation + rounding.
struct SumBound {
  Jet center;
  double hessian = 0.0;
  double deviation = 0.0;
  double rounding = 0.0;  ///< of the value at the centre: 64 ulp or more of each term's magnitude
  Interval range{0.0};
};

/// Adds what is known of `term` to sums[i] for boxes[i]. A term whose range over the hull has a
/// width up to `negligible` is taken as that range: nothing tighter is looked for. Cost: some 100
/// to 500 ns, and an evaluation a box; for a kernel much smaller than the boxes, some 300 ns a box.
void add_bounds(const Term& term, const BoxBatch& batch, double negligible,
                std::span<SumBound> sums);

/// Contains the sum over `box`, which has the bound `sum` of `terms` terms.
Interval range_of(const SumBound& sum, std::size_t terms, const Aabb& box);

/// Each component of the gradient of f lies in its interval, at every point of the box.
std::array<Interval, 3> gradient_bound(const Term& term, const Aabb& box);

/// >= |D^2 f| on the box; infinite where there is no bound, as where a profile is not constant.
double hessian_bound(const Term& term, const Aabb& box);

}  // namespace cs2mesh
