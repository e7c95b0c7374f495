// The second derivative of the fields of all kernels over all primitives:
//     Hess f = int (2K I + 4K' d d^T),   d = p - q, K = dh/du, K' = dK/du, u = |d|^2.
// (K is continuous but for the clamp of inverse kernels, so no edge of a support adds a term.)
//
//            point    segment      arc          triangle                       plane
//  cauchy    closed   quadrature   quadrature   edges over it, else quadrature closed
//  gaussian  closed   closed       quadrature   quadrature of closed chords    closed
//  inverse   closed   quadrature   quadrature   edges near it, else quadrature divergent
//  others    closed   quadrature   quadrature   quadrature                     closed or divergent
//
// Segments with a weight: quadrature.
//
// Quadrature uses the panels of quadrature.h, with the moments of K' beside those of K. Where K
// keeps its sign and some direction is perpendicular to all d (points, segments, arcs in whose
// plane p lies) it is an eigenvector of eigenvalue int 2K, so that nothing cancels: the error is a
// few ulp of the norm. Elsewhere eigenvalues of both signs meet; what is lost then is of the size
// of what moving the inputs by a few ulp does, but for the inverse kernel close to the face of a
// triangle, where int 2K alone grows without bound while f is harmonic: there the edges serve, see
// edge_hessian().
//
// Symmetric to the last bit, 0 within the clamp of an inverse kernel (and on an inverse point
// without one), one of the two limits where it jumps (the radii of supports). Finite for every
// finite p; entries beyond the range of double saturate.
//
// Legend: for a segment, t the abscissa counted from the foot of p on its line, perp the vector
// from the line to p, a the axis: d = perp - t a. For an arc, phi the azimuth counted from that of
// p, c its radius, rho and z the cylindrical coordinates of p, g = 1 - cos phi:
// d = (rho - c + c g) e_rho - c sin(phi) e_phi + z n. For a triangle, x and y as in
// quadrature_triangle.h: d = (-x, -y, z).
#pragma once

#include <cmath>
#include <type_traits>

#include "libfield/base/jet2.h"
#include "libfield/integral/integral.h"

namespace cs2mesh {
namespace detail {

/// The sum of distances of the ends of a panel to a singularity, over its length, from which 14
/// nodes suffice for K': its poles are of up to fourth order, which cost the rule 14^3 / 3! of its
/// error against simple ones, so 5^-28 stands where 4.2^-28 does for values (gauss_legendre.h).
inline constexpr double kHessianReach = 2.6;

/// int 2K, int 4K', int 4K' t, int (2K + 4K' t^2) over a segment.
struct LineMoments2 {
  double m = 0.0, n0 = 0.0, n1 = 0.0, along = 0.0;

  template <class K>
  void add(const K& kernel, double weight, double u, double t) {
    const double k2 = 2.0 * weight * kernel.slope(u);
    const double k4 = 4.0 * weight * kernel.curvature(u);
    m += k2;
    n0 += k4;
    n1 += k4 * t;
    along += k2 + k4 * t * t;
  }
  void add_panel(double length, double sign, const LineMoments2& part) {
    m += length * part.m;
    n0 += length * part.n0;
    n1 += length * sign * part.n1;
    along += length * part.along;
  }
};

/// Gaussian: K' = -a^2 K, and 2K + 4K' t^2 is the derivative of 2K t. With n and g the nearer and
/// the farther of |t1|, |t2|, its change n h(n) - g h(g) = n (h(n) - h(g)) - L h(g) keeps its
/// digits on a short segment beside the foot; if the foot is on the segment, both terms have one
/// sign.
inline void find_moments(const Gaussian& kernel, double c2, double t1, double length,
                         LineMoments2& out) {
  const double t2 = t1 + length;
  const GaussianLine<double> line = gaussian_line(kernel, t1, t2, length, c2);
  const double a2 = 2.0 * kernel.a * kernel.a;
  const double near = std::min(std::abs(t1), std::abs(t2));
  const double far = std::max(std::abs(t1), std::abs(t2));
  const double at_far = kernel.profile(c2 + far * far);
  const double change = t1 < 0.0 && t2 > 0.0
                            ? -(near * kernel.profile(c2 + near * near) + far * at_far)
                            : near * std::abs(line.drop) - length * at_far;
  out = {-a2 * line.value, a2 * a2 * line.value, a2 * line.drop, a2 * change};
}

inline Symmetric3 assembled(const LineMoments2& sum, const Vec3d& perp, const Vec3d& axis) {
  // (k v) v^T rather than k (v v^T), whose squares may overflow where k vanishes.
  const Symmetric3 across = multiple_of_unit(sum.m) - sum.m * squared(axis);
  const Symmetric3 radial = 0.5 * symmetric_product(sum.n0 * perp, perp);
  return across + radial - symmetric_product(sum.n1 * perp, axis) + sum.along * squared(axis);
}

template <class K>
Symmetric3 raw_hessian(const K& kernel, const Segment& segment, const Vec3d& p) {
  const LineView at(segment, p);
  if constexpr (std::is_same_v<K, Gaussian>) {
    LineMoments2 sum;
    find_moments(kernel, squared_norm(at.perp), at.t1, at.length, sum);
    return assembled(sum, at.perp, at.axis);
  } else {
    return assembled(moments<LineMoments2>(kernel, at, kHessianReach), at.perp, at.axis);
  }
}

/// Quadrature, as of any kernel: the weight is polynomial and adds no singularity.
template <class K>
Symmetric3 raw_hessian(const K& kernel, const TaperedSegment& segment, const Vec3d& p) {
  const LineView at(segment.axis, p);
  const auto weight = [&](double t) { return value_at(segment.weight, (t - at.t1) / at.length); };
  return assembled(moments<LineMoments2>(kernel, at, kHessianReach, weight), at.perp, at.axis);
}

/// int 2K and the moments of 4K': 1, g, g^2, sin phi, g sin phi, sin^2 phi.
struct ArcMoments2 {
  double m = 0.0, n = 0.0, g = 0.0, gg = 0.0, s = 0.0, gs = 0.0, ss = 0.0;

  template <class K>
  void add(const K& kernel, double weight, double u, double half, double sine) {
    const double k4 = 4.0 * weight * kernel.curvature(u);
    const double turn = 2.0 * sine * sine;
    const double sine_phi = 2.0 * sine * std::cos(half);
    m += 2.0 * weight * kernel.slope(u);
    n += k4;
    g += k4 * turn;
    gg += k4 * turn * turn;
    s += k4 * sine_phi;
    gs += k4 * turn * sine_phi;
    ss += k4 * sine_phi * sine_phi;
  }
  void add_panel(double length, double sign, const ArcMoments2& part) {
    m += length * part.m;
    n += length * part.n;
    g += length * part.g;
    gg += length * part.gg;
    s += length * sign * part.s;
    gs += length * sign * part.gs;
    ss += length * part.ss;
  }
};

/// k[0] e0 e0^T + k[1] e1 e1^T + ... + k[3] (e0 e1^T + e1 e0^T) + k[4] (e0, e2) + k[5] (e1, e2).
inline Symmetric3 assembled(const Symmetric3& k, const Vec3d& e0, const Vec3d& e1,
                            const Vec3d& e2) {
  return congruent(k, {{e0, e1, e2}});
}

template <class K>
Symmetric3 raw_hessian(const K& kernel, const Arc& arc, const Vec3d& p) {
  const ArcView at(arc, p);
  const auto sum = moments<ArcMoments2>(kernel, at, kHessianReach);
  // Neither rho - c nor c g exceeds |d| by more than a factor of 2 where they have opposite signs.
  const double c = arc.radius, b = at.beyond, z = at.z;
  const Symmetric3 local{sum.m + (b * sum.n + 2.0 * c * sum.g) * b + c * sum.gg * c,
                         sum.m + c * sum.ss * c,
                         sum.m + z * sum.n * z,
                         -c * (b * sum.s + c * sum.gs),
                         z * (b * sum.n + c * sum.g),
                         -z * sum.s * c};
  return c * assembled(local, at.outward, at.around, arc.normal);
}

/// What the chords at abscissa x give: int 2K and the products of d, (-x, -y, z), with 4K'.
struct FaceMoments2 {
  using Chord = LineMoments2;
  double m = 0.0, n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;

  void add(double weight, const Chord& chord, double at) {
    m += weight * chord.m;
    n += weight * chord.n0;
    x += weight * chord.n0 * at;
    y += weight * chord.n1;
    xx += weight * (chord.m + chord.n0 * at * at);
    xy += weight * chord.n1 * at;
    yy += weight * chord.along;
  }
  void add_panel(double length, double sign, const FaceMoments2& part) {
    m += length * part.m;
    n += length * part.n;
    x += length * sign * part.x;
    y += length * part.y;
    xx += length * part.xx;
    xy += length * sign * part.xy;
    yy += length * part.yy;
  }
};

template <class K>
Symmetric3 face_hessian(const K& kernel, const Triangle& triangle, const Vec3d& p) {
  const FaceView at(triangle, p);
  const auto sum = moments<FaceMoments2>(kernel, at, kHessianReach);
  const double z = at.z;
  return assembled({sum.xx, sum.yy, sum.m + z * sum.n * z, sum.xy, -z * sum.x, -z * sum.y},
                   at.along, at.up, at.normal);
}

/// The inverse kernel's from the gradients g_i of its fields over the edges, o_i their outward
/// normals: those rows of Hess f = -sum o_i g_i^T that lie in the plane are right for any kernel
/// (by the divergence theorem), the last entry makes f harmonic, as 1 / r is. Nothing grows without
/// bound but near the edges.
inline Symmetric3 edge_hessian(const Inverse& kernel, const Triangle& triangle, const Vec3d& p) {
  const TriangleFrame<double> frame(triangle);
  const Vec3d &along = frame.edge[0].along, &normal = frame.normal;
  const Vec3d up = -frame.edge[0].outward;
  Symmetric3 local;
  for (std::size_t i = 0; i < 3; ++i) {
    const Segment edge{frame.vertex[i], frame.vertex[(i + 1) % 3]};
    const Vec3d g = integral(kernel, edge, p).gradient;
    const Vec3d local_g{dot(g, along), dot(g, up), dot(g, normal)};
    const double ox = dot(frame.edge[i].outward, along), oy = dot(frame.edge[i].outward, up);
    local.xx -= ox * local_g.x;
    local.yy -= oy * local_g.y;
    local.xy -= 0.5 * (ox * local_g.y + oy * local_g.x);
    local.xz -= ox * local_g.z;
    local.yz -= oy * local_g.z;
  }
  local.zz = -(local.xx + local.yy);
  return assembled(local, along, up, normal);
}

/// The Cauchy kernel's from the edges, and whether the sums keep their digits. With o, t, n the
/// outward, the tangential and the normal unit vectors of an edge, Q = 1 + s^2 z^2 and Jk as in
/// cauchy_triangle.h, the rows in the plane are again those of -sum o (grad of the edge's field)^T,
///     A sum [-4 s^2 J3 (e o o^T - z (o n^T + n o^T)) - drop (o t^T + t o^T) / 2],
/// and the last entry is d/dz of the gradient along n, dJk/dz = -2 k s^2 z J(k + 1):
///     -A s^2 [(Q - 4 s^2 z^2) / Q^3 sum e (J1 + Q J2) - 4 s^2 z^2 / Q sum e J3].
/// Where the terms add up to more than some times the result, as over a wide kernel or far outside,
/// the sums have lost digits that quadrature keeps.
struct EdgeTrial {
  Symmetric3 hessian;
  bool good = false;
};
inline EdgeTrial cauchy_edge_hessian(const Cauchy& kernel, const Triangle& triangle,
                                     const Vec3d& p) {
  const TriangleFrame<double> frame(triangle);
  const double s = kernel.s, s2 = s * s;
  std::array<Vec3d, 3> d;
  for (std::size_t i = 0; i < 3; ++i) d[i] = p - frame.vertex[i];
  const double z = dot(nearest_of(d), frame.normal);
  const double q = 1.0 + s2 * (z * z);
  if (!(q <= 4.0 * s2 * (frame.height * frame.height))) return {};
  Symmetric3 sum;
  double e12 = 0.0, e3 = 0.0, size = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& edge = frame.edge[i];
    const auto [e, line] = EdgeView<double>(s, frame, d, z, i);
    const double fall = 4.0 * s2 * line.j3;
    sum += (-fall * e) * squared(edge.outward) +
           (fall * z) * symmetric_product(edge.outward, frame.normal) -
           (0.5 * line.drop) * symmetric_product(edge.outward, edge.along);
    e12 += e * (line.j1 + q * line.j2);
    e3 += e * line.j3;
    size += fall * (std::abs(e) + std::abs(z)) + std::abs(line.drop) +
            s2 * std::abs(e) * (line.j1 + q * line.j2) / (q * q);
  }
  const double lift = 4.0 * s2 * (z * z);
  sum += (-s2 * ((q - lift) / (q * q * q) * e12 - lift / q * e3)) * squared(frame.normal);
  constexpr double kMostCancelled = 8.0;
  return {kernel.amplitude * sum, size < kMostCancelled * norm(sum)};
}

template <class K>
Symmetric3 raw_hessian(const K& kernel, const Triangle& triangle, const Vec3d& p) {
  if constexpr (std::is_same_v<K, Cauchy>) {
    const EdgeTrial trial = cauchy_edge_hessian(kernel, triangle, p);
    if (trial.good) return trial.hessian;
  }
  if constexpr (std::is_same_v<K, Inverse>) {
    // Farther off the edges cancel, while int 2K is of the size of the result.
    if (distance(triangle, p) < 0.5 * size(triangle)) return edge_hessian(kernel, triangle, p);
  }
  return face_hessian(kernel, triangle, p);
}

/// Finite: entries beyond the range of double saturate, those that are no number (a difference of
/// two such, or 0 / 0 on a singular point) count as 0.
inline Symmetric3 saturated(const Symmetric3& h) {
  const auto bounded = [](double x) {
    constexpr double kGreatest = std::numeric_limits<double>::max();
    return std::isnan(x) ? 0.0 : std::clamp(x, -kGreatest, kGreatest);
  };
  return {bounded(h.xx), bounded(h.yy), bounded(h.zz), bounded(h.xy), bounded(h.xz), bounded(h.yz)};
}

}  // namespace detail

/// The second derivative of integral(kernel, primitive, p): within some ulp of its norm for inputs
/// moved by a few ulp (in slivers, times longest edge over smallest height). See the head of this
/// file.
template <class K, class P>
requires(kHasField<K, P>) Symmetric3 hessian(const K& kernel, const P& primitive, const Vec3d& p) {
  if (!(measure(primitive) > 0.0) || detail::vanishes(kernel, primitive, p)) return {};
  if constexpr (detail::kIsInverse<K>) {
    if (distance(primitive, p) < detail::least_distance(kernel, primitive)) return {};
  }
  return detail::saturated(detail::raw_hessian(kernel, primitive, p));
}

template <class K>
Symmetric3 hessian(const K& kernel, const Point& point, const Vec3d& p) {
  const Vec3d d = p - point.position;
  const double u = squared_norm(d);
  return detail::saturated(multiple_of_unit(2.0 * kernel.slope(u)) +
                           symmetric_product((2.0 * kernel.curvature(u)) * d, d));
}

/// f depends on the distance d from the plane alone, f' = -2 pi d h, f'' = -2 pi (h + 2 d^2 K).
template <class K>
requires(kHasField<K, Plane>) Symmetric3
    hessian(const K& kernel, const Plane& plane, const Vec3d& p) {
  const double d = dot(p - plane.point, plane.normal);
  const double u = d * d;
  return (-2.0 * std::numbers::pi * (kernel.profile(u) + 2.0 * d * (d * kernel.slope(u)))) *
         squared(plane.normal);
}

/// Value, gradient and second derivative; the first two are those of integral(kernel, primitive,
/// p).
template <class K, class P>
requires(kHasField<K, P>) Jet2 second_jet(const K& kernel, const P& primitive, const Vec3d& p) {
  const Jet jet = integral(kernel, primitive, p);
  return {jet.value, jet.gradient, hessian(kernel, primitive, p)};
}

}  // namespace cs2mesh
