// Bounds over a triangle of a function G of which little is known: values at a few points, and that
// it does not bend down by more than so much, d^T D^2 G d >= -bend |d|^2.
//
// Then G(x) + bend / 2 |x|^2 is convex. Between points G is at most what a quadratic says,
//   G(sum l_i p_i) <= sum l_i G(p_i) + bend / 2 sum_{i<j} l_i l_j |p_i - p_j|^2,
// and about a point with a known gradient it is at least G(p) + g . d - bend / 2 |d|^2. Both are
// equalities for the logarithm of one Gaussian over a point. What is between them and the function
// falls with the square of the triangle's size.
//
// Where G has kinks, as at the corners of strength profiles and the creases of solids, it is
// bounded by its slopes: if all gradients lie in a box S, so do their limits from the sides of a
// kink, and by the mean value theorem G(x) - G(p) lies in S . (x - p). What that leaves open is a
// multiple of the size by how much the gradient turns.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "libfield/base/interval.h"
#include "libfield/base/vec.h"

namespace cs2mesh {

using Corners = std::array<Vec3d, 3>;

/// A quadratic over a triangle in Bernstein form: at the corners, and the control values opposite
/// to them.
struct QuadraticNet {
  std::array<double, 3> corner{}, opposite{};

  double greatest_corner() const { return std::max({corner[0], corner[1], corner[2]}); }
  double greatest_control() const {
    return std::max({greatest_corner(), opposite[0], opposite[1], opposite[2]});
  }
  /// Of the quarter at a corner, or with 3 of that in the middle.
  QuadraticNet quarter(std::size_t which) const;
};

inline QuadraticNet QuadraticNet::quarter(std::size_t which) const {
  std::array<double, 3> middle{}, across{};  // at the middles of the sides; between two of them
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    middle[i] = 0.25 * (corner[j] + 2 * opposite[i] + corner[k]);
    across[i] = 0.25 * (corner[i] + opposite[0] + opposite[1] + opposite[2]);
  }
  if (which == 3) return {middle, across};
  const std::size_t j = (which + 1) % 3, k = (which + 2) % 3;
  QuadraticNet part;
  part.corner[which] = corner[which];
  part.corner[j] = middle[k];
  part.corner[k] = middle[j];
  part.opposite[which] = across[which];
  part.opposite[j] = 0.5 * (corner[which] + opposite[j]);
  part.opposite[k] = 0.5 * (corner[which] + opposite[k]);
  return part;
}

/// >= the quadratic over the triangle; after `depth` cuts into quarters, by its control values.
inline double upper_bound(const QuadraticNet& net, int depth) {
  const double corner = net.greatest_corner(), control = net.greatest_control();
  if (depth == 0 || control <= corner) return control;
  double most = corner;
  for (std::size_t i = 0; i < 4; ++i) most = std::max(most, upper_bound(net.quarter(i), depth - 1));
  return most;
}

/// >= G over the triangle with these corners, where it is at most `high`.
inline double highest_over(const Corners& p, const std::array<double, 3>& high, double bend) {
  constexpr int kCuts = 2;
  QuadraticNet net;
  net.corner = high;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    net.opposite[i] = 0.5 * (high[j] + high[k]) + 0.25 * bend * squared_norm(p[j] - p[k]);
  }
  return upper_bound(net, kCuts);
}

/// What is known of G at a point.
struct Tangent {
  Vec3d at;
  double low = 0.0;  ///< <= G there
  Vec3d gradient;
  /// What the gradient may be off by, in parts of it: rounding, and what far fields leave out.
  static constexpr double kSlack = 1e-8;

  /// <= G at x.
  double lowest_at(const Vec3d& x, double bend) const {
    const Vec3d d = x - at;
    return low + dot(gradient, d) - kSlack * norm(gradient) * norm(d) -
           0.5 * bend * squared_norm(d);
  }
};

/// <= G over the triangle whose corners these are, each point by the tangent at the corner that it
/// weighs most: over such a third, the least is at one of its corners.
inline double lowest_over(const std::array<Tangent, 3>& tangents, double bend) {
  const Corners p{tangents[0].at, tangents[1].at, tangents[2].at};
  const Vec3d center = (p[0] + p[1] + p[2]) / 3.0;
  double least = std::min({tangents[0].low, tangents[1].low, tangents[2].low});
  for (std::size_t i = 0; i < 3; ++i) {
    least = std::min(least, tangents[i].lowest_at(center, bend));
    for (const std::size_t j : {(i + 1) % 3, (i + 2) % 3}) {
      least = std::min(least, tangents[i].lowest_at(0.5 * (p[i] + p[j]), bend));
    }
  }
  return least;
}

/// Contains G(to) - G(from), if all gradients in between lie within `slopes`.
inline Interval change_between(const Vec3d& from, const Vec3d& to,
                               const std::array<Interval, 3>& slopes) {
  Interval change(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    change = change + slopes[i] * (Interval(to[i]) - Interval(from[i]));
  }
  return change;
}

/// Contains G less some value at each corner, over the triangle: each point by the corner that it
/// weighs most, as over such a third the change is extreme at one of its corners.
inline Interval range_over(const Corners& p, const std::array<double, 3>& at,
                           const std::array<Interval, 3>& slopes) {
  const Vec3d center = (p[0] + p[1] + p[2]) / 3.0;
  Interval range(at[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    Interval change = change_between(p[i], center, slopes);
    for (const std::size_t j : {(i + 1) % 3, (i + 2) % 3}) {
      change = hull(change, change_between(p[i], 0.5 * (p[i] + p[j]), slopes));
    }
    range = hull(range, Interval(at[i]) + hull(change, Interval(0.0)));
  }
  return range;
}

/// >= G over the triangle, where it is at most `high`, and <= G, where it is at least `low`.
inline double highest_over(const Corners& p, const std::array<double, 3>& high,
                           const std::array<Interval, 3>& slopes) {
  return range_over(p, high, slopes).hi;
}
inline double lowest_over(const Corners& p, const std::array<double, 3>& low,
                          const std::array<Interval, 3>& slopes) {
  return range_over(p, low, slopes).lo;
}

}  // namespace cs2mesh
