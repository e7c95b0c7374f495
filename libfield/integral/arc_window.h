// The stretches of a circular arc that a kernel reaches, and Gauss-Legendre over parts of an arc.
//
// Legend: see arc_place.h.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "libfield/integral/arc_place.h"

namespace cs2mesh {
namespace detail {

/// The stretches of an arc, or of its mirror image where alpha < 0, with |phi| <= reach: `span`
/// from `from` on, and where an arc of more than half a turn comes near to p with both ends,
/// `behind` from `behind_from` on, a turn on.
template <class T>
struct ArcWindow {
  T from, span, behind_from, behind;

  /// `whole`: all of the arc, in one piece.
  ArcWindow(const ArcFrame<T>& arc, const ArcPoint<T>& at, const T& reach, const MaskOf<T>& whole) {
    using std::abs;
    using std::max;
    using std::min;
    const T alpha = vmath::atan2(T(abs(at.sin_alpha)), at.cos_alpha);
    const T first = T(-0.5) * arc.sweep - alpha, last = T(0.5) * arc.sweep - alpha;
    from = select(whole, first, T(max(first, T(-reach))));
    const auto uncut = whole | both(first >= -reach, last <= reach);
    span = select(uncut, arc.sweep, T(max(T(0), T(min(last, reach) - from))));
    // A turn on, counted so that the two pieces of a full circle meet to the last bit.
    const T turn(2.0 * std::numbers::pi);
    behind_from = last + (turn - arc.sweep);
    const auto uncut_behind = last <= reach - turn;
    const T rest = max(T(0), T(min(T(last + turn), reach) - behind_from));
    behind = select(whole, T(0), select(uncut_behind, arc.sweep, rest));
  }
};

/// A kernel at one distance: h and 2K.
template <class T>
struct ArcFall {
  T h, slope;
};

/// Sine and cosine of half the angle from the middle of a stretch to node i of those of N on one
/// side; found when asked for.
template <std::size_t N, class T>
struct ArcTurns {
  T quarter;  ///< half the span, and half the angle

  explicit ArcTurns(const T& span) : quarter(T(0.25) * span) {}
  vmath::SineCosine<T> operator[](std::size_t i) const {
    return vmath::sin_cos_pi(T(quarter * T(kGaussLegendre<N>.node[i] * std::numbers::inv_pi)));
  }
};
/// The same for several stretches of one span.
template <std::size_t N, class T>
struct StoredArcTurns {
  std::array<vmath::SineCosine<T>, N / 2> turn;

  explicit StoredArcTurns(const T& span) {
    const ArcTurns<N, T> turns(span);
    for (std::size_t i = 0; i < N / 2; ++i) turn[i] = turns[i];
  }
  const vmath::SineCosine<T>& operator[](std::size_t i) const { return turn[i]; }
};

/// The sums over |span| from `from` on, with the turns of that span; law.at(sin^2(phi / 2)) is the
/// kernel. All terms of a value have its sign.
template <std::size_t N, class T, class Law, class Turns>
ArcSums<T> arc_stretch(const Law& law, const Turns& turns, const T& from, const T& span) {
  constexpr const GaussLegendreRule<N>& rule = kGaussLegendre<N>;
  const auto middle =
      vmath::sin_cos_pi(T((T(0.5) * from + T(0.25) * span) * T(std::numbers::inv_pi)));
  ArcSums<T> part;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const auto turn = turns[i];
    const T weight(0.5 * rule.weight[i]);
    for (const double side : {-1.0, 1.0}) {
      const T s = middle.sine * turn.cosine + T(side) * (middle.cosine * turn.sine);
      const T c = middle.cosine * turn.cosine - T(side) * (middle.sine * turn.sine);
      const auto at = law.at(T(s * s));
      const T k2 = weight * at.slope;
      part.value += weight * at.h;
      part.n0 += k2;
      part.n1 += k2 * (s * s);
      part.ns += k2 * (s * c);
    }
  }
  part.n0 *= T(0.5);
  return span * part;
}
template <std::size_t N, class T, class Law>
ArcSums<T> arc_stretch(const Law& law, const T& from, const T& span) {
  return arc_stretch<N, T>(law, ArcTurns<N, T>(span), from, span);
}

/// The jet of sums taken over the mirror image where alpha < 0, whose K is to be times `slope`.
template <class T>
JetOf<T> unmirrored_arc_jet(const ArcFrame<T>& arc, const ArcPoint<T>& at, const T& apart,
                            const ArcSums<T>& sum, const T& slope) {
  const T ns = slope * sum.ns;
  const ArcSums<T> scaled{sum.value, slope * sum.n0, slope * sum.n1,
                          select(at.sin_alpha < T(0), T(-ns), ns)};
  return arc_jet(arc, arc.radius, at, apart, scaled);
}

}  // namespace detail
}  // namespace cs2mesh
