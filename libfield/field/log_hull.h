// Bounds over the convex hull of a few points of the logarithm of a sum of positive terms.
//
// With phi = log f of each term, L = log sum f and the weights w = f / sum f,
//   grad L = sum w grad phi,   D^2 L = sum w D^2 phi + (the covariance of the grad phi),
// and a covariance bends up only. The same holds of integrals, so of a convolution over any
// skeleton with a weight that is not negative: D^2 phi >= -c where D^2 log h >= -c of its kernel.
// Gaussians exp(-a^2 r^2) have c = 2 a^2. However steep the terms, and however they meet, L is as
// tame as its terms; and it grows along a direction along which all that matter do.
//
// What matters is told by ratios: a weight is at most 1 / sum exp of the least of phi_j - phi_i,
// and a difference of exponents is nearly linear, so that its values at the points bound it: to
// half its own bend times the square of the hull's radius.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libfield/base/aabb.h"
#include "libfield/field/hull_bound.h"
#include "libfield/field/term.h"

namespace cs2mesh {

/// Whether there are bounds in the exponent: a positive term without profiles whose kernel is
/// positive everywhere, over points, segments, arcs or triangles.
bool has_log_hull(const Term& term);
/// Whether there are such over the box: there may be even if the kernel is so stiff that exponents
/// are cut off at the term's elements.
bool has_log_hull(const Term& term, const Aabb& box);

/// Whether that costs tens of nanoseconds: a Gaussian over a point.
bool has_cheap_log_hull(const Term& term);

/// The exponents of some terms over a hull.
class LogHull {
 public:
  static constexpr std::size_t kMostPoints = 8;

  /// At most kMostPoints points, not none; the least slope along some directions is asked for, or
  /// none. All are to outlive this.
  LogHull(std::span<const Vec3d> points, std::span<const Vec3d> directions);

  /// `term` has has_log_hull(). Some 30 ns a Gaussian point, else an evaluation at each point.
  void add(const Term& term);

  /// Bend and slope of L, after all terms were added.
  void bound(HullBound& bound) const;

 private:
  struct Exponent {
    std::array<double, kMostPoints> at{};  ///< phi at the points
    double bend = 0.0;                     ///< D^2 phi >= -bend
    double rise = 0.0;                     ///< D^2 phi <= rise; may be negative
    double slope = 0.0;                    ///< the least along a direction, all over the hull
    double known = 0.0;                    ///< what `at` may be off by
    bool upper_only = false;               ///< too small for more: `at` is an upper bound
  };
  void add_by_jets(const Term& term, Exponent& exponent) const;
  std::size_t strongest() const;
  double most_over(const Exponent& a, const Exponent& b) const;
  double greatest_weight(const Exponent& term, double over_strongest) const;

  std::span<const Vec3d> points_, directions_;
  std::vector<double> support_;  ///< how far the hull reaches along each, from the centre
  double longest_ = 0.0;         ///< of the directions
  Aabb box_;
  Vec3d center_;
  double radius_ = 0.0;  ///< of a ball around the points
  std::vector<Exponent> terms_;
};

}  // namespace cs2mesh
