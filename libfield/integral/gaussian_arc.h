// The Gaussian kernel over a circular arc, an incomplete Bessel function:
//     f = c exp(log A - a^2 m) int exp(-kappa sin^2(phi / 2)) dphi,   kappa = 4 a^2 c rho,
//     grad f as in arc_place.h with K = -a^2 h.
//
// Legend: see arc_place.h; S = sin(phi / 2), S0 its value at the point of the arc nearest to p, so
// that the integrand over exp(-kappa S0^2) is at most 1; w = sqrt(kappa) phi / 2.
//
// Gauss-Legendre with 20 nodes a panel, at most 5 of them, in the window kappa (S^2 - S0^2) <= 37,
// beyond which e^-37 = 9e-17 is left. The error of N nodes on a panel is below 4.3 M rho^-2N, M the
// greatest modulus of the integrand on the ellipse rho = s + sqrt(s^2 + 1) about it, s its smaller
// half axis, for any s. With H half a panel in phi, |exp(-kappa S^2)| is at most
// exp(kappa / 2 (cosh(H s) - 1)) there, so for
//     H <= 4.1 / sqrt(kappa + 4):  kappa / 2 (cosh(H s) - 1) - 40 asinh s < -40.3
// for some s, whatever kappa: 1.3e-17 of the greatest value in the window. Where the nearest point
// is an end, the integrand falls from there on like exp(-g x), 0 <= x <= 1, g <= 37, at worst; then
// M is exp(g / 2 (cosh - 1)), and a panel with g <= 20 errs by exp(-52): two of them do, at least
// where kappa (S^2 - S0^2) > 18. For a short or wide arc, g <= 2 and H sqrt(kappa + 2) <= 0.6,
// eight nodes have exp(-38.9); for g <= 12 and H sqrt(kappa + 4) <= 2.2 fourteen have exp(-40).
// A stiff kernel near the arc, kappa >= 100 and S0^2 kappa <= 4, has an expansion. With
// w = sqrt(kappa) S,
//     int h dphi = 2 / sqrt(kappa) sum b_j kappa^-j int w^2j e^(-w^2) dw,
// b_j the coefficients of (1 - x)^(-1/2). Integrals to infinity follow from erfc by recurrences of
// positive terms, and where the exponent falls by more than 2 along the arc, differences of them
// lose a factor of 4 at most. What follows j = 14 is below 7e-18.
// All terms of a value are positive, but for those differences. One exponent holds the amplitude
// and the distance, cut off at Gaussian::kGreatestExponent, so stiff kernels do not overflow. Value
// and gradient are within a few ulp of the exact result for inputs moved by a few ulp. Finite for
// every finite p.
#pragma once

#include <array>
#include <cmath>

#include "libfield/base/jet.h"
#include "libfield/integral/arc_window.h"
#include "libfield/integral/gaussian_segment.h"

namespace cs2mesh {
namespace detail {

inline constexpr double kArcFall = 37.0;
inline constexpr double kMostArcPanels = 8.0;

/// exp(x) for |x| < 700.
template <class T>
T moderate_exp(const T& x) {
  const vmath::detail::Exponential<T> e(x);
  return scaled_by_rounded(T(T(1) + e.rest), T(e.k + T(kRounder)));
}

/// h, and 2K over -2 a^2, which is the same: exp(-kappa (S^2 - S0^2)).
template <class T>
struct GaussianArcLaw {
  T kappa, least;  ///< least = S0^2

  ArcFall<T> at(const T& s2) const {
    using std::max;
    using std::min;
    // Within [-37, 0], but for rounding, which has no bound of its own.
    const T h = moderate_exp(T(max(T(-60), min(T(-kappa * (s2 - least)), T(1)))));
    return {h, h};
  }
};

/// The sums over a piece, in as many panels of 20 nodes as it takes.
template <class T>
ArcSums<T> gaussian_arc_piece(const GaussianArcLaw<T>& law, const T& from, const T& span,
                              const T& least_count) {
  using std::max;
  using std::min;
  using std::sqrt;
  // (Five; the bound is for lanes of packs that have overflowed, whose result is not used.)
  const T panels = -vmath::floor(T(span * sqrt(law.kappa + T(4)) * T(-1.0 / 8.2)));
  const T count = min(T(kMostArcPanels), T(max(least_count, panels)));
  const T width = span / count;
  const StoredArcTurns<20, T> turns(width);
  ArcSums<T> sum;
  for (T i(0); any(i < count); i += T(1)) {
    const T here = select(i < count, width, T(0));
    sum += arc_stretch<20, T>(law, turns, T(from + i * width), here);
  }
  return sum;
}

inline constexpr double kStiffArc = 100.0;
/// b_j.
inline constexpr std::array<double, 15> kRootPowers = {1.0,
                                                       1.0 / 2,
                                                       3.0 / 8,
                                                       5.0 / 16,
                                                       35.0 / 128,
                                                       63.0 / 256,
                                                       231.0 / 1024,
                                                       429.0 / 2048,
                                                       6435.0 / 32768,
                                                       12155.0 / 65536,
                                                       46189.0 / 262144,
                                                       88179.0 / 524288,
                                                       676039.0 / 4194304,
                                                       1300075.0 / 8388608,
                                                       5014575.0 / 33554432};

/// sum b_j kappa^-j Gj and sum b_j kappa^-j G(j + 1).
template <class T>
struct StiffArc {
  T value, squared;
};

/// Gj = int_w^inf t^2j exp(w^2 - t^2) dt, G0 given.
template <class T>
StiffArc<T> stiff_arc_tail(const T& w, T g, const T& per_kappa) {
  T power = T(0.5) * w, scale(1);
  StiffArc<T> sum{T(0), T(0)};
  for (std::size_t j = 0; j < kRootPowers.size(); ++j) {
    const T b = T(kRootPowers[j]) * scale;
    sum.value += b * g;
    g = power + T(static_cast<double>(j) + 0.5) * g;
    sum.squared += b * g;
    power *= w * w;
    scale *= per_kappa;
  }
  return sum;
}

/// The sums by the expansion; w of the ends, the nearer second, cut off where nothing is left.
template <class T>
ArcSums<T> stiff_arc_sums(const T& kappa, const T& w1, const T& w2, const MaskOf<T>& beside) {
  using std::sqrt;
  const T per_kappa = T(1) / kappa;
  const T half_root_pi(kHalfRootPi);
  const StiffArc<T> all = stiff_arc_tail(T(0), half_root_pi, per_kappa),
                    far = stiff_arc_tail(w1, T(half_root_pi * erfcx(w1)), per_kappa),
                    near = stiff_arc_tail(w2, T(half_root_pi * erfcx(w2)), per_kappa);
  // All that is over the value at the nearest point.
  const T at_far = moderate_exp(T(select(beside, T(0), T(w2 * w2)) - w1 * w1));
  const T at_near = select(beside, moderate_exp(T(-w2 * w2)), T(1));
  const T sign = select(beside, T(-1), T(1));
  const auto between = [&](const T& whole, const T& near_part, const T& far_part) {
    const T rest = sign * (at_near * near_part) - at_far * far_part;
    return select(beside, T(T(2) * whole + rest), rest);
  };
  const T scale = T(2) * sqrt(per_kappa);
  const T value = scale * between(all.value, near.value, far.value);
  const T squared = scale * per_kappa * between(all.squared, near.squared, far.squared);
  return {value, T(0.5) * value, squared, per_kappa * (at_far - at_near)};
}

/// The sums by nodes; `fall` is that of the exponent along the arc.
template <class T>
ArcSums<T> gaussian_arc_nodes(const ArcFrame<T>& arc, const ArcPoint<T>& at,
                              const GaussianArcLaw<T>& law, const T& fall, const MaskOf<T>& lanes) {
  using std::max;
  using std::min;
  using std::sqrt;
  const T top = law.least + T(kArcFall) / max(law.kappa, T(1e-300));
  const T bound = min(top, T(1));
  const T reach = T(2) * vmath::atan2(T(sqrt(bound)), T(sqrt(T(1) - bound)));
  const ArcWindow<T> window(arc, at, reach, top >= T(1));
  FirstOf<T, ArcSums<T>> sums(lanes);
  const T turn2 = arc.sweep * arc.sweep;
  const bool done = sums.take(both(fall <= T(2), turn2 * (law.kappa + T(2)) <= T(1.44)),
                              [&] { return arc_stretch<8>(law, window.from, window.span); }) ||
                    sums.take(both(fall <= T(12), turn2 * (law.kappa + T(4)) <= T(19.36)),
                              [&] { return arc_stretch<14>(law, window.from, window.span); });
  if (done) return sums.result();
  return sums.otherwise([&] {
    const T least_count = select(fall > T(18), T(2), T(1));
    ArcSums<T> sum = gaussian_arc_piece(law, window.from, window.span, least_count);
    if (any(window.behind > T(0))) {
      sum += gaussian_arc_piece(law, window.behind_from, window.behind, least_count);
    }
    return sum;
  });
}

/// The sums with K over -2 a^2, h over its greatest value on the arc.
template <class T>
ArcSums<T> gaussian_arc_sums(const ArcFrame<T>& arc, const ArcPoint<T>& at, const T& kappa,
                             const std::array<ArcEnd<T>, 2>& end) {
  using std::max;
  using std::min;
  using std::sqrt;
  const auto beside = end[1].sine >= T(0), past_antipode = end[0].cosine < T(0);
  const T far_end = end[0].sine * end[0].sine, near_end = end[1].sine * end[1].sine;
  const T least = select(beside, T(0), near_end);
  const T fall = kappa * (select(past_antipode, T(1), T(max(near_end, far_end))) - least);
  // The far end comes back into reach after the antipode.
  const auto returns = past_antipode & (kappa * (far_end - least) <= T(kArcFall));
  const auto stiff = both(kappa >= T(kStiffArc), kappa * least <= T(4), fall > T(2));
  FirstOf<T, ArcSums<T>> sums;
  const bool done = sums.take(stiff & !returns, [&] {
    const auto w = [&](const T& squared_sine) {
      return min(T(sqrt(kappa * squared_sine)), T(6.5));
    };
    return stiff_arc_sums(kappa, select(past_antipode, T(6.5), w(far_end)), w(near_end), beside);
  });
  if (done) return sums.result();
  return sums.otherwise([&] {
    return gaussian_arc_nodes(arc, at, GaussianArcLaw<T>{kappa, least}, fall, sums.left());
  });
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class T>
requires(kIsDouble<T>) JetOf<T> integral(const Gaussian& kernel, const ArcFrame<T>& arc,
                                         const Vec3<T>& point) {
  const Vec3<T> d = point - arc.center;
  const auto near = squared_norm(d) < T(kFarSquared);
  const T a2 = T(kernel.a) * T(kernel.a), c = arc.radius;
  const detail::ArcPoint<T> at = detail::arc_point(arc, d);
  const auto end = detail::arc_ends(arc, at);
  const T apart = at.rho - c;
  const T kappa = T(4) * a2 * (c * at.rho);
  const auto square = [](const T& x) { return x * x; };
  const T least = select(end[1].sine < T(0), square(end[1].sine), T(0));
  const T exponent = T(kernel.log_amplitude) - a2 * (apart * apart + at.z * at.z) - kappa * least;
  const auto alive = near & (exponent > T(detail::kLeastExponent));
  if (!any(alive)) return {};
  const detail::ArcSums<T> sum = detail::gaussian_arc_sums(arc, at, kappa, end);
  const JetOf<T> jet = detail::bounded_exp(exponent) *
                       detail::unmirrored_arc_jet(arc, at, apart, sum, T(T(-2) * a2));
  return select(alive, jet, JetOf<T>{});
}
inline Jet integral(const Gaussian& kernel, const Arc& arc, const Vec3d& point) {
  return integral(kernel, ArcFrame<double>(arc), point);
}

}  // namespace cs2mesh
