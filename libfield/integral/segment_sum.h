// The fields of many short segments at many places, each segment as a few nodes of Gauss-Legendre:
// the innermost loop of a far field (see field/far_field.h). Each lane of a pack holds one place
// and runs through the segments in their order.
//
// The nodes stand in pairs m + t h, m - t h about the middle m of a segment, h half of it. With
// d = p - m, the squared distances of a place p to the two, tau added, are
//     v = A -+ B,   A = |d|^2 + tau + t^2 |h|^2,   B = 2 t h.d,
// and the sums of the two powers v^-nu, v^-(nu + 1) are rational in A, B and 1 / (A^2 - B^2): a
// place costs a segment one product h.d, and each pair a few steps and half a division.
//
// Legend: nu the kernel's exponent, tau its own squared length (see taylor_series.h). Gradient:
//     -2 nu sum w v^-(nu + 1) (p - q) = -2 nu (S d - D h),
// S the sum of w v^-(nu + 1) over the nodes q, D that of w t times the difference in a pair.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "libfield/base/jet.h"
#include "libfield/integral/gauss_legendre.h"
#include "libfield/simd/lanes.h"

namespace cs2mesh {

/// The numbers of nodes that a segment may be summed as.
inline constexpr std::array<int, 6> kFarNodes = {2, 4, 6, 8, 14, 20};

/// A segment from middle - half to middle + half.
struct SegmentSource {
  Vec3d middle, half;
  double weight = 0.0;  ///< of all of it, signed
  double tau = 0.0;
};

/// v^-nu at the nodes of a pair, their sum; v^-(nu + 1), sum and difference, nearer one first.
template <class T>
struct PairFall {
  T value, slope, aside;
};

namespace detail {

/// A and B of a pair.
template <class T>
struct NodePair {
  T a, b;
};

/// Of 1 / (A^2 - B^2).
template <int TwoNu, class T>
PairFall<T> pair_fall(const NodePair<T>& pair, const T& r) {
  static_assert(TwoNu == 4 || TwoNu == 2);
  const auto& [a, b] = pair;
  const T a2 = a * a, r2 = r * r;
  const T plus = fma(b, b, a2);
  if constexpr (TwoNu == 2) return {T(2) * a * r, T(2) * plus * r2, T(4) * a * b * r2};
  const T r3 = T(2) * (r2 * r), b2 = b * b;
  return {T(2) * plus * r2, a * fma(T(3), b2, a2) * r3, b * fma(T(3), a2, b2) * r3};
}

/// What two pairs add to a segment, at the price of one division where there is no root.
template <int TwoNu, class T>
std::array<PairFall<T>, 2> falls_of(const NodePair<T>& first, const NodePair<T>& second) {
  const auto minus = [](const NodePair<T>& pair) {
    return fma(-pair.b, pair.b, T(pair.a * pair.a));
  };
  const T p = minus(first), q = minus(second);
  const T both = T(1) / (p * q);
  return {pair_fall<TwoNu>(first, T(q * both)), pair_fall<TwoNu>(second, T(p * both))};
}

template <int TwoNu, class T>
PairFall<T> fall_of(const NodePair<T>& pair) {
  using std::sqrt;
  if constexpr (TwoNu == 1) {
    const T near = T(1) / sqrt(T(pair.a - pair.b)), far = T(1) / sqrt(T(pair.a + pair.b));
    const T near3 = near * near * near, far3 = far * far * far;
    return {near + far, near3 + far3, near3 - far3};
  } else {
    return pair_fall<TwoNu>(pair, T(T(1) / fma(-pair.b, pair.b, T(pair.a * pair.a))));
  }
}

}  // namespace detail

/// The sum of value and gradient at p over the sources[index[i]], i < count, as N nodes each.
template <int TwoNu, int N, class T>
JetOf<T> segment_sum(const SegmentSource* sources, const std::uint32_t* index, std::size_t count,
                     const Vec3<T>& p) {
  using std::fma;
  constexpr std::size_t kPairs = N / 2;
  constexpr const GaussLegendreRule<N>& rule = kGaussLegendre<N>;
  JetOf<T> sum{};
  for (std::size_t i = 0; i < count; ++i) {
    const SegmentSource& source = sources[index[i]];
    const Vec3d& half = source.half;
    const Vec3<T> d{p.x - T(source.middle.x), p.y - T(source.middle.y), p.z - T(source.middle.z)};
    const T along = fma(d.x, T(half.x), fma(d.y, T(half.y), T(d.z * T(half.z))));
    const T u = fma(d.x, d.x, fma(d.y, d.y, fma(d.z, d.z, T(source.tau))));
    const T half2(squared_norm(half));
    const auto pair = [&](std::size_t k) {
      return detail::NodePair<T>{fma(T(rule.node[k] * rule.node[k]), half2, u),
                                 T(2 * rule.node[k]) * along};
    };
    PairFall<T> all{};
    const auto add = [&](std::size_t k, const PairFall<T>& fall) {
      all.value = fma(T(rule.weight[k]), fall.value, all.value);
      all.slope = fma(T(rule.weight[k]), fall.slope, all.slope);
      all.aside = fma(T(rule.weight[k] * rule.node[k]), fall.aside, all.aside);
    };
    if constexpr (TwoNu == 1) {
#pragma GCC unroll 16
      for (std::size_t k = 0; k < kPairs; ++k) add(k, detail::fall_of<TwoNu>(pair(k)));
    } else {
      if constexpr (kPairs % 2 == 1) add(0, detail::fall_of<TwoNu>(pair(0)));
#pragma GCC unroll 16
      for (std::size_t k = kPairs % 2; k < kPairs; k += 2) {
        const auto falls = detail::falls_of<TwoNu>(pair(k), pair(k + 1));
        add(k, falls[0]);
        add(k + 1, falls[1]);
      }
    }
    const T weight(0.5 * source.weight);
    sum.value = fma(weight, all.value, sum.value);
    const T slope = T(-TwoNu) * weight * all.slope, aside = T(TwoNu) * weight * all.aside;
    sum.gradient.x = fma(slope, d.x, fma(aside, T(half.x), sum.gradient.x));
    sum.gradient.y = fma(slope, d.y, fma(aside, T(half.y), sum.gradient.y));
    sum.gradient.z = fma(slope, d.z, fma(aside, T(half.z), sum.gradient.z));
  }
  return sum;
}

/// Adds segment_sum() at each of the points; where `Out` is double, the value
/// alone. The number of nodes is the which-th of kFarNodes.
template <class Out>
using AddSegments = void (*)(double two_nu, std::size_t which, const SegmentSource* sources,
                             const std::uint32_t* index, std::size_t source_count,
                             const Vec3d* points, Out* sums, std::size_t count);

}  // namespace cs2mesh
