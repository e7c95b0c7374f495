// The Cauchy and the Gaussian kernel over a segment with a quadratic weight inside the integral:
//     f(p) = int w h dtau,   grad f = (int 2K w dtau) perp - (int 2K tau w dtau) axis
// (field formulas, section 12: integrated weights).
//
// Legend: tau the abscissa along the segment counted from the foot of p on its line, from u at the
// end nearer to the foot to g at the other, |u| <= g (u <= 0 where the foot is on the segment); L
// its length, x = (tau - u) / L; c the distance from p to the line, perp the vector from the line
// to p; K = dh/d(r^2); o = max(u, 0) the point of the segment nearest to the foot;
// mk = int (tau - o)^k h dtau.
//
//  - About o the weight is w = w_o + w_o' (tau - o) + w_o'' (tau - o)^2 / 2, where no term is large
//    against w itself near o, and f a sum of three moments. About the foot, or about an end by its
//    powers of x, the terms would cancel where w vanishes and the kernel is narrow.
//  - Along the axis the gradient is by parts:
//        -int 2K tau w dtau = (w h)(u) - (w h)(g) + int (dw/dtau) h dtau.
//  - On a segment that is short against the kernel or its distance moments cancel:
//    Gauss-Legendre, as for the segment without weight, whose terms have the signs of w.
// Value and gradient are within a few ulp of the exact result for inputs moved by a few ulp; where
// coefficients of the weight are negative, of the size that the field has with their absolute
// values. Finite for every finite p, coordinates of the primitive and widths as frames.h says, and
// weights up to 1e100.
#pragma once

#include <array>
#include <cmath>

#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/gaussian_segment.h"

namespace cs2mesh {
namespace detail {

/// A point as seen from the end of a tapered segment that is nearer to its foot.
template <class T>
struct TaperedPlace {
  MaskOf<T> beyond;          ///< the foot is beyond that end
  T u, g, c2;                ///< c2 = c^2
  T length, inverse_length;  ///< of the segment
  T b0, b1, b2;              ///< of the weight, from the near end

  TaperedPlace(const TaperedFrame<T>& segment, const SegmentPlace<T>& at,
               const MaskOf<T>& from_start)
      : beyond(false) {
    u = select(from_start, at.t1, T(-at.t2));
    g = select(from_start, at.t2, T(-at.t1));
    beyond = u > T(0);
    c2 = at.c2;
    length = segment.axis.length;
    inverse_length = segment.inverse_length;
    b0 = select(from_start, segment.b0, segment.b2);
    b1 = segment.b1;
    b2 = select(from_start, segment.b2, segment.b0);
  }
  T origin() const { return select(beyond, u, T(0)); }
};

/// The weight about the origin of a place.
template <class T>
struct LocalWeight {
  T value, slope, half_bend;

  explicit LocalWeight(const TaperedPlace<T>& at) {
    // How far the origin is from the near end and from the far one, in lengths.
    const T x = select(at.beyond, T(0), T(-at.u * at.inverse_length));
    const T y = select(at.beyond, T(1), T(at.g * at.inverse_length));
    value = y * (y * at.b0 + T(2) * x * at.b1) + x * x * at.b2;
    const T rise0 = at.b1 - at.b0, rise1 = at.b2 - at.b1;
    slope = T(2) * (rise0 * y + rise1 * x) * at.inverse_length;
    half_bend = (rise1 - rise0) * at.inverse_length * at.inverse_length;
  }
};

/// int w h, int 2K w and -int 2K tau w.
template <class T>
struct TaperedLine {
  T value{}, across{}, along{};

  friend TaperedLine select(const MaskOf<T>& mask, const TaperedLine& yes, const TaperedLine& no) {
    return {select(mask, yes.value, no.value), select(mask, yes.across, no.across),
            select(mask, yes.along, no.along)};
  }
};

/// m0, m1, m2 of h, and h itself at the near and the far end.
template <class T>
struct Moments {
  T m0, m1, m2;
  T h_near, h_far;

  T weighted(const LocalWeight<T>& w) const {
    return w.value * m0 + w.slope * m1 + w.half_bend * m2;
  }
  T weighted_along(const LocalWeight<T>& w, const TaperedPlace<T>& at) const {
    return (at.b0 * h_near - at.b2 * h_far) + (w.slope * m0 + T(2) * w.half_bend * m1);
  }
};

/// Weights of a rule on [0, 1] times the three functions of which w is made.
template <std::size_t N>
struct TaperedRule {
  std::array<double, N> start{}, middle{}, end{};

  constexpr TaperedRule() {
    for (std::size_t i = 0; i < N; ++i) {
      const double x = kUnitRule<N>.node[i], y = kUnitRule<N>.node[N - 1 - i];  // x + y = 1
      const double weight = kUnitRule<N>.weight[i];
      start[i] = weight * (y * y);
      middle[i] = weight * (2.0 * x * y);
      end[i] = weight * (x * x);
    }
  }
};
template <std::size_t N>
inline constexpr TaperedRule<N> kTaperedRule{};

template <std::size_t N, class T>
T node_weight(const TaperedPlace<T>& at, std::size_t i) {
  constexpr const TaperedRule<N>& rule = kTaperedRule<N>;
  return T(rule.start[i]) * at.b0 + T(rule.middle[i]) * at.b1 + T(rule.end[i]) * at.b2;
}

// ---- Cauchy, of amplitude 1: h = v^-2, 2K = -4 s^2 v^-3 ----

template <std::size_t N, class T>
TaperedLine<T> tapered_cauchy_nodes(const T& s2, const TaperedPlace<T>& at, const T& p) {
  const std::array<T, N> w = cauchy_line_profile<N>(s2, at.u, at.length, p);
  TaperedLine<T> sum;
  for (std::size_t i = 0; i < N; ++i) {
    const T second = node_weight<N>(at, i) * (w[i] * w[i]);
    const T third = second * w[i];
    sum.value += second;
    sum.across += third;
    sum.along += third * (at.u + at.length * T(kUnitRule<N>.node[i]));
  }
  const T slope = T(4) * s2 * at.length;
  return {at.length * sum.value, -slope * sum.across, slope * sum.along};
}

/// The moments of v^-2, and in the same way those of v^-3, from those of order 0: with w = 1 / v
/// at the ends, by parts
///     int tau v^-2 = L (u + g) w_u w_g / 2,   int tau^2 v^-2 = (J1 - [tau w]) / (2 s^2),
///     int tau v^-3 = (w_u^2 - w_g^2) / (4 s^2),   int tau^2 v^-3 = (J2 - [tau w^2]) / (4 s^2).
template <class T>
TaperedLine<T> tapered_cauchy_moments(const T& s, const TaperedPlace<T>& at, const T& p,
                                      const Reciprocals<T>& w, const MaskOf<T>& lanes) {
  const T s2 = s * s;
  const CauchyLine<T> line = cauchy_line_long(s, at.u, at.g, at.length, p, w, lanes);
  const T half = T(0.5) / s2;
  const T h_near = w.of_a * w.of_a, h_far = w.of_b * w.of_b;
  // About the foot, then about the origin.
  const T o = at.origin();
  const auto about_origin = [&](const T& m0, const T& first, const T& second) {
    const T m1 = first - o * m0;
    return Moments<T>{m0, m1, second - o * (first + m1), h_near, h_far};
  };
  const T first = T(0.5) * (at.length * (at.u + at.g)) * (w.of_a * w.of_b);
  const Moments<T> h =
      about_origin(line.j2, first, half * (line.j1 - (at.g * w.of_b - at.u * w.of_a)));
  const Moments<T> k = about_origin(line.j3, T(0.5) * first * (w.of_a + w.of_b),
                                    T(0.5) * half * (line.j2 - (at.g * h_far - at.u * h_near)));
  const LocalWeight<T> weight(at);
  return {h.weighted(weight), T(-4) * s2 * k.weighted(weight), h.weighted_along(weight, at)};
}

/// The reach of 14 and of 8 nodes. (S + sqrt(S^2 - L^2)) / L, see gauss_legendre.h, is 5 and 18
/// instead of the 4.2 and 13 of a segment without weight: three-fold poles close together, a weight
/// that vanishes at the near end and grows as the square of the ellipse, and another factor tau in
/// the gradient cost 1e3 and 1e2.
inline constexpr double kTaperedReach14 = 2.6;
inline constexpr double kTaperedReach8 = 9.0;

template <class T>
TaperedLine<T> tapered_line(const Cauchy& kernel, const TaperedPlace<T>& at) {
  using std::sqrt;
  const T s(kernel.s);
  const T s2 = s * s;
  const T p = T(1) + s2 * at.c2;
  const T v1 = p + s2 * (at.u * at.u), v2 = p + s2 * (at.g * at.g);
  const Reciprocals<T> w(v1, v2);
  TaperedLine<T> line;
  if constexpr (kIsDouble<T>) {
    // The squared sum of the distances of the ends to the poles.
    const T reach = v1 + v2 + T(2) * sqrt(v1 * v2);
    const T scale = s2 * (at.length * at.length);
    FirstOf<T, TaperedLine<T>> lines;
    const bool done = lines.take(reach > T(kReach4 * kReach4) * scale, [&] {
      return tapered_cauchy_nodes<4>(s2, at, p);
    }) || lines.take(reach > T(kTaperedReach8 * kTaperedReach8) * scale, [&] {
      return tapered_cauchy_nodes<8>(s2, at, p);
    }) || lines.take(reach > T(kTaperedReach14 * kTaperedReach14) * scale, [&] {
      return tapered_cauchy_nodes<14>(s2, at, p);
    });
    line = done
               ? lines.result()
               : lines.otherwise([&] { return tapered_cauchy_moments(s, at, p, w, lines.left()); });
  } else {
    line = tapered_cauchy_moments(s, at, p, w, true);
  }
  const T amplitude(kernel.amplitude);
  return {amplitude * line.value, amplitude * line.across, amplitude * line.along};
}

// ---- Gaussian: 2K = -2 a^2 h ----

/// Wide number types: about the foot in closed form, with digits to spare.
template <class T>
requires(!kIsDouble<T>) TaperedLine<T> tapered_line(const Gaussian& kernel,
                                                    const TaperedPlace<T>& at) {
  const T a(kernel.a);
  const T half = T(0.5) / (a * a);
  const GaussianLine<T> line = gaussian_line(kernel, at.u, at.g, at.length, at.c2);
  const auto h = [&](const T& t) {
    return bounded_exp(T(T(kernel.log_amplitude) - a * a * (at.c2 + t * t)));
  };
  const T h_near = h(at.u), h_far = h(at.g), o = at.origin();
  const T first = half * line.drop;
  const T second = half * (line.value - (at.g * h_far - at.u * h_near));
  const Moments<T> moments{line.value, first - o * line.value,
                           second - o * (T(2) * first - o * line.value), h_near, h_far};
  const LocalWeight<T> weight(at);
  const T value = moments.weighted(weight);
  return {value, T(-2) * a * a * value, moments.weighted_along(weight, at)};
}

/// From this on, of delta beyond the foot and of 4 (a g)^2 >= (a L)^2 on the segment, moments lose
/// at most two bits: beyond the foot m2 is a difference of tails, of which 1 - e^-2 (1 + 2 + 2) =
/// 0.32 remains; on the segment a g >= 0.7, where int exp(-t^2) over [0, a g] is 3.4 times its
/// difference to a g exp(-(a g)^2). Up to it 14 nodes are exact to 1e-20, eight to 4e-18 up to
/// kFlatDelta.
inline constexpr double kSteepDelta = 2.0;

/// What the forms over doubles have in common; lengths in units of 1 / a.
template <class T>
struct GaussianPlace {
  T near, far, length;  ///< |u|, g and L
  T delta, q;           ///< far^2 - near^2 and L^2
  T top;                ///< h at the origin
  T below_top, h_near;  ///< exp(-near^2) where the origin is the foot, else 1; top times that

  /// h at x = (tau - u) / L is h_near exp(-(b x + q x^2)).
  T b(const MaskOf<T>& beyond) const {
    const T size = T(2) * near * length;
    return select(beyond, size, T(-size));
  }
};

/// The profile at nodes, in units of h_near.
template <std::size_t N, class T>
TaperedLine<T> tapered_gaussian_nodes(const T& a2, const TaperedPlace<T>& at, const T& h_near,
                                      const std::array<T, N>& profile) {
  T value(0), along(0);
  for (std::size_t i = 0; i < N; ++i) {
    const T term = node_weight<N>(at, i) * profile[i];
    value += term;
    along += term * (at.u + at.length * T(kUnitRule<N>.node[i]));
  }
  const T scale = h_near * at.length;
  return {scale * value, T(-2) * a2 * scale * value, T(2) * a2 * scale * along};
}

template <class T>
std::array<T, 14> steep_gaussian_profile(const T& b, const T& q) {
  std::array<T, 14> e;
  for (std::size_t i = 0; i < 14; ++i) {
    const T x(kUnitRule<14>.node[i]);
    e[i] = vmath::exp(T(-(b + q * x) * x));
  }
  return e;
}

/// The foot on the segment: moments about the foot, by parts.
template <class T>
Moments<T> gaussian_moments_on(const T& a, const TaperedPlace<T>& at, const GaussianPlace<T>& of) {
  const T fall = -vmath::expm1(T(-of.delta)), rest = T(1) - fall;
  const T half = T(0.5) / (a * a);
  Moments<T> m;
  m.h_near = of.h_near;
  m.h_far = of.h_near * rest;
  m.m0 = T(kHalfRootPi) / a * of.top * erf_sum(of.near, of.far, of.below_top, rest);
  m.m1 = half * (of.h_near * fall);
  m.m2 = half * (m.m0 - (at.g * m.h_far - at.u * m.h_near));
  return m;
}

/// The foot beyond the near end: moments about that end as differences of tails. With G = far,
/// Lambda = L and E = exp(-delta), all in units of 1 / a, the tail beyond the far end is
///     int_Lambda^inf xi^k exp(-2 near xi - xi^2) dxi = E int_0^inf (Lambda + xi)^k exp(-2 G xi -
///     ...).
template <class T>
Moments<T> gaussian_moments_beyond(const T& a, const GaussianPlace<T>& of) {
  const T rest = vmath::exp(T(-of.delta));
  const ErfcxMoments<T> i = erfcx_moments(of.near), j = erfcx_moments(of.far);
  const T unit = T(1) / a, scale = of.top * unit, shift = of.length;
  Moments<T> m;
  m.h_near = of.top;
  m.h_far = of.top * rest;
  m.m0 = scale * (i.i0 - rest * j.i0);
  m.m1 = scale * unit * (i.i1 - rest * (shift * j.i0 + j.i1));
  m.m2 = scale * (unit * unit) * (i.i2 - rest * (shift * (shift * j.i0 + T(2) * j.i1) + j.i2));
  return m;
}

template <class T>
requires(kIsDouble<T>) TaperedLine<T> tapered_line(const Gaussian& kernel,
                                                   const TaperedPlace<T>& at) {
  using std::abs;
  const T a(kernel.a);
  const T a2 = a * a;
  GaussianPlace<T> of;
  of.near = a * abs(at.u), of.far = a * at.g, of.length = a * at.length;
  of.delta = a2 * (at.length * (at.u + at.g));
  of.q = of.length * of.length;
  const T across = T(kernel.log_amplitude) - a2 * at.c2;
  const T exponent = select(at.beyond, T(across - of.near * of.near), across);
  const auto alive = exponent > T(kLeastExponent);
  if (!any(alive)) return {};
  of.top = bounded_exp(exponent);
  of.below_top = select(at.beyond, T(1), T(vmath::exp(T(-of.near * of.near))));
  of.h_near = of.top * of.below_top;

  const T variation = select(at.beyond, of.delta, of.q);
  const T steepness = select(at.beyond, of.delta, T(T(4) * of.far * of.far));
  const T b = of.b(at.beyond);
  FirstOf<T, TaperedLine<T>> lines(alive);
  const bool done = lines.take(variation <= T(kFlatDelta), [&] {
    return tapered_gaussian_nodes<8>(a2, at, of.h_near, flat_gaussian_profile(b, of.q));
  }) || lines.take(steepness <= T(kSteepDelta), [&] {
    return tapered_gaussian_nodes<14>(a2, at, of.h_near, steep_gaussian_profile(b, of.q));
  });
  if (done) return lines.result();
  const LocalWeight<T> weight(at);
  const auto of_moments = [&](const Moments<T>& m) {
    const T value = m.weighted(weight);
    return TaperedLine<T>{value, T(-2) * a2 * value, m.weighted_along(weight, at)};
  };
  lines.take(at.beyond, [&] { return of_moments(gaussian_moments_beyond(a, of)); });
  lines.take(alive, [&] { return of_moments(gaussian_moments_on(a, at, of)); });
  return lines.result();
}

template <class K, class T>
JetOf<T> tapered_segment(const K& kernel, const TaperedFrame<T>& segment, const Vec3<T>& point) {
  const SegmentPlace<T> at(segment.axis, point);
  if (!any(at.near)) return {};
  // |t1| <= |t2|; where both round to the same, their sign tells.
  const auto from_start = T(at.t1 + at.t2) >= T(0);
  const TaperedLine<T> line = tapered_line(kernel, TaperedPlace<T>(segment, at, from_start));
  const T along = select(from_start, line.along, T(-line.along));
  const JetOf<T> jet{line.value, line.across * at.perp + along * segment.axis.axis};
  return select(at.near, jet, JetOf<T>{});
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class T>
JetOf<T> integral(const Cauchy& kernel, const TaperedFrame<T>& segment, const Vec3<T>& point) {
  return detail::tapered_segment(kernel, segment, point);
}
template <class T>
JetOf<T> integral(const Gaussian& kernel, const TaperedFrame<T>& segment, const Vec3<T>& point) {
  return detail::tapered_segment(kernel, segment, point);
}
template <class T>
JetOf<T> integral(const Cauchy& kernel, const TaperedSegment& segment, const Vec3<T>& point) {
  return integral(kernel, TaperedFrame<T>(segment), point);
}
template <class T>
JetOf<T> integral(const Gaussian& kernel, const TaperedSegment& segment, const Vec3<T>& point) {
  return integral(kernel, TaperedFrame<T>(segment), point);
}

}  // namespace cs2mesh
