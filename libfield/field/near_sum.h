// A sum of terms of any kernels as a mesher's small boxes need it: bounds over millions of boxes at
// a microsecond each, tight where the terms are steep.
//
// Around a box, what is far from it is one quadratic polynomial with bounds of what it leaves open
// (of value and gradient), and what is near is cut into pieces no larger than their distance, each
// known in the exponent (exponent_sum.h): phi = log of the integral of exp(psi_q) over its elements
// q has the second derivative
//     D^2 phi = mean of D^2 psi_q + covariance of grad psi_q,
// of which the first lies between the kernel's bends at those distances (log_bends.h) and the
// second between 0 and a quarter of the square of how much grad psi differs within the piece. Of a
// concave log kernel over a convex piece, phi is concave (Prekopa 1973).
//
// Of the logarithm of the whole sum S, w_i = f_i / S,
//     D^2 log S = sum w_i D^2 log f_i + covariance of the grad log f_i  >=  sum w_i D^2 log f_i,
// and of a term over any elements that are added, D^2 log f_i is no less than the least of D^2 log
// h at their distances. So what is far need not be known in the exponent: it counts with its
// greatest value over the least sum.
//
// Boxes within boxes take over what is far, so that each piece becomes far once on the way down.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "libfield/base/jet2.h"
#include "libfield/field/exponent_sum.h"
#include "libfield/field/hull_bound.h"
#include "libfield/field/term_bounds.h"

namespace cs2mesh {

/// Whether a sum of a few such terms is best bounded as a NearSum: without profiles, of a kernel
/// that reaches everywhere over a segment, tapered or not, an arc or a triangle that is no sliver,
/// or of any over a point. (Near the edges of supports, all the pieces of others would be bounded
/// one by one.)
bool has_near_bounds(const Term& term);
/// Whether sums of thousands are cheap, too: not of triangles, which are cut into too many pieces,
/// nor of tapered segments, which are bounded one by one.
bool has_cheap_near_bounds(const Term& term);

/// Immutable.
class NearSum {
 public:
  /// Of those terms, which outlive it, over a finite box. Some 0.1 to 1 us a term.
  NearSum(std::span<const Term> terms, std::span<const std::uint32_t> list, const Aabb& box);
  /// Of the terms of `around` over a box within its own.
  NearSum(std::shared_ptr<const NearSum> around, const Aabb& box);
  NearSum(const NearSum&) = delete;
  NearSum& operator=(const NearSum&) = delete;
  ~NearSum();

  /// Contain the sum over each of the boxes, which lie in its own. An evaluation and some 100 ns
  /// for each near piece and box.
  void enclose(std::span<const BatchBox> boxes, std::span<Interval> out) const;
  /// A lower bound of the sum's derivative along the direction wherever in the box the sum is
  /// `total`, give or take `error`; infinite if it is so nowhere.
  double least_slope(const BatchBox& box, const Vec3d& direction, double total, double error) const;
  /// What bends and slopes of the logarithm of the sum are all over the points of the box that are
  /// within its radius of its centre. False where there is none: where terms are subtracted, or
  /// near ones have no exponent. An evaluation and some 200 ns for each near piece.
  bool hull_bound(const BatchBox& box, std::span<const Vec3d> directions, HullBound& bound) const;

 private:
  struct Builder;
  struct View;
  struct Parts;
  struct Sight;
  struct Hull;

  /// What is far: within `value_error` of the polynomial about the box's centre, its gradient
  /// within `slope_error` of the polynomial's.
  struct Far {
    Jet2 center;
    double value_error = 0.0, slope_error = 0.0;
    /// The sum over its terms of what each is at most times what its logarithm bends at most;
    /// infinite where terms are subtracted.
    double bend = 0.0;
  };

  Jet2 far_about(const BatchBox& box) const;
  Interval smooth_range(const Jet2& far, const Parts& parts, const BatchBox& box) const;
  double smooth_slope(const Jet2& far, const Parts& parts, const BatchBox& box,
                      const Vec3d& direction) const;
  bool add_to_hull(const Term& term, const Sight& sight, std::span<const Vec3d> directions,
                   Hull& hull) const;

  BatchBox box_;
  Far far_;
  std::vector<const Term*> near_;    ///< pieces with exponents
  std::vector<const Term*> others_;  ///< known by their ranges, slopes and polynomials
  std::vector<std::unique_ptr<const Term>> made_;  ///< pieces that were cut for this box
  std::shared_ptr<const NearSum> around_;          ///< owns others
};

/// A NearSum that is made when it is first asked for. Safe to use from any number of threads.
class LazyNearSum {
 public:
  /// Over a box within that of another.
  LazyNearSum(std::shared_ptr<const LazyNearSum> around, const Aabb& box)
      : around_(std::move(around)), box_(box) {}
  /// Of the terms that reach the box.
  LazyNearSum(std::span<const Term> terms, std::vector<std::uint32_t> list, const Aabb& box)
      : terms_(terms), list_(std::move(list)), box_(box) {}

  const Aabb& box() const { return box_; }
  const std::shared_ptr<const NearSum>& get() const;

 private:
  std::span<const Term> terms_;
  std::vector<std::uint32_t> list_;
  std::shared_ptr<const LazyNearSum> around_;
  Aabb box_;
  mutable std::once_flag once_;
  mutable std::shared_ptr<const NearSum> sum_;
};

}  // namespace cs2mesh
