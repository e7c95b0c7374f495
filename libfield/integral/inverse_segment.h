// The inverse kernels over a segment (thesis equations 2.9, 2.10 and appendix B):
//     1 / r:    f = A log(1 + 2 L / sigma),  sigma = r1 + r2 - L,
//     1 / r^2:  f = A atan2(c L, c^2 + t1 t2) / c,
//     grad f = A (M perp + (h(r1) - h(r2)) axis),  M = int 2 dh/du dt.
//
// Legend: t the abscissa along the segment counted from the foot of p on its line, t1 and t2 its
// ends, L its length; c the distance from p to the line, perp the vector from the line to p;
// r1, r2 the distances to the ends; n and g the nearer and the farther of |t1|, |t2|.
//
// Where digits would be lost the form changes:
//  - seen from afar (r1 + r2 against L) antiderivatives cancel: Gauss-Legendre with 4, 8 or 14
//    nodes, whose terms are positive and whose weights add up to L itself;
//  - sigma and the differences in M are written as sums of positive terms, by cases of the foot;
//  - behind an end (1 / r^2, c < n / 2) M is the difference of phi(c / t) / t^3, a series.
// Closer than the kernel's clamp (or 1e-13 of the size) to the segment the value at that distance
// is used, with gradient 0. Within a few ulp of the exact result for inputs moved by a few ulp.
// Finite for every finite p.
#pragma once

#include <array>
#include <cmath>

#include "libfield/base/jet.h"
#include "libfield/integral/segment_place.h"
#include "libfield/integral/special.h"
#include "libfield/kernel/inverse.h"
#include "libfield/kernel/squared.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh {
namespace detail {

/// int h dt, int 2K dt and h(r1) - h(r2), for amplitude 1.
template <class T>
struct InverseLine {
  T value{}, m{}, drop{};

  friend InverseLine select(const MaskOf<T>& mask, const InverseLine& yes, const InverseLine& no) {
    return {select(mask, yes.value, no.value), select(mask, yes.m, no.m),
            select(mask, yes.drop, no.drop)};
  }
};

/// What both kernels need of a place.
template <class T>
struct InversePlace {
  T t1, t2, length, c2, r1, r2;
};

/// phi(x) = (atan x - x / (1 + x^2)) / (2 x^3), 0 <= x <= 1/2, as a polynomial in x^2.
inline constexpr std::array<double, 14> kArcRest = {
#include "libfield/integral/arc_rest_table.inc"
};

template <std::size_t N, class T>
InverseLine<T> line_nodes(const Inverse&, const InversePlace<T>& at) {
  using std::sqrt;
  constexpr const UnitRule<N>& rule = kUnitRule<N>;
  InverseLine<T> sum;
  for (std::size_t i = 0; i < N; ++i) {
    const T t = at.t1 + at.length * T(rule.node[i]);
    const T w = T(1) / sqrt(at.c2 + t * t);
    const T first = T(rule.weight[i]) * w;
    sum.value += first;
    sum.m -= first * (w * w);
  }
  return {at.length * sum.value, at.length * sum.m, {}};
}

template <std::size_t N, class T>
InverseLine<T> line_nodes(const Squared&, const InversePlace<T>& at) {
  constexpr const UnitRule<N>& rule = kUnitRule<N>;
  InverseLine<T> sum;
  for (std::size_t i = 0; i < N; ++i) {
    const T t = at.t1 + at.length * T(rule.node[i]);
    const T w = T(1) / (at.c2 + t * t);
    const T first = T(rule.weight[i]) * w;
    sum.value += first;
    sum.m -= first * w;
  }
  return {at.length * sum.value, T(2) * at.length * sum.m, {}};
}

template <class T>
InverseLine<T> line_closed(const Inverse&, const InversePlace<T>& at) {
  using std::abs;
  const T sum1 = at.r1 + abs(at.t1), sum2 = at.r2 + abs(at.t2);
  // r - |t| = c^2 / (r + |t|): no difference where the foot lies beyond that end.
  const T sigma =
      select(at.t1 < T(0), at.c2 / sum1, sum1) + select(at.t2 > T(0), at.c2 / sum2, sum2);
  InverseLine<T> out;
  out.value = vmath::log(T(T(1) + T(2) * at.length / sigma));
  const auto inside = both(at.t1<T(0), at.t2> T(0));
  const T across = (abs(at.t2) / at.r2 + abs(at.t1) / at.r1) / at.c2;
  const T beside =
      at.length * abs(at.t1 + at.t2) / (at.r1 * at.r2 * (abs(at.t2) * at.r1 + abs(at.t1) * at.r2));
  out.m = -select(inside, across, beside);
  return out;
}

template <class T>
InverseLine<T> line_closed(const Squared&, const InversePlace<T>& at) {
  using std::abs;
  using std::max;
  using std::min;
  using std::sqrt;
  const T c = sqrt(at.c2);
  const T x = at.c2 + at.t1 * at.t2, y = c * at.length;
  InverseLine<T> out;
  const auto rest = [&](const T& f) {
    return -((at.t2 / (at.r2 * at.r2) - at.t1 / (at.r1 * at.r1)) + f) / at.c2;
  };
  if constexpr (kIsDouble<T>) {
    // atan(w) / w of a small angle seen from beside the segment needs no division by c.
    FirstOf<T, T> values;
    values.take((x > T(0)) & (y <= T(0.5) * x), [&] {
      const T w = y / x;
      const T w2 = w * w;
      return at.length / x * (T(1) + w2 * polynomial(vmath::detail::kArctan, w2));
    });
    out.value = values.otherwise([&] { return vmath::atan2(y, x) / c; });
    const T near = min(abs(at.t1), abs(at.t2)), far = max(abs(at.t1), abs(at.t2));
    const auto inside = (at.t1 > T(0)) ^ (at.t2 > T(0));
    FirstOf<T, T> ms;
    ms.take((!MaskOf<T>(inside)) & (T(2) * c < near), [&] {
      const auto tail = [&](const T& t) {
        const T inverse = T(1) / (t * t);
        return polynomial(kArcRest, T(at.c2 * inverse)) * inverse / t;
      };
      return T(-2) * (tail(near) - tail(far));
    });
    out.m = ms.otherwise([&] { return rest(out.value); });
  } else {
    out.value = vmath::atan2(y, x) / c;
    out.m = rest(out.value);
  }
  return out;
}

/// h(r1) - h(r2) = delta / (r1 r2 ...), delta = u2 - u1.
template <class T>
T drop_along(const Inverse&, const InversePlace<T>& at, const T& delta) {
  return delta / (at.r1 * at.r2 * (at.r1 + at.r2));
}
template <class T>
T drop_along(const Squared&, const InversePlace<T>& at, const T& delta) {
  const T product = at.r1 * at.r2;
  return delta / (product * product);
}

template <class K, class T>
InverseLine<T> inverse_line(const K& kernel, const InversePlace<T>& at) {
  InverseLine<T> out;
  const auto closed = [&] { return line_closed(kernel, at); };
  if constexpr (kIsDouble<T>) {
    const T reach = at.r1 + at.r2;
    FirstOf<T, InverseLine<T>> lines;
    const bool done =
        lines.take(reach > T(kReach4) * at.length, [&] { return line_nodes<4>(kernel, at); }) ||
        lines.take(reach > T(kReach8) * at.length, [&] { return line_nodes<8>(kernel, at); }) ||
        lines.take(reach > T(kReach14) * at.length, [&] { return line_nodes<14>(kernel, at); });
    out = done ? lines.result() : lines.otherwise(closed);
  } else {
    out = closed();
  }
  out.drop = drop_along(kernel, at, T(at.length * (at.t1 + at.t2)));
  return out;
}

template <class K, class T>
JetOf<T> inverse_segment(const K& kernel, const SegmentFrame<T>& segment, const Vec3<T>& point) {
  using std::max;
  using std::sqrt;
  // Keep away from the singularity.
  const T least = max(T(kernel.clamp), T(T(1e-13) * segment.length));
  SegmentPlace<T> place(segment, point);
  const auto square = [](const T& x) { return x * x; };
  const T beyond = max(T(0), max(place.t1, T(-place.t2)));
  const auto close = T(place.c2 + square(beyond)) < square(least);
  place.c2 = select(close, T(square(least) - square(beyond)), place.c2);

  const T amplitude(kernel.amplitude);
  const InversePlace<T> at{place.t1,
                           place.t2,
                           segment.length,
                           place.c2,
                           sqrt(place.c2 + square(place.t1)),
                           sqrt(place.c2 + square(place.t2))};
  const InverseLine<T> line = inverse_line(kernel, at);
  const Vec3<T> gradient =
      (amplitude * line.m) * place.perp + (amplitude * line.drop) * segment.axis;
  const JetOf<T> jet{amplitude * line.value, select(close, Vec3<T>{}, gradient)};
  return select(place.near & (segment.length > T(0)), jet, JetOf<T>{});
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class T>
JetOf<T> integral(const Inverse& kernel, const SegmentFrame<T>& segment, const Vec3<T>& point) {
  return detail::inverse_segment(kernel, segment, point);
}
template <class T>
JetOf<T> integral(const Squared& kernel, const SegmentFrame<T>& segment, const Vec3<T>& point) {
  return detail::inverse_segment(kernel, segment, point);
}
template <class T>
JetOf<T> integral(const Inverse& kernel, const Segment& segment, const Vec3<T>& point) {
  return integral(kernel, SegmentFrame<T>(segment), point);
}
template <class T>
JetOf<T> integral(const Squared& kernel, const Segment& segment, const Vec3<T>& point) {
  return integral(kernel, SegmentFrame<T>(segment), point);
}

}  // namespace cs2mesh
