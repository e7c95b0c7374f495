// The Gaussian kernel over a segment:
//     f(p) = int_t1^t2 exp(log A - a^2 (c^2 + t^2)) dt,
//     grad f = -2 a^2 f perp + (h(r1) - h(r2)) axis.
//
// Legend: t the abscissa along the segment counted from the foot of p on its line, t1 and t2 its
// ends, L its length; c the distance from p to the line, perp the vector from the line to p;
// n and g the nearer and the farther of |t1|, |t2|; delta = a^2 (g^2 - n^2).
//
//  - Foot on the segment: sqrt(pi) / (2a) exp(log A - a^2 c^2) (erf(a g) + erf(a n)).
//  - Foot outside: the difference of erf loses all digits; with erfcx it is
//        sqrt(pi) / (2a) exp(log A - a^2 (c^2 + n^2)) (erfcx(a n) - exp(-delta) erfcx(a g)).
//  - Either loses digits on a segment so short that the exponent varies by less than 0.35 along it;
//    there eight Gauss-Legendre nodes give the last bit (a L <= 0.6: relative error 4e-18), and
//    weights that add up to L rather than to t2 - t1 keep the length exact.
// One exponent holds the amplitude and the distance, cut off at Gaussian::kGreatestExponent, so
// stiff kernels do not overflow. Value and gradient are within a few ulp of the exact result for
// inputs moved by a few ulp. Finite for every finite p.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "libfield/base/jet.h"
#include "libfield/integral/segment_place.h"
#include "libfield/integral/special.h"
#include "libfield/kernel/gaussian.h"

namespace cs2mesh {
namespace detail {

inline constexpr double kFlatDelta = 0.35;

/// exp(-(b x + q x^2)) at eight nodes, for |b x + q x^2| <= kFlatDelta on [0, 1].
template <class T>
std::array<T, 8> flat_gaussian_profile(const T& b, const T& q) {
  constexpr const UnitRule<8>& rule = kUnitRule<8>;
  std::array<T, 8> y, e;
  for (std::size_t i = 0; i < 8; ++i) {
    y[i] = -(b + q * T(rule.node[i])) * T(rule.node[i]);
    e[i] = T(1.0 / 6227020800.0);
  }
  // Taylor to degree 13: the next term is below 5e-18.
  constexpr std::array<double, 13> kInverseFactorial = {1.0 / 479001600.0,
                                                        1.0 / 39916800.0,
                                                        1.0 / 3628800.0,
                                                        1.0 / 362880.0,
                                                        1.0 / 40320.0,
                                                        1.0 / 5040.0,
                                                        1.0 / 720.0,
                                                        1.0 / 120.0,
                                                        1.0 / 24.0,
                                                        1.0 / 6.0,
                                                        0.5,
                                                        1.0,
                                                        1.0};
  for (const double c : kInverseFactorial) {
    for (std::size_t i = 0; i < 8; ++i) e[i] = e[i] * y[i] + T(c);
  }
  return e;
}

/// int_0^1 exp(-(b x + q x^2)) dx for |b x + q x^2| <= kFlatDelta on [0, 1].
template <class T>
T flat_gaussian(const T& b, const T& q) {
  constexpr const UnitRule<8>& rule = kUnitRule<8>;
  const std::array<T, 8> e = flat_gaussian_profile(b, q);
  T sum(0);
  for (std::size_t i = 0; i < 4; ++i) sum += T(rule.weight[i]) * (e[i] + e[7 - i]);
  return sum;
}

/// exp, with the exponent cut off.
template <class T>
T bounded_exp(const T& exponent) {
  const T greatest(Gaussian::kGreatestExponent);
  return vmath::exp(select(exponent < greatest, exponent, greatest));
}

/// The integral over t1 <= t <= t2 = t1 + length at squared distance c2, and h(r1) - h(r2).
template <class T>
struct GaussianLine {
  T value{}, drop{};

  friend GaussianLine select(const MaskOf<T>& mask, const GaussianLine& yes,
                             const GaussianLine& no) {
    return {select(mask, yes.value, no.value), select(mask, yes.drop, no.drop)};
  }
};

/// Wide number types: the closed form with digits to spare.
template <class T>
requires(!kIsDouble<T>) GaussianLine<T> gaussian_line(const Gaussian& kernel, const T& t1,
                                                      const T& t2, const T& /*length*/,
                                                      const T& c2) {
  using std::acos;
  using std::erf;
  using std::erfc;
  using std::sqrt;
  const T a(kernel.a);
  const T across = T(kernel.log_amplitude) - a * a * c2;
  const T x1 = a * t1, x2 = a * t2;
  const T between = x1 > T(0)   ? T(erfc(x1) - erfc(x2))
                    : x2 < T(0) ? T(erfc(T(-x2)) - erfc(T(-x1)))
                                : T(erf(x2) - erf(x1));
  const T half_root_pi = sqrt(acos(T(-1))) / T(2);
  return {half_root_pi / a * bounded_exp(across) * between,
          bounded_exp(T(across - x1 * x1)) - bounded_exp(T(across - x2 * x2))};
}

inline constexpr double kHalfRootPi = 0.5 / std::numbers::inv_sqrtpi;
/// Fields below exp of this count as 0: on the way to the smallest double, arithmetic is slow.
inline constexpr double kLeastExponent = -700.0;

/// erf(near) + erf(far) with exp(-near^2) and exp(near^2 - far^2) given; near <= far.
template <class T>
T erf_sum(const T& near, const T& far, const T& at_near, const T& tail) {
  // Below 1 the sum of erfcx would cancel.
  FirstOf<T, T> sums;
  sums.take(far < T(1), [&] { return small_erf(near) + small_erf(far); });
  return sums.otherwise([&] { return T(2) - at_near * (erfcx(near) + tail * erfcx(far)); });
}

template <class T>
requires(kIsDouble<T>) GaussianLine<T> gaussian_line(const Gaussian& kernel, const T& t1,
                                                     const T& t2, const T& length, const T& c2) {
  using std::abs;
  using std::copysign;
  using std::max;
  using std::min;
  const T a(kernel.a);
  const T a2 = a * a;
  const T sum = t1 + t2;
  const T near = a * min(abs(t1), abs(t2));
  const T far = a * max(abs(t1), abs(t2));
  const T across = T(kernel.log_amplitude) - a2 * c2;
  const auto on_segment = MaskOf<T>((t1 > T(0)) ^ (t2 > T(0)));
  const T exponent = select(on_segment, across, T(across - near * near));
  const auto alive = exponent > T(kLeastExponent);
  if (!any(alive)) return {};
  const T delta = a2 * (length * abs(sum));
  const T fall = -vmath::expm1(T(-delta));
  const T top = bounded_exp(exponent);
  const T below_top =
      any(on_segment) ? select(on_segment, vmath::exp(T(-near * near)), T(1)) : T(1);
  const T at_near = top * below_top;
  const T q = a2 * (length * length);
  const T scale = T(kHalfRootPi) / a * top;
  FirstOf<T, T> values(alive);
  values.take(select(on_segment, q, delta) <= T(kFlatDelta), [&] {
    const T b = T(2) * near * (a * length);
    return length * at_near * flat_gaussian(select(on_segment, -b, b), q);
  });
  values.take(on_segment, [&] { return scale * erf_sum(near, far, below_top, T(1) - fall); });
  const T value =
      values.otherwise([&] { return scale * (erfcx(near) - (T(1) - fall) * erfcx(far)); });
  return select(alive, GaussianLine<T>{value, copysign(at_near * fall, sum)}, GaussianLine<T>{});
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class T>
JetOf<T> integral(const Gaussian& kernel, const SegmentFrame<T>& segment, const Vec3<T>& point) {
  const SegmentPlace<T> at(segment, point);
  if (!any(at.near)) return {};
  const T a(kernel.a);
  const detail::GaussianLine<T> line =
      detail::gaussian_line(kernel, at.t1, at.t2, segment.length, at.c2);
  const JetOf<T> jet{line.value,
                     (T(-2) * (a * a) * line.value) * at.perp + line.drop * segment.axis};
  return select(at.near, jet, JetOf<T>{});
}

template <class T>
JetOf<T> integral(const Gaussian& kernel, const Segment& segment, const Vec3<T>& point) {
  return integral(kernel, SegmentFrame<T>(segment), point);
}

}  // namespace cs2mesh
