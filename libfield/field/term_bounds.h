// What is known of a term, and of sums of terms, over boxes. Rounding of the evaluation included.
//
// Over a box with centre p0, a term is either a Taylor polynomial with a bound of its remainder or,
// where the box is large against the term's kernel, a range. Polynomials add up before they are
// bounded, so that gradients and curvatures of neighbours cancel.
//
// The second derivative at the centre is a difference quotient of gradients, which cost a few
// nanoseconds each in packs whatever the pair; what it is off by is part of the remainder.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "libfield/base/interval.h"
#include "libfield/base/jet2.h"
#include "libfield/field/implicit_surface.h"
#include "libfield/field/term.h"

namespace cs2mesh {

struct BatchBox {
  BatchBox() = default;
  explicit BatchBox(const Aabb& box);
  /// The centre, then a step along each axis: where gradients are taken for the second order.
  std::array<Vec3d, 4> points() const;

  Aabb box;
  Vec3d center;
  Vec3d half;           ///< edges, rounded up
  double radius = 0.0;  ///< half the diagonal, rounded up
  Vec3d step;           ///< the sides of difference quotients; 0 where there is no room for one
};

/// The second derivative at the centre of the box as the difference quotient of gradients at the
/// four points of a box; what it is off by is at most quotient_error().
Symmetric3 difference_quotient(std::span<const Jet> jets, const BatchBox& box);
/// `inner` bounds |D^3 f| between those points, `gradient_error` what the gradients are off by.
/// Infinite where the steps are lost in the rounding of coordinates.
double quotient_error(const BatchBox& box, double inner, double gradient_error);

/// The order of the polynomials: with second ones, the better of the two is taken for each term.
enum class TaylorOrder { first, second };

/// Neighbouring boxes, bounded together: what the bounds of a term need of each primitive is
/// computed once for all of them, over their hull.
struct BoxBatch {
  BoxBatch(std::span<const BatchBox> boxes, TaylorOrder order);

  std::span<const BatchBox> boxes;  ///< finite
  TaylorOrder order;
  double radius = 0.0;  ///< the largest
  Aabb hull;

  /// The number of points at which gradients are taken for each box.
  std::size_t stride() const { return order == TaylorOrder::first ? 1 : 4; }
  /// Appends those points, box by box.
  void append_points(std::size_t first, std::size_t count, std::vector<Vec3d>& points) const;
};

/// For every p in the box, the sum is, with d = p - p0,
///   center.value + center.gradient . d + 1/2 d^T hessian d + e + some number of `range`,
///   |e| <= remainder + deviation + rounding.
struct SumBound {
  Jet2 center;
  double remainder = 0.0;
  double deviation = 0.0;
  double rounding = 0.0;  ///< of the value at the centre: 64 ulp or more of each term's magnitude
  Interval range{0.0};

  /// Adds factor times the function with those jets at the stride() points of the box.
  void add_polynomial(double factor, std::span<const Jet> jets, const BatchBox& box);
  /// Adds the function to the order that leaves less open: these are the remainders.
  void add_polynomial(std::span<const Jet> jets, double first, double second, const BatchBox& box);
};

/// What a quadratic whose second derivative is a difference quotient leaves open over the box:
/// bounds of |D^3 f| within half the box (step and all) and beyond, and of the errors of gradients.
double second_remainder(const BatchBox& box, double inner, double outer, double gradient_error);

/// Adds what is known of `term` to sums[i] for boxes[i]. A term whose range over the hull has a
/// width up to `negligible` is taken as that range: nothing tighter is looked for. Cost: some 100
/// to 500 ns, and an evaluation a box, four for second order; for a kernel much smaller than the
/// boxes, some 300 ns a box.
void add_bounds(const Term& term, const BoxBatch& batch, double negligible,
                std::span<SumBound> sums);

/// Contains the sum over the box, which has the bound `sum` of `terms` terms.
Interval range_of(const SumBound& sum, std::size_t terms, const BatchBox& box);

/// For every p in the box, with d = p - p0, the gradient of the sum is
///   center + hessian d + e + some vector of `range`,  |e| <= remainder;
/// it also lies in `plain`, to which each term adds on its own.
struct GradientSum {
  Vec3d center;
  Symmetric3 hessian;
  double remainder = 0.0;
  std::array<Interval, 3> range{}, plain{};

  /// Adds the function with those jets at the four points of the box, to the order that leaves less
  /// open: these are the remainders. Those of the first go into `plain`.
  void add_polynomial(std::span<const Jet> jets, double first, double second, const BatchBox& box);
  /// Contains each component over the box.
  std::array<Interval, 3> bound(const BatchBox& box) const;
};

/// Adds what is known of the gradient of `term`. Some 200 ns to 1 us, and four evaluations.
void add_gradient_bound(const Term& term, const BatchBox& box, GradientSum& sum);

/// What second_remainder() is to values, to gradients.
double second_gradient_remainder(const BatchBox& box, double inner, double outer,
                                 double gradient_error);

/// >= the operator norm of the derivative of f of that order (2, 3, 4) on the box; infinite where
/// there is no bound, as where a profile is not constant.
double derivative_bound(const Term& term, int order, const Aabb& box);

}  // namespace cs2mesh
