// The one view that meshers, ray solvers and measurements have of a shape.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <span>

#include "libfield/base/aabb.h"
#include "libfield/base/interval.h"
#include "libfield/base/jet2.h"
#include "libfield/field/hull_bound.h"

namespace cs2mesh {

/// The least inner product with `direction` of a vector within those bounds; not a number or
/// infinite where they are.
inline double least_along(const std::array<Interval, 3>& bounds, const Vec3d& direction) {
  Interval sum(0.0);
  for (std::size_t i = 0; i < 3; ++i) sum = sum + Interval(direction[i]) * bounds[i];
  return sum.lo;
}

/// How fast a function grows along a direction, which need not be of length 1.
struct Rise {
  Vec3d direction;
  double slope = 0.0;
};

/// A function F over space whose surface is {F = 0}; F >= 0 counts as inside, everywhere. Immutable
/// and safe to use from any number of threads at once. Results depend on the point alone, not on
/// the points it is evaluated with.
///
/// F is continuous and piecewise smooth (a Field may step by its error budget at the faces of its
/// block lattice). Not promised: that F is a distance, or that its gradient vanishes nowhere.
class ImplicitSurface {
 public:
  virtual ~ImplicitSurface() = default;

  /// F at each point; `out` is as long as `points`.
  virtual void values(std::span<const Vec3d> points, std::span<double> out) const = 0;
  /// F and its gradient at each point. Values agree with those of values() to rounding.
  virtual void jets(std::span<const Vec3d> points, std::span<Jet> out) const = 0;
  /// F, its gradient and its second derivative at each point; where F is not smooth, those of one
  /// side. `out` is as long as `points`. Shapes that do not say more get central differences of
  /// their gradients over 1e-5 of max(1, |p|): for analytic functions of moderate numbers alone.
  virtual void second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const;

  /// Contains F(p) for every p in the box, rounding included.
  virtual Interval enclose(const Aabb& box) const = 0;
  /// Encloses F over each of the boxes, neighbours of much the same size, to tell where F keeps its
  /// sign: cheaper than one by one, and wider than enclose() except where a sign hangs on it. `out`
  /// is as long as `boxes`.
  virtual void enclose_each(std::span<const Aabb> boxes, std::span<Interval> out) const {
    for (std::size_t i = 0; i < boxes.size(); ++i) out[i] = enclose(boxes[i]);
  }
  /// Contains each component of the gradient for every p in the box; infinite where unknown.
  virtual std::array<Interval, 3> enclose_gradient(const Aabb& box) const = 0;
  /// A lower bound of the derivative of F along `direction`, per length of it, at all points of the
  /// surface in the box; infinite if there are none. Where it is positive, F changes its sign at
  /// most once along every line of that direction within the box: the surface there is a graph.
  virtual double least_slope(const Aabb& box, const Vec3d& direction) const;
  /// A direction along which F may grow all over the box where F = 0, and how fast it does so at
  /// least, as least_slope() tells. `gradient`, that of F in the middle of the box, is where the
  /// search begins. Not promised: that there is no better direction.
  virtual Rise rise(const Aabb& box, const Vec3d& gradient) const;
  /// Whether least_slope() and enclose_each() cost little more than an evaluation and stay tight
  /// where F is steep, so that millions of boxes can be asked about.
  virtual bool has_cheap_bounds() const { return false; }
  /// An upper bound, over the box, of the operator norm of the derivative of that order (1 to 4);
  /// infinite where there is none: where the derivative before it jumps, as at the edges of finite
  /// supports (from order 3 on) and the creases of solids (from order 2 on), or where none is
  /// known.
  virtual double derivative_bound(int order, const Aabb& box) const = 0;

  /// Whether hull_bound() costs no more than a few evaluations, and is about as tight as it can be
  /// where one blob is near.
  virtual bool has_cheap_hull_bounds() const { return false; }
  /// How far F or its logarithm may bend down, and how fast it grows along each of the directions,
  /// all over the convex hull of one to eight points.
  virtual HullBound hull_bound(std::span<const Vec3d> points,
                               std::span<const Vec3d> directions) const;

  /// A box that contains all of {F >= 0}; infinite sides where the set is unbounded.
  virtual Aabb bounds() const = 0;
  /// The same function (to the bit) inside `box`, cheaper to evaluate there; undefined outside. It
  /// keeps alive what it needs.
  virtual std::unique_ptr<ImplicitSurface> restrict_to(const Aabb& box) const = 0;

  // Conveniences for a single point.
  double value(const Vec3d& p) const {
    double out = 0;
    values({&p, 1}, {&out, 1});
    return out;
  }
  Jet jet(const Vec3d& p) const {
    Jet out;
    jets({&p, 1}, {&out, 1});
    return out;
  }
  Jet2 second_jet(const Vec3d& p) const {
    Jet2 out;
    second_jets({&p, 1}, {&out, 1});
    return out;
  }
};

inline Rise ImplicitSurface::rise(const Aabb& box, const Vec3d& gradient) const {
  return {gradient, least_slope(box, gradient)};
}

inline double ImplicitSurface::least_slope(const Aabb& box, const Vec3d& direction) const {
  return least_along(enclose_gradient(box), direction);
}

inline void ImplicitSurface::second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d& p = points[i];
    const double step = 1e-5 * std::max(1.0, norm(p));
    std::array<Vec3d, 3> row;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3d before = p, after = p;
      before[axis] -= step, after[axis] += step;
      row[axis] = (jet(after).gradient - jet(before).gradient) / (after[axis] - before[axis]);
    }
    const Jet first = jet(p);
    out[i] = {first.value,
              first.gradient,
              {row[0].x, row[1].y, row[2].z, 0.5 * (row[0].y + row[1].x),
               0.5 * (row[0].z + row[2].x), 0.5 * (row[1].z + row[2].y)}};
  }
}

}  // namespace cs2mesh
