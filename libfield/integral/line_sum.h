// The Cauchy kernel over many segments at many places, to a small part of the kernel's strength:
// the closed form of cauchy_segment.h alone, which is never judged nor replaced. Each lane of a
// pack holds one place and runs through the segments in their order.
//
// With d1 and d2 from the ends of a segment to p, h half of it, and along it, u from -1 to 1,
//     q(u) = |p - q_u|^2 + tau,   q1 = q(-1),   q2 = q(1),   x = d1.d2 + tau,   H = |h|^2,
//     K = H tau + |d1 x h|^2   (= H q - (q' / 2)^2 for every u),
// the integrals J_k of q^-k over u are, since h.d1 = (q1 - x) / 2 and -h.d2 = (q2 - x) / 2,
//     J1 = atan2(2 sqrt(K), x) / sqrt(K),
//     J2 = (H J1 + 1 - x (1 / q1 + 1 / q2) / 2) / (2 K),
//     J3 = (3 H J2 + ((1 - x / q1) / q1 + (1 - x / q2) / q2) / 2) / (4 K),
// and with w the weight of all of the segment
//     f = w J2 / 2,   grad f = -2 w / H (J3 h x (d1 x h) - (q1^-2 - q2^-2) / 4 h).
//
// |x| <= sqrt(q1 q2), one of q1 and q2 is at most (1 + 2 sqrt(H / tau))^2 times the other, and
// K >= H tau: what rounding does to f, beside what it does to places and ends, stays below
// line_rounding(), however much the sums cancel, and to the gradient below some ten times
// tau^(-1/2) of that.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "libfield/integral/segment_sum.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh {

/// What rounding leaves open of the field of one segment, but for that of places and ends: some ulp
/// of its field, were it endless, at a place on it. Infinite where the arithmetic may overflow
/// within `reach` of it.
inline double line_rounding(const SegmentSource& segment, double reach) {
  constexpr double kUlps = 128, kGreatest = 1e9, kGreatestRoot = 1e15;
  const double half = norm(segment.half), root = std::sqrt(segment.tau);
  const bool is_moderate = half * kGreatest > root && std::max(half, reach) < kGreatest * root &&
                           root * kGreatestRoot > 1 && root < kGreatestRoot;
  if (!is_moderate) return std::numeric_limits<double>::infinity();
  return kUlps * std::numeric_limits<double>::epsilon() * std::abs(segment.weight) /
         (half * half * segment.tau) * (1 + half / root);
}

namespace detail {

template <class T>
Vec3<T> in_lanes(const Vec3d& x) {
  return {T(x.x), T(x.y), T(x.z)};
}

/// x.y + more.
template <class T>
T inner(const Vec3<T>& x, const Vec3<T>& y, const T& more) {
  using std::fma;
  return fma(x.x, y.x, fma(x.y, y.y, fma(x.z, y.z, more)));
}

/// x cross y.
template <class T>
Vec3<T> outer(const Vec3<T>& x, const Vec3<T>& y) {
  using std::fma;
  return {fma(x.y, y.z, T(-(x.z * y.y))), fma(x.z, y.x, T(-(x.x * y.z))),
          fma(x.x, y.y, T(-(x.y * y.x)))};
}

/// J1 and J2 of a stretch, from sqrt(K), 1 / K, the sine and the cosine of the angle times the same
/// factor, H, and what J2 has beside H J1 in its brackets.
template <class T>
struct LineIntegrals {
  T j1, j2;

  LineIntegrals(const T& root, const T& over_k, const T& sine, const T& cosine, const T& squared,
                const T& ends) {
    using std::fma;
    j1 = vmath::upper_angle(sine, cosine) * (root * over_k);
    j2 = fma(squared, j1, ends) * (T(0.5) * over_k);
  }
};

}  // namespace detail

/// The sum of value and gradient at p over the sources[index[i]], i < count.
template <class T>
JetOf<T> line_sum(const SegmentSource* sources, const std::uint32_t* index, std::size_t count,
                  const Vec3<T>& p) {
  using detail::inner;
  using std::fma;
  using std::sqrt;
  JetOf<T> sum{};
  for (std::size_t i = 0; i < count; ++i) {
    const SegmentSource& source = sources[index[i]];
    const Vec3<T> h = detail::in_lanes<T>(source.half);
    const Vec3<T> from = p - detail::in_lanes<T>(source.middle - source.half);
    // Not from the other end: rounded in its own way, that would not fit to h.
    const Vec3<T> to = from - detail::in_lanes<T>(2.0 * source.half);
    const T tau(source.tau);
    const double squared = squared_norm(source.half);
    const T q1 = inner(from, from, tau), q2 = inner(to, to, tau), x = inner(from, to, tau);
    const Vec3<T> c = detail::outer(from, h);
    const T k = inner(c, c, T(squared * source.tau)), root = sqrt(k);

    // All reciprocals by one division.
    const T both = q1 * q2, over_all = T(1) / (both * k);
    const T over_k = both * over_all, over_both = k * over_all;
    const T ends = fma(T(-0.5) * x, q1 + q2, both) * over_both;
    const detail::LineIntegrals<T> line(root, over_k, T(root + root), x, T(squared), ends);
    sum.value = fma(T(0.5 * source.weight), line.j2, sum.value);

    const T over1 = q2 * over_both, over2 = q1 * over_both;
    const T ends2 = T(0.5) * fma(fma(-x, over1, T(1)), over1, T(fma(-x, over2, T(1)) * over2));
    const T j3 = fma(T(3 * squared), line.j2, ends2) * (T(0.25) * over_k);
    const double slope = -2.0 * source.weight / squared;
    const T across = T(slope) * j3;
    const T along = T(-0.25 * slope) * fma(over1, over1, T(-(over2 * over2)));
    const Vec3<T> away = detail::outer(h, c);
    sum.gradient.x = fma(across, away.x, fma(along, h.x, sum.gradient.x));
    sum.gradient.y = fma(across, away.y, fma(along, h.y, sum.gradient.y));
    sum.gradient.z = fma(across, away.z, fma(along, h.z, sum.gradient.z));
  }
  return sum;
}

/// Adds line_sum() at each of the points; where `Out` is double, the value alone.
template <class Out>
using AddLines = void (*)(const SegmentSource* sources, const std::uint32_t* index,
                          std::size_t source_count, const Vec3d* points, Out* sums,
                          std::size_t count);

}  // namespace cs2mesh
