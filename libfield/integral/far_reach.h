// How far many segments are from a cell: at which order the series of each may end about its
// centre, and as how few nodes it may be taken, so that each leaves little open. A lane is a
// segment.
//
// What a series leaves out of a source at d are the terms of degree m from order + 1 on,
//     |term| <= S^-nu (|x| / sqrt(S))^m |C_m(t)|,   |t| = |d.x| / (|x| sqrt(S)),
// with Gegenbauer's polynomials C_m, whose greatest value is binomial(m + 2 nu - 1, m). Within a
// ball of radius R, q = R / sqrt(S), that is at most q^m times the binomial; and it is less for a
// source that does not stand in the direction of a corner. With t = cos(theta),
//     nu = 2:    C_m = U'_(m+1) / 2,  |C_m| <= sqrt((m + 2)^2 + cot^2) / (2 sin^2),
//     nu = 1:    C_m = U_m,           |C_m| <= 1 / sin,
//     nu = 1/2:  C_m = P_m,           |C_m| <= sqrt(2 / (pi (m + 1/2) sin))  (DLMF 18.14.7),
// which rise with |t|. Where |d.x| <= c R sqrt(S), |x| is at most R, and at most c R / |t|. Up to
// |t| = c the term is greatest at c; from there to t' = sqrt(1 - 4 / m^2) the product of (c / t)^m
// and what rises is so at one of the ends, as its logarithm turns once, from falling to rising; at
// t' that is at most the binomial, and from t' on (c / t')^m times the binomial. So the term is at
// most q^m times the greater of the bound at c and binomial (c / t')^m. Relative to the binomial
// both fall with m: the terms from m on add up to no more than the one times the sum of the
// binomials' (taylor_series.h).
//
// c is that of two opposite octants of the cell: with x = +-(y_1, s_2 y_2, s_3 y_3) where all
// 0 <= y_i <= h, d.x is between h times the sum of the positive (d_1, s_2 d_2, s_3 d_3) and that of
// the negative ones. The errors of all sources are added up by pairs of octants: none of them is
// at its worst in all.
//
// For nodes see far_nodes.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "libfield/integral/far_nodes.h"
#include "libfield/integral/far_sum.h"

namespace cs2mesh {

/// The pairs of opposite octants of a cell, by the signs of their corners: bit 0 where that of y is
/// not that of x, bit 1 where that of z is not.
inline constexpr std::size_t kOctantPairs = 4;
using OctantErrors = std::array<double, kOctantPairs>;

inline double greatest(const OctantErrors& errors) {
  return *std::max_element(errors.begin(), errors.end());
}

/// The sum of the positive components of d with the signs of a pair of octants, or of the negative
/// ones, whichever is greater: d.x is at most h times that in those octants of a cell.
template <class T>
std::array<T, kOctantPairs> octant_reach(const Vec3<T>& d) {
  using std::abs;
  const T all = abs(d.x) + abs(d.y) + abs(d.z);
  const T less = d.x - d.y, more = d.x + d.y, half(0.5);
  return {half * (all + abs(more + d.z)), half * (all + abs(less + d.z)),
          half * (all + abs(more - d.z)), half * (all + abs(less - d.z))};
}

/// The factors of the bounds above for terms of degree m.
struct FarTerm {
  double step = 0.0;   ///< the binomial, relative to that of m - 1
  double rest = 0.0;   ///< the ratio of terms from here on, without q
  double turn = 0.0;   ///< t'^-m
  double alone = 0.0;  ///< the bound at c: this, and
  double cot2 = 0.0;   ///< times cot^2, times (2 sin^2)^-1, sin^-1, sin^-1/2
};

/// By degree, from 1 on; those of series that may end from degree 3 on.
using FarTerms = std::array<FarTerm, kTaylorOrder + 2>;

/// For 2 nu of 1, 2 and 4.
FarTerms far_terms(double two_nu);

/// The bound for terms of degree m >= 3, relative to q^m binomial: at most 1, for 2 nu of 1, 2 and
/// 4; c2 the square of c.
double far_share(double two_nu, int m, double c2);

/// What segments are sorted by, for 2 nu of 1, 2 and 4.
struct FarBounds {
  double two_nu = 0.0;
  FarTerms terms{};
  NodeBounds<kNodeRules.size() - 1> rules{};
  NodeBounds<kFarNodes.size()> sums{};
};

/// A cell that has segments far from it. What one leaves open is at most `most` by its order and
/// `most` by its nodes.
struct FarFrame {
  Vec3d center;
  double half = 0.0;  ///< its edge
  double most = 0.0;
};

/// How a segment is taken; not at all where the order is 0.
struct FarChoice {
  std::uint8_t order = 0, rule = 0;  ///< rule: an entry of kNodeRules
};

/// Finds how each of the segments is taken, the lowest order and the fewest nodes that will do, and
/// adds bounds of the errors of those that are.
using ChooseFar = void (*)(const FarBounds& law, const FarFrame& frame,
                           const SegmentSource* segments, const std::uint32_t* index,
                           std::size_t count, FarChoice* choices, OctantErrors& errors);

/// As how few nodes each of the segments, none of them a point, may be summed anywhere in the cell:
/// 1 + an entry of kFarNodes; 0 where the error of no number is at most `most`. Returns a bound of
/// the errors of the others.
using ChooseNodes = double (*)(const FarBounds& law, const FarFrame& frame,
                               const SegmentSource* segments, const std::uint32_t* index,
                               std::size_t count, std::uint8_t* choices);

namespace detail {

/// x^nu.
template <class T>
T far_power(double two_nu, const T& x) {
  using std::sqrt;
  return two_nu == 4.0 ? T(x * x) : two_nu == 2.0 ? x : T(sqrt(x));
}

/// 1 / |half|^2, less of points.
template <class T>
T over_squared(const T& half2) {
  using std::max;
  return T(1) / max(half2, T(1e-280));
}

inline constexpr double kCorner = 1.7320508075688774;  ///< of a cube, from its centre

/// The squared distance of the segment from -half to half to d; over_half2 = 1 / |half|^2, or less
/// of a point.
template <class T>
T distance2(const Vec3<T>& d, const Vec3<T>& half, const T& over_half2) {
  using std::max;
  using std::min;
  const T along = fma(d.x, half.x, fma(d.y, half.y, d.z * half.z));
  const T foot = max(min(T(along * over_half2), T(1)), T(-1));
  return squared_norm<T>({d.x - foot * half.x, d.y - foot * half.y, d.z - foot * half.z});
}

/// A number of nodes for a segment a lane: 1 + an entry of a list, 0 for none, and its error.
template <class T>
struct FarNodes {
  T entry{}, error{};

  template <std::size_t Count>
  FarNodes(double two_nu, const FarFrame& frame, const NodeBounds<Count>& bounds, const Vec3<T>& d,
           const Vec3<T>& half, const T& over_half2, const T& weight, const T& tau) {
    using std::abs;
    using std::sqrt;
    const T y = node_ellipse(d, half, T(sqrt(over_half2)), tau, frame.half);
    const T size = abs(weight) * far_power(two_nu, T(T(4) * y * over_half2));
    MaskOf<T> open(true);
    if (two_nu != 4.0) {
      // Within less than half of its length a segment may be clamped.
      const T nearest =
          sqrt(distance2(d, half, over_half2)) - T(kCorner * (1 + 1e-12) * frame.half);
      open = nearest * abs(nearest) * over_half2 >= T(1 + 1e-12);
    }
    T over(0), under(1), power(1);
    int nodes = 0;
    for (std::size_t i = 0; i < Count; ++i) {
      for (; nodes < bounds[i].nodes; ++nodes) power *= y;
      const NodeError<T> here(two_nu, bounds[i], y, power);
      const auto ends = open & (T(size * here.over) <= T(T(frame.most) * here.under));
      over = select(ends, here.over, over), under = select(ends, here.under, under);
      entry = select(ends, T(static_cast<double>(i + 1)), entry);
      open = open & !ends;
    }
    error = size * over / under * T(1 + 1e-12);
  }
};

/// A segment a lane, and how it is taken. None is whose weight is 0.
template <class T>
class FarSegments {
 public:
  T order{}, rule{};
  std::array<T, kOctantPairs> errors{};

  FarSegments(const FarBounds& law, const FarFrame& frame, const Vec3<T>& middle,
              const Vec3<T>& half, const T& weight, const T& tau)
      : law_(law) {
    using std::abs;
    using std::sqrt;
    const Vec3<T> d{T(frame.center.x) - middle.x, T(frame.center.y) - middle.y,
                    T(frame.center.z) - middle.z};
    const T half2 = squared_norm(half), over_half2 = over_squared(half2);
    const auto segment = half2 > T(0);
    const bool has_segments = any(segment);
    over_ = T(1) / ((has_segments ? distance2(d, half, over_half2) : squared_norm(d)) + tau);
    size_ = abs(weight) * far_power(law.two_nu, over_);
    const T q = T(kCorner * frame.half * (1 + 1e-12)) * sqrt(over_);
    find_order(q, T(frame.most), has_segments ? ends(d, half) : corners(octant_reach(d)));
    if (!has_segments) return;
    const FarNodes<T> nodes(law.two_nu, frame, law.rules, d, half, over_half2, weight, tau);
    const auto is_far = (!segment) | (nodes.entry > T(0));
    order = select(is_far, order, T(0));
    rule = select(segment, nodes.entry, T(0));
    const auto adds = segment & (order > T(0));
    for (T& sum : errors) {
      sum = select(is_far, T(sum + select(adds, nodes.error, T(0))), T(0));
    }
  }

 private:
  /// c^2 by pairs of octants, of places of that reach.
  std::array<T, kOctantPairs> corners(const std::array<T, kOctantPairs>& reach) const {
    std::array<T, kOctantPairs> c2;
    const T unit = over_ * T((1 + 1e-12) / 3);
    for (std::size_t k = 0; k < kOctantPairs; ++k) c2[k] = reach[k] * reach[k] * unit;
    return c2;
  }

  /// c^2 of all places on the segments: what it depends on is convex.
  std::array<T, kOctantPairs> ends(const Vec3<T>& d, const Vec3<T>& half) const {
    using std::max;
    const auto a = octant_reach<T>({d.x + half.x, d.y + half.y, d.z + half.z});
    const auto b = octant_reach<T>({d.x - half.x, d.y - half.y, d.z - half.z});
    std::array<T, kOctantPairs> most;
    for (std::size_t k = 0; k < kOctantPairs; ++k) most[k] = max(a[k], b[k]);
    return corners(most);
  }

  /// The bound at c without its degree, as FarTerm has it.
  struct Aside {
    T factor, cot2;
  };
  /// From 1 / sin^2.
  Aside aside(const T& c2, const T& over) const {
    using std::sqrt;
    return {law_.two_nu == 4.0   ? T(0.5) * over
            : law_.two_nu == 2.0 ? sqrt(over)
                                 : sqrt(sqrt(over)),
            c2 * over};
  }

  void find_order(const T& q, const T& most, const std::array<T, kOctantPairs>& c2) {
    using std::max;
    using std::min;
    using std::sqrt;
    static_assert(kOctantPairs == 4);
    std::array<T, kOctantPairs> sin2, over;
    // Nearer to a corner, the bound at c is more than the binomial.
    for (std::size_t k = 0; k < kOctantPairs; ++k) sin2[k] = max(T(1) - c2[k], T(1e-6));
    const T first = sin2[0] * sin2[1], second = sin2[2] * sin2[3];
    const T inverse = T(1) / (first * second);
    over = {inverse * second * sin2[1], inverse * second * sin2[0], inverse * first * sin2[3],
            inverse * first * sin2[2]};
    T greatest(1e-280), steepest(1);
    for (std::size_t k = 0; k < kOctantPairs; ++k) {
      greatest = max(greatest, c2[k]), steepest = max(steepest, over[k]);
    }
    const Aside worst = aside(greatest, steepest);
    const T to_corner = q * sqrt(greatest);
    // Of the degree where a lane ends: q^m and the binomials times that and (c q)^m; factors. All
    // times the size.
    T all(0), plain(0), aimed(0), alone(0), cot2(0), rest(0);
    MaskOf<T> open = size_ > T(0);
    T term = size_, power = size_, directed = size_;
    for (int m = 1; m <= kTaylorOrder + 1; ++m) {
      const FarTerm& by = law_.terms[static_cast<std::size_t>(m)];
      power *= q;
      term *= q * T(by.step);
      directed *= to_corner * T(by.step);
      if (m < 3) continue;
      const T left = fma(q, T(-by.rest), T(1));
      const T at_c = power * worst.factor * fma(worst.cot2, T(by.cot2), T(by.alone));
      const T ahead = directed * T(by.turn);
      const auto ends = open & (min(term, max(at_c, ahead)) <= most * left);
      all = select(ends, term, all), plain = select(ends, power, plain);
      aimed = select(ends, ahead, aimed), alone = select(ends, T(by.alone), alone);
      cot2 = select(ends, T(by.cot2), cot2), rest = select(ends, left, rest);
      order = select(ends, T(m - 1), order);
      open = open & !ends;
    }
    const T scale = T(1 + 1e-12) / max(rest, T(1e-280)), to_greatest = T(1) / greatest;
    const auto is_far = order > T(0);
    for (std::size_t k = 0; k < kOctantPairs; ++k) {
      const Aside side = aside(c2[k], over[k]);
      const T at_c = plain * side.factor * fma(side.cot2, cot2, alone);
      const T ahead = aimed * to_half(min(c2[k] * to_greatest, T(1)), T(order + T(1)));
      errors[k] = select(is_far, T(scale * min(all, max(at_c, ahead))), T(0));
    }
  }

  /// x^floor(m / 2), 0 <= x <= 1, m < 16.
  static T to_half(const T& x, T m) {
    const T x2 = x * x, x4 = x2 * x2;
    T product(1);
    const auto take = [&](double least, const T& factor) {
      const auto has = m >= T(least);
      product = select(has, T(product * factor), product);
      m = select(has, T(m - T(least)), m);
    };
    take(8, x4), take(4, x2), take(2, x);
    return product;
  }

  const FarBounds& law_;
  T over_, size_;  ///< 1 / S; the weight times S^-nu
};

}  // namespace detail
}  // namespace cs2mesh
