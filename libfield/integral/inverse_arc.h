// The inverse kernels over a circular arc (thesis equations 2.9 and 2.10, which have no forms for
// arcs), in units of its radius and for amplitude 1:
//     1 / r^2:  f = 2 J1,  N0 = -(2 / q) [J1 + (q - m) J2],  N1 = -4 L1,
//               Ns = 2 sin(theta / 2) sin(alpha) w1 w2;
//     1 / r:    f = 2 F,   N0 = -(Ec + Es),  N1 = -2 Es,
//               Ns = 2 sin(theta / 2) sin(alpha) / (r1 r2 (r1 + r2)).
//
// Legend: see arc_place.h and arc_powers.h, here with v = u, m = (rho - 1)^2 + z^2,
// q = (rho + 1)^2 + z^2; r = sqrt(u), r1 and r2 its values at the ends;
//     F = int dpsi / r,  Ec = int cos^2 psi / r^3 dpsi,  Es = int sin^2 psi / r^3 dpsi.
//
// F and Ec are elliptic. As functions of the elliptic argument the ends are added exactly
// (the addition theorem), so that one pair of Carlson's integrals serves, and no difference of two
// is taken: with the Y below and X = Y^2,
//     F = RF(X, X + q, X + m),
//     Ec = RD(X, X + q, X + m) / 3 + C1 C2 / (r1 r2 sqrt(X + m)),
// where Y < 0 means an arc beyond the quarter period, its RF and RD to be taken from those of the
// half period. Es = (F - m Ec) / q has an error of eps F / q, which is nothing beside the sqrt(m)
// Ec that the gradient takes. Y = sqrt(m) cs is written without differences of its factors; the
// one that remains, in N, leaves an error of eps sqrt(m) / 2, and that moves F by eps / sqrt(q).
//
// Where p is far from the arc nodes are as good and faster, and for 1 / r^2 the only way (see
// arc_powers.h). Closer than the kernel's clamp (or 1e-13 of the size) to the arc the value at that
// distance is used, straight away from the arc, with gradient 0. Within a few ulp of the exact
// result for inputs moved by a few ulp. Finite for every finite p.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "libfield/base/jet.h"
#include "libfield/integral/arc_powers.h"
#include "libfield/integral/carlson.h"
#include "libfield/kernel/inverse.h"
#include "libfield/kernel/squared.h"

namespace cs2mesh {
namespace detail {

/// A point in the coordinates of an arc of radius 1, with rho - 1.
template <class T>
struct ArcSpot {
  ArcPoint<T> at;
  T apart;

  friend ArcSpot select(const MaskOf<T>& mask, const ArcSpot& yes, const ArcSpot& no) {
    const auto chosen = [&](const T& a, const T& b) { return select(mask, a, b); };
    return {{chosen(yes.at.x, no.at.x), chosen(yes.at.y, no.at.y), chosen(yes.at.z, no.at.z),
             chosen(yes.at.rho, no.at.rho), chosen(yes.at.cos_alpha, no.at.cos_alpha),
             chosen(yes.at.sin_alpha, no.at.sin_alpha)},
            chosen(yes.apart, no.apart)};
  }
};

/// An arc of radius 1 as seen from p.
template <class T>
struct UnitArcPlace : ArcSpot<T> {
  using ArcSpot<T>::at;
  using ArcSpot<T>::apart;
  T m, gap;                      ///< gap = q - m
  std::array<ArcEnd<T>, 2> end;  ///< their w unset
  T v1, v2;                      ///< squared distances to the ends

  UnitArcPlace(const ArcFrame<T>& arc, const ArcSpot<T>& spot)
      : ArcSpot<T>(spot), end(arc_ends(arc, spot.at)) {
    m = apart * apart + at.z * at.z;
    gap = T(4) * at.rho;
    v1 = m + gap * (end[0].sine * end[0].sine);
    v2 = m + gap * (end[1].sine * end[1].sine);
  }

  /// Whether the nearest point is no end.
  MaskOf<T> beside() const { return end[1].sine >= T(0); }
  /// Squared distance to the arc.
  T squared_distance() const { return select(beside(), m, v2); }

  /// p at the distance `least` instead, straight away from the nearest point of the arc; along the
  /// normal where p is so close that rounding decides what is straight away.
  ArcSpot<T> moved_away(const ArcFrame<T>& arc, const T& least) const {
    using std::copysign;
    using std::sqrt;
    const T d = sqrt(squared_distance());
    const auto clear = d > T(1e-3) * least;
    const T stretch = least / select(clear, d, T(1));
    // From the arc itself in the half plane of p's azimuth, where no digit of the distance is lost.
    const T beyond = select(clear, T(stretch * apart), T(0));
    const T up = select(clear, T(stretch * at.z), least);
    const T side_rho = T(1) + beyond;
    // From an end.
    const T cos_half = arc.cos_quarter * arc.cos_quarter - arc.sin_quarter * arc.sin_quarter;
    const T foot_y = copysign(arc.sin_half, at.sin_alpha);
    const T x = cos_half + select(clear, T(stretch * (at.x - cos_half)), T(0));
    const T y = foot_y + select(clear, T(stretch * (at.y - foot_y)), T(0));
    const auto on_side = both(beside(), side_rho > T(0));
    ArcPoint<T> moved = at;
    moved.z = up;
    moved.x = select(beside(), T(side_rho * at.cos_alpha), x);
    moved.y = select(beside(), T(side_rho * at.sin_alpha), y);
    const ArcPoint<T> polar = polar_of(moved);
    return {polar, select(on_side, beyond, T(polar.rho - T(1)))};
  }
};

/// w = h = 1 / u, K = slope w^2. (No common division: it would cut off distances beyond 1e75.)
template <class T>
struct SquaredArcLaw {
  T slope = T(-1);

  ArcPair<T> pair(const T& a, const T& b) const { return {T(1) / a, T(1) / b}; }
  T h(const T& w) const { return w; }
  T k(const T& w) const { return w * w; }
};
/// w = h = 1 / r, K = slope w^3.
template <class T>
struct InverseArcLaw {
  T slope = T(-0.5);

  ArcPair<T> pair(const T& a, const T& b) const {
    using std::sqrt;
    return {T(1) / sqrt(a), T(1) / sqrt(b)};
  }
  T h(const T& w) const { return w; }
  T k(const T& w) const { return w * w * w; }
};
template <class T>
SquaredArcLaw<T> arc_law(const Squared&) {
  return {};
}
template <class T>
InverseArcLaw<T> arc_law(const Inverse&) {
  return {};
}

/// Y of the head of this file: sqrt(m) times cs, the quotient of the Jacobian functions cn and sn,
/// of the elliptic argument from one end to the other.
template <class T>
T arc_cotangent(const ArcFrame<T>& arc, const UnitArcPlace<T>& p, const T& r1, const T& r2) {
  using std::abs;
  using std::copysign;
  using std::max;
  using std::min;
  const ArcEnd<T>& e1 = p.end[0];
  const ArcEnd<T>& e2 = p.end[1];
  const T cc = e1.cosine * e2.cosine, ss = e1.sine * e2.sine;
  const T n = p.m * cc + ss * (r1 * r2);
  // Y = N / D, D = sc1 - sc2, or N (sc1 + sc2) / (M delta), M positive, delta = S2^2 - S1^2 known
  // as a product: whichever has no difference; sc2 <= 0.
  const T sc1 = e2.sine * e1.cosine * r1, sc2 = e1.sine * e2.cosine * r2;
  const auto direct = sc1 >= T(0);
  const T s1c2 = e1.sine * e2.cosine;
  const T across = p.m * (e1.cosine * e1.cosine + s1c2 * s1c2) + (p.m + p.gap) * (ss * ss);
  const T delta = arc.sin_half * abs(p.at.sin_alpha);
  const T above = select(direct, n, T(-(n * (sc1 + sc2))));
  const T below = select(direct, T(sc1 - sc2), T(across * delta));
  // Infinite for a full circle, but for rounding.
  const T greatest(1e70);
  return copysign(min(T(abs(above) / max(below, T(1e-300))), greatest), above);
}

template <class T>
ArcSums<T> inverse_arc_sums(const Inverse&, const ArcFrame<T>& arc, const UnitArcPlace<T>& p,
                            const MaskOf<T>& /*lanes*/) {
  using std::sqrt;
  const T r1 = sqrt(p.v1), r2 = sqrt(p.v2);
  const T q = p.m + p.gap;
  const T y = arc_cotangent(arc, p, r1, r2);
  const T x = y * y;
  const CarlsonPair<T> pair = carlson(x, T(x + q), T(x + p.m));
  T f = pair.rf, ec = pair.rd * T(1.0 / 3.0);
  const auto beyond = y < T(0);
  if (any(beyond)) {
    const CarlsonPair<T> quarter = carlson_quarter(p.m, q);
    f = select(beyond, T(T(2) * quarter.rf - f), f);
    ec = select(beyond, T(T(2) * quarter.rd / p.m - ec), ec);
  }
  const T product = r1 * r2;
  ec += (p.end[0].cosine * p.end[1].cosine) / (product * sqrt(x + p.m));
  const T es = (f - p.m * ec) / q;
  const T turned = arc.sin_half * p.at.sin_alpha;
  return {T(2) * f, -(ec + es), T(-2) * es, T(2) * turned / (product * (r1 + r2))};
}

template <class T>
ArcSums<T> inverse_arc_sums(const Squared&, const ArcFrame<T>& arc, const UnitArcPlace<T>& p,
                            const MaskOf<T>& lanes) {
  std::array<ArcEnd<T>, 2> end = p.end;
  const Reciprocals<T> w(p.v1, p.v2);
  end[0].w = w.of_a;
  end[1].w = w.of_b;
  const ArcPowers<T> power = arc_powers(arc, p.m, T(p.m + p.gap), end, lanes);
  const T turned = arc.sin_half * p.at.sin_alpha;
  return {T(2) * power.j1, T(-2) * power.iq * (power.j1 + p.gap * power.j2), T(-4) * power.l1,
          T(2) * turned * (w.of_a * w.of_b)};
}

/// For amplitude 1 and the unit of length that makes the radius 1.
template <class K, class T>
JetOf<T> unit_inverse_arc(const K& kernel, const ArcFrame<T>& arc, const UnitArcPlace<T>& p) {
  const T one(1);
  FirstOf<T, JetOf<T>> jets;
  if constexpr (kIsDouble<T>) {
    const auto law = arc_law<T>(kernel);
    const bool done = take_far_arc(jets, arc, one, p.at, p.m, p.gap, law) ||
                      jets.take(arc_beside(arc, p.gap, p.v1, p.v2), [&] {
                        return arc_nodes(arc, one, arc.node14_x, arc.node14_y, p.at, law);
                      });
    if (done) return jets.result();
  }
  return jets.otherwise([&] {
    return arc_jet(arc, one, p.at, p.apart, inverse_arc_sums(kernel, arc, p, jets.left()));
  });
}

template <class T>
T power_of_length(const Inverse&, const T& /*inverse*/) {
  return T(1);
}
template <class T>
T power_of_length(const Squared&, const T& inverse) {
  return inverse;
}

template <class K, class T>
JetOf<T> inverse_arc(const K& kernel, const ArcFrame<T>& arc, const Vec3<T>& point) {
  using std::max;
  const T inverse = T(1) / arc.radius;
  const Vec3<T> d = inverse * Vec3<T>(point - arc.center);
  const auto near = squared_norm(d) < T(kFarSquared);
  const auto some = both(near, arc.radius * arc.sweep > T(0));
  if (!any(some)) return {};
  const ArcPoint<T> at = arc_point(arc, d);
  UnitArcPlace<T> place(arc, {at, at.rho - T(1)});
  // Keep away from the singularity.
  const T size = select(arc.sweep < T(std::numbers::pi), T(T(2) * arc.sin_half), T(2));
  const T least = max(T(T(kernel.clamp) * inverse), T(T(1e-13) * size));
  const auto close = place.squared_distance() < least * least;
  if (any(close)) {
    const ArcSpot<T> here{place.at, place.apart};
    place = UnitArcPlace<T>(arc, select(close, place.moved_away(arc, least), here));
  }
  const JetOf<T> unit = unit_inverse_arc(kernel, arc, place);
  const T scale = T(kernel.amplitude) * power_of_length(kernel, inverse);
  const JetOf<T> jet{scale * unit.value,
                     select(close, Vec3<T>{}, Vec3<T>((scale * inverse) * unit.gradient))};
  return select(some, jet, JetOf<T>{});
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class T>
JetOf<T> integral(const Inverse& kernel, const ArcFrame<T>& arc, const Vec3<T>& point) {
  return detail::inverse_arc(kernel, arc, point);
}
template <class T>
JetOf<T> integral(const Squared& kernel, const ArcFrame<T>& arc, const Vec3<T>& point) {
  return detail::inverse_arc(kernel, arc, point);
}
template <class T>
JetOf<T> integral(const Inverse& kernel, const Arc& arc, const Vec3<T>& point) {
  return integral(kernel, ArcFrame<T>(arc), point);
}
template <class T>
JetOf<T> integral(const Squared& kernel, const Arc& arc, const Vec3<T>& point) {
  return integral(kernel, ArcFrame<T>(arc), point);
}

}  // namespace cs2mesh
