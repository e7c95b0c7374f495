// Quadrature of any kernel over a segment, an arc or a triangle: the way for pairs without a closed
// form, and the oracle for those with one.
//
// Legend: K = dh/du, u = r^2; for a segment, c the distance from p to its line, t the abscissa
// counted from the foot of p, perp the vector from the line to p:
//     f = int h dt,   grad f = perp int 2K dt - axis int 2K t dt,   u = c^2 + t^2.
// For an arc, phi the angle counted from the azimuth of p, rho and z the cylindrical coordinates of
// p, u = m + 4 c rho sin^2(phi / 2), m = (rho - c)^2 + z^2:
//     f = c int h dphi,   grad f = 2c [((rho - c) N0 + c N1) e_rho - c Ns e_phi + z N0 n],
//     N0 = int K, N1 = int K (1 - cos phi), Ns = int K sin phi.
// Triangles: see quadrature_triangle.h.
//
// All integrands of a value have one sign, so rounding stays at a few ulp of the result; panels
// follow the singularities of the kernel in the complex plane (Cauchy: u = -1/s^2; inverse
// kernels and metaballs: u = 0), the fall of the Gaussian, and the edges of a support. The work is
// bounded. Finite for every finite p: closer than the clamp (or 1e-13 of the size) to the
// primitive, an inverse kernel gives the value at that distance with gradient 0.
#pragma once

#include <numbers>
#include <type_traits>

#include "libfield/base/jet.h"
#include "libfield/integral/panel.h"
#include "libfield/kernel/kernel.h"
#include "libfield/primitive/primitive.h"

namespace cs2mesh {

namespace detail {

template <class K>
inline constexpr bool kIsPolynomial = std::is_same_v<K, Soft> || std::is_same_v<K, Quartic>;
template <class K>
inline constexpr bool kIsInverse = std::is_same_v<K, Inverse> || std::is_same_v<K, Squared>;

/// w^2 where the kernel is singular at u = -w^2.
template <class K>
double singular_offset(const K& kernel) {
  if constexpr (std::is_same_v<K, Cauchy>) return 1.0 / (kernel.s * kernel.s);
  return 0.0;
}

/// Radii at which a derivative of the kernel jumps; infinite if there are none.
template <class K>
std::array<double, 2> kinks(const K& kernel) {
  if constexpr (std::is_same_v<K, Metaball>) return {kernel.radius, kernel.radius / 3.0};
  return {kernel.support(), kernel.support()};
}

/// Half the chord that a ball of that radius cuts out of a line at squared distance c2.
inline double half_chord(double radius, double c2) {
  const double c = std::sqrt(c2);
  return c < radius ? std::sqrt((radius - c) * (radius + c)) : 0.0;
}

// A Gaussian panel spans at most this many widths 1 / a, and this change of the exponent: fourteen
// nodes then leave an error of 1e-18. Beyond a fall of kGaussianEnd nothing is left.
inline constexpr double kGaussianSpan = 2.0;
inline constexpr double kGaussianChange = 8.0;
inline constexpr double kGaussianEnd = 45.0;

/// int h, int 2K, int 2K t over a segment.
struct LineMoments {
  double f = 0.0, m = 0.0, s = 0.0;

  template <class K>
  void add(const K& kernel, double weight, double u, double t) {
    const double k2 = 2.0 * weight * kernel.slope(u);
    f += weight * kernel.profile(u);
    m += k2;
    s += k2 * t;
  }
  /// Adds a panel whose abscissae were counted in that direction.
  void add_panel(double length, double sign, const LineMoments& part) {
    f += length * part.f;
    m += length * part.m;
    s += length * sign * part.s;
  }
};

template <class K>
Panel line_verdict(const K& kernel, double c2, const Piece& piece, double o, double length,
                   double reach) {
  const double t = piece.start + o;
  if constexpr (kIsPolynomial<K>) {
    return Panel::take;
  } else if constexpr (std::is_same_v<K, Gaussian>) {
    const double a2 = kernel.a * kernel.a;
    if (a2 * o * (piece.start + t) > kGaussianEnd) return Panel::skip;
    const bool smooth =
        kernel.a * length <= kGaussianSpan && a2 * length * (2.0 * t + length) <= kGaussianChange;
    return smooth ? Panel::take : Panel::split;
  } else {
    if constexpr (std::is_same_v<K, Metaball>) {
      const double end = t + length;
      if (9.0 * (c2 + end * end) <= kernel.radius * kernel.radius * (1.0 + 1e-12)) {
        return Panel::take;
      }
    }
    const Singularity s{0.0, std::sqrt(c2 + singular_offset(kernel))};
    return clear_of(s, t, t + length, reach) ? Panel::take : Panel::split;
  }
}

/// The weight of a plain segment.
struct EvenWeight {
  double operator()(double /*t*/) const { return 1.0; }
};

/// The moments over t1 <= t <= t2 = t1 + length at squared distance c2 from the line, weighted.
template <class Moments = LineMoments, class K, class Weight = EvenWeight>
Moments line_moments(const K& kernel, double c2, double t1, double t2, double length, double reach,
                     const Weight& weight = {}) {
  Moments sum;
  const Pieces pieces = pieces_of(t1, t2, length);
  for (std::size_t i = 0; i < pieces.count; ++i) {
    const Piece& piece = pieces.piece[i];
    const auto take = [&](double o, double panel) {
      constexpr int kOrder = kIsPolynomial<K> ? 4 : kPanelOrder;
      const UnitRule<kOrder>& rule = kUnitRule<kOrder>;
      Moments part;
      for (std::size_t j = 0; j < kOrder; ++j) {
        const double t = piece.start + (o + rule.node[j] * panel);
        part.add(kernel, rule.weight[j] * weight(piece.sign * t), c2 + t * t, t);
      }
      sum.add_panel(panel, piece.sign, part);
    };
    const auto decide = [&](double o, double panel) {
      return line_verdict(kernel, c2, piece, o, panel, reach);
    };
    if (kernel.support() < std::numeric_limits<double>::infinity()) {
      const auto [outer, inner] = kinks(kernel);
      const double end = half_chord(outer, c2) - piece.start;
      if (!(end > 0.0)) continue;
      const std::array<double, 1> cut{half_chord(inner, c2) - piece.start};
      visit_between(std::min(end, piece.length), cut,
                    [&](double o, double panel) { visit_panels(o, panel, decide, take); });
    } else {
      visit_panels(0.0, piece.length, decide, take);
    }
  }
  return sum;
}

/// Where an inverse kernel is evaluated in place of `p`, which is too close to the primitive: at
/// `least` from it, straight away from its nearest point `foot`, or along `aside` from there where
/// p is so close that rounding decides what is straight away.
inline Vec3d moved_away(const Vec3d& p, const Vec3d& foot, const Vec3d& aside, double least) {
  const Vec3d away = p - foot;
  const double d = norm(away);
  return foot + least * (d > 1e-3 * least ? away / d : aside);
}

/// No field is left at that distance, so that panels need not look for it.
template <class K, class P>
bool vanishes(const K& kernel, const P& primitive, const Vec3d& p) {
  if constexpr (std::is_same_v<K, Gaussian>) {
    const double d = kernel.a * distance(primitive, p);
    return kernel.log_amplitude - d * d < -760.0;
  } else {
    return false;
  }
}

/// Where p is as seen from a segment of some length.
struct LineView {
  Vec3d axis, perp;
  double t1, t2, length;

  LineView(const Segment& segment, const Vec3d& p) {
    const Vec3d side = segment.b - segment.a;
    length = norm(side);
    axis = side / length;
    const Vec3d da = p - segment.a;
    const Vec3d db = p - segment.b;
    t1 = -dot(da, axis);
    t2 = -dot(db, axis);
    const Vec3d& nearer = std::abs(t1) < std::abs(t2) ? da : db;
    perp = cross(axis, cross(nearer, axis));
  }
};

template <class Moments, class K, class Weight = EvenWeight>
Moments moments(const K& kernel, const LineView& at, double reach, const Weight& weight = {}) {
  return line_moments<Moments>(kernel, squared_norm(at.perp), at.t1, at.t2, at.length, reach,
                               weight);
}

template <class K>
Jet segment_quadrature(const K& kernel, const Segment& segment, const Vec3d& p, double reach) {
  const LineView at(segment, p);
  const auto sum = moments<LineMoments>(kernel, at, reach);
  return {sum.f, sum.m * at.perp - sum.s * at.axis};
}

/// int h, N0, N1, Ns over an arc.
struct ArcMoments {
  double f = 0.0, n0 = 0.0, n1 = 0.0, ns = 0.0;

  /// `half` the angle, `sine` of it.
  template <class K>
  void add(const K& kernel, double weight, double u, double half, double sine) {
    const double k = weight * kernel.slope(u);
    f += weight * kernel.profile(u);
    n0 += k;
    n1 += 2.0 * k * sine * sine;
    ns += 2.0 * k * sine * std::cos(half);
  }
  /// Adds a panel whose angles were counted in that direction.
  void add_panel(double length, double sign, const ArcMoments& part) {
    f += length * part.f;
    n0 += length * part.n0;
    n1 += length * part.n1;
    ns += length * sign * part.ns;
  }
};

/// u(phi) = m + 4 c rho sin^2(phi / 2).
struct ArcDistance {
  double m, q;  ///< q = 4 c rho
  double operator()(double phi) const {
    const double s = std::sin(0.5 * phi);
    return m + q * (s * s);
  }
  /// The angle at which the distance reaches `radius`; 0 if never below it, pi if never above.
  double angle_of(double radius) const {
    const double x =
        std::sqrt(m) < radius ? (radius - std::sqrt(m)) * (radius + std::sqrt(m)) : 0.0;
    return x >= q ? std::numbers::pi : 2.0 * std::asin(std::sqrt(x / q));
  }
};

template <class K>
Panel arc_verdict(const K& kernel, const ArcDistance& u, const Piece& piece, double o,
                  double length, double reach) {
  constexpr double kSmooth = 1.6;  // short enough for the sines themselves
  const double phi = piece.start + o;
  if (kernel.support() < std::numeric_limits<double>::infinity()) {
    // Pieces are cut at the support: all of this one is inside or all outside.
    const double middle = u(phi + 0.5 * length);
    if (middle >= kernel.support() * kernel.support()) return Panel::skip;
    if (kIsPolynomial<K> || 9.0 * middle < kernel.support() * kernel.support()) {
      return length <= kSmooth ? Panel::take : Panel::split;
    }
  }
  if (length > kSmooth) return Panel::split;
  if constexpr (std::is_same_v<K, Gaussian>) {
    const double a2 = kernel.a * kernel.a;
    const double here = u(phi), there = u(phi + length);
    const double end = piece.start + piece.length;
    const double least = end < 2.0 * std::numbers::pi ? std::min(u(piece.start), u(end)) : u.m;
    const bool rises_only = phi + length <= std::numbers::pi || phi >= std::numbers::pi;
    if (rises_only && a2 * (std::min(here, there) - least) > kGaussianEnd) return Panel::skip;
    const bool smooth = 0.5 * kernel.a * std::sqrt(u.q) * length <= kGaussianSpan &&
                        a2 * std::abs(there - here) <= kGaussianChange;
    return smooth ? Panel::take : Panel::split;
  } else {
    const double w2 = singular_offset(kernel);
    const double height = 2.0 * std::asinh(std::sqrt((u.m + w2) / u.q));
    const bool clear = clear_of({0.0, height}, phi, phi + length, reach) &&
                       clear_of({2.0 * std::numbers::pi, height}, phi, phi + length, reach);
    return clear ? Panel::take : Panel::split;
  }
}

template <class Moments = ArcMoments, class K>
Moments arc_moments(const K& kernel, const ArcDistance& u, double phi1, double phi2, double sweep,
                    double reach) {
  Moments sum;
  const Pieces pieces = pieces_of(phi1, phi2, sweep);
  for (std::size_t i = 0; i < pieces.count; ++i) {
    const Piece& piece = pieces.piece[i];
    const auto take = [&](double o, double panel) {
      const UnitRule<kPanelOrder>& rule = kUnitRule<kPanelOrder>;
      Moments part;
      for (std::size_t j = 0; j < kPanelOrder; ++j) {
        const double half = 0.5 * (piece.start + (o + rule.node[j] * panel));
        const double sine = std::sin(half);
        part.add(kernel, rule.weight[j], u.m + u.q * (sine * sine), half, sine);
      }
      sum.add_panel(panel, piece.sign, part);
    };
    const auto decide = [&](double o, double panel) {
      return arc_verdict(kernel, u, piece, o, panel, reach);
    };
    std::array<double, 4> cuts{};
    if (kernel.support() < std::numeric_limits<double>::infinity()) {
      const auto [outer, inner] = kinks(kernel);
      const double turn = 2.0 * std::numbers::pi - piece.start;
      const double a = u.angle_of(outer), b = u.angle_of(inner);
      cuts = {a - piece.start, b - piece.start, turn - a, turn - b};
    }
    visit_between(piece.length, cuts,
                  [&](double o, double panel) { visit_panels(o, panel, decide, take); });
  }
  return sum;
}

/// Where p is as seen from an arc.
struct ArcView {
  Vec3d outward, around;  ///< e_rho, e_phi
  double beyond, z;       ///< rho - c and the height
  double first, last;     ///< ends of phi
  double sweep;
  ArcDistance u;

  ArcView(const Arc& arc, const Vec3d& p) {
    const Vec3d d = p - arc.center;
    const double x = dot(d, arc.ex), y = dot(d, arc.ey);
    const double rho = std::hypot(x, y);
    const double azimuth = rho > 0.0 ? std::atan2(y, x) : 0.0;
    const double cosine = rho > 0.0 ? x / rho : 1.0;
    const double sine = rho > 0.0 ? y / rho : 0.0;
    outward = cosine * arc.ex + sine * arc.ey;
    around = cosine * arc.ey - sine * arc.ex;
    beyond = rho - arc.radius;
    z = dot(d, arc.normal);
    sweep = arc.sweep;
    // A full circle may begin anywhere: opposite to p, where no digit depends on the seam.
    const double turned = 0.5 * sweep < std::numbers::pi ? azimuth : 0.0;
    first = -0.5 * sweep - turned;
    last = 0.5 * sweep - turned;
    u = {beyond * beyond + z * z, 4.0 * arc.radius * rho};
  }
};

template <class Moments, class K>
Moments moments(const K& kernel, const ArcView& at, double reach) {
  return arc_moments<Moments>(kernel, at.u, at.first, at.last, at.sweep, reach);
}

template <class K>
Jet arc_quadrature(const K& kernel, const Arc& arc, const Vec3d& p, double reach) {
  const ArcView at(arc, p);
  const auto sum = moments<ArcMoments>(kernel, at, reach);
  const double c = arc.radius;
  return {c * sum.f, 2.0 * c *
                         ((at.beyond * sum.n0 + c * sum.n1) * at.outward -
                          (c * sum.ns) * at.around + (at.z * sum.n0) * arc.normal)};
}

/// A direction away from the primitive where its nearest point to p is p itself.
inline Vec3d aside(const Segment& segment) {
  return reference_axis(segment.b - segment.a);
}
inline Vec3d aside(const Arc& arc) {
  return arc.normal;
}
inline Vec3d aside(const Triangle& triangle) {
  return normalized(area_vector(triangle));
}

/// The point of the primitive nearest to p.
inline Vec3d foot(const Segment& segment, const Vec3d& p) {
  const Vec3d side = segment.b - segment.a;
  const double along = dot(p - segment.a, side) / squared_norm(side);
  return segment.a + std::clamp(along, 0.0, 1.0) * side;
}
inline Vec3d foot(const Arc& arc, const Vec3d& p) {
  const Vec3d d = p - arc.center;
  const double azimuth = std::atan2(dot(d, arc.ey), dot(d, arc.ex));
  const double t = std::clamp(azimuth, -0.5 * arc.sweep, 0.5 * arc.sweep);
  return arc.center + arc.radius * (std::cos(t) * arc.ex + std::sin(t) * arc.ey);
}
inline Vec3d foot(const Triangle& triangle, const Vec3d& p) {
  const Uv at = uv(triangle, p);
  const auto& v = triangle.vertex;
  Vec3d nearest = v[0] + at.u * (v[1] - v[0]) + at.v * (v[2] - v[0]);
  if (at.u + at.v <= 1.0 && at.u > 0.0 && at.v > 0.0) return nearest;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d on_edge = foot(Segment{v[i], v[(i + 1) % 3]}, p);
    if (i == 0 || norm(p - on_edge) < norm(p - nearest)) nearest = on_edge;
  }
  return nearest;
}

/// The distance from which an inverse kernel is evaluated in earnest.
template <class K, class P>
double least_distance(const K& kernel, const P& primitive) {
  return std::max(kernel.clamp, 1e-13 * size(primitive));
}

/// Calls evaluate(point) where the primitive is far enough for the kernel.
template <class K, class P, class Evaluate>
Jet clamped(const K& kernel, const P& primitive, const Vec3d& p, const Evaluate& evaluate) {
  if constexpr (kIsInverse<K>) {
    const double least = least_distance(kernel, primitive);
    if (distance(primitive, p) < least) {
      return {evaluate(moved_away(p, foot(primitive, p), aside(primitive), least)).value, {}};
    }
  }
  return evaluate(p);
}

}  // namespace detail

/// Value and gradient to about `relative_tolerance` of the integral of their absolute values.
template <class K>
Jet quadrature(const K& kernel, const Segment& segment, const Vec3d& p,
               double relative_tolerance = 1e-14) {
  if (!(measure(segment) > 0.0) || detail::vanishes(kernel, segment, p)) return {};
  const double reach = panel_reach(relative_tolerance);
  return detail::clamped(kernel, segment, p, [&](const Vec3d& at) {
    return detail::segment_quadrature(kernel, segment, at, reach);
  });
}

template <class K>
Jet quadrature(const K& kernel, const Arc& arc, const Vec3d& p, double relative_tolerance = 1e-14) {
  if (!(measure(arc) > 0.0) || detail::vanishes(kernel, arc, p)) return {};
  const double reach = panel_reach(relative_tolerance);
  return detail::clamped(kernel, arc, p, [&](const Vec3d& at) {
    return detail::arc_quadrature(kernel, arc, at, reach);
  });
}

}  // namespace cs2mesh

#include "libfield/integral/quadrature_triangle.h"
