// Where a point is as seen from a circular arc, and what all kernels over arcs share: the ends, the
// gradient from its parts, Gauss-Legendre over the whole arc, and the stretches within a distance.
//
// Legend: c radius, theta sweep; rho, alpha, z cylindrical coordinates of p about the arc's axis,
// alpha counted from the middle of the arc; phi the azimuth of the arc's points less alpha, psi1
// and psi2 half of its ends; u = m + 4 c rho sin^2(phi / 2) the squared distance to a point of the
// arc, m = (rho - c)^2 + z^2; K = dh/du. For every kernel
//     f = c int h dphi,   grad f = 2c [((rho - c) N0 + c N1) e_rho - c Ns e_phi + z N0 n],
//     N0 = int K dphi,  N1 = int K (1 - cos phi) dphi,  Ns = int K sin phi dphi.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "libfield/base/jet.h"
#include "libfield/integral/frames.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh {
namespace detail {

/// p in the cylindrical coordinates of an arc.
template <class T>
struct ArcPoint {
  T x, y, z, rho;
  T cos_alpha, sin_alpha;
};

/// Sine, cosine of half the angle to an end of the arc, and 1 / v there.
template <class T>
struct ArcEnd {
  T sine, cosine, w;
};

/// The azimuth of a place whose x, y and z are given.
template <class T>
ArcPoint<T> polar_of(ArcPoint<T> at) {
  using std::sqrt;
  at.rho = sqrt(at.x * at.x + at.y * at.y);
  // On the axis any azimuth will do.
  const auto off_axis = at.rho > T(0);
  const T inverse = T(1) / select(off_axis, at.rho, T(1));
  at.cos_alpha = select(off_axis, T(at.x * inverse), T(1));
  at.sin_alpha = select(off_axis, T(at.y * inverse), T(0));
  return at;
}

template <class T>
ArcPoint<T> arc_point(const ArcFrame<T>& arc, const Vec3<T>& d) {
  return polar_of<T>({dot(d, arc.ex), dot(d, arc.ey), dot(d, arc.normal), {}, {}, {}});
}

/// The ends phi = -theta/2 - |alpha| and theta/2 - |alpha|: the mirror image of p about e_x if
/// alpha < 0.
template <class T>
std::array<ArcEnd<T>, 2> arc_ends(const ArcFrame<T>& arc, const ArcPoint<T>& at) {
  using std::abs;
  using std::sqrt;
  const T half_sine = T(0.5) * abs(at.sin_alpha);
  const T greater = sqrt(T(0.5) + T(0.5) * abs(at.cos_alpha));
  const T lesser = half_sine / greater;
  const auto front = at.cos_alpha >= T(0);
  const T ca = select(front, greater, lesser), sa = select(front, lesser, greater);
  const T ss = arc.sin_quarter * sa, sc = arc.sin_quarter * ca;
  const T cs = arc.cos_quarter * sa, cc = arc.cos_quarter * ca;
  return {ArcEnd<T>{-(sc + cs), cc - ss, {}}, ArcEnd<T>{sc - cs, cc + ss, {}}};
}

/// int h dphi, N0, N1, Ns.
template <class T>
struct ArcSums {
  T value{}, n0{}, n1{}, ns{};

  ArcSums& operator+=(const ArcSums& b) {
    value += b.value;
    n0 += b.n0;
    n1 += b.n1;
    ns += b.ns;
    return *this;
  }
  friend ArcSums operator*(const T& s, const ArcSums& b) {
    return {s * b.value, s * b.n0, s * b.n1, s * b.ns};
  }
  friend ArcSums select(const MaskOf<T>& mask, const ArcSums& yes, const ArcSums& no) {
    return {select(mask, yes.value, no.value), select(mask, yes.n0, no.n0),
            select(mask, yes.n1, no.n1), select(mask, yes.ns, no.ns)};
  }
};

/// Value and gradient from the sums, for an arc of radius `c` and a point in the same unit; apart
/// is rho - c.
template <class T>
JetOf<T> arc_jet(const ArcFrame<T>& arc, const T& c, const ArcPoint<T>& at, const T& apart,
                 const ArcSums<T>& sum) {
  const T radial = apart * sum.n0 + c * sum.n1;
  const T around = -c * sum.ns;
  const T gx = radial * at.cos_alpha - around * at.sin_alpha;
  const T gy = radial * at.sin_alpha + around * at.cos_alpha;
  const T twice = T(2) * c;
  return {c * sum.value,
          (twice * gx) * arc.ex + (twice * gy) * arc.ey + (twice * (at.z * sum.n0)) * arc.normal};
}

/// Two numbers that one division gives.
template <class T>
struct ArcPair {
  T a, b;
};

/// Gauss-Legendre over the whole arc of radius `c`; `x`, `y` as in ArcFrame, N nodes and their
/// mirror images. The law has w of two squared distances, and of w the kernel h and K / law.slope.
template <std::size_t N, class T, class Law>
JetOf<T> arc_nodes(const ArcFrame<T>& arc, const T& c, const std::array<double, N>& x,
                   const std::array<double, N>& y, const ArcPoint<T>& at, const Law& law) {
  constexpr const GaussLegendreRule<2 * N>& rule = kGaussLegendre<2 * N>;
  const T z2 = at.z * at.z;
  std::array<ArcPair<T>, N> w;
  for (std::size_t i = 0; i < N; ++i) {
    const T dx = at.x - c * T(x[i]);
    const T up = at.y - c * T(y[i]);
    const T down = at.y + c * T(y[i]);
    const T beside = z2 + dx * dx;
    w[i] = law.pair(T(beside + up * up), T(beside + down * down));
  }
  T value(0), k(0), k_x(0), k_y(0);
  for (std::size_t i = 0; i < N; ++i) {
    const T weight(rule.weight[i]);
    const T upper = law.k(w[i].a), lower = law.k(w[i].b), both = upper + lower;
    value += weight * (law.h(w[i].a) + law.h(w[i].b));
    k += weight * both;
    k_x += weight * (both * (at.x - c * T(x[i])));
    k_y += weight * (both * at.y - (upper - lower) * (c * T(y[i])));
  }
  const T half_length = T(0.5) * c * arc.sweep;
  const T slope = T(2) * law.slope * half_length;
  return {half_length * value, slope * (k_x * arc.ex + k_y * arc.ey + (k * at.z) * arc.normal)};
}

/// The greatest sweep over which 8 nodes integrate the sine and cosine of the azimuth, which the
/// gradient brings, to 3e-18; 14 nodes do so over a turn.
inline constexpr double kSweep8 = 2.0;

/// Offers the nodes to the lanes in which the kernel's singularities, at m cos^2 psi + q sin^2 psi
/// = 0, are far from the whole arc wherever along it (see ArcFrame::far14); true once all lanes
/// have a result. gap = q - m.
template <class T, class Law>
bool take_far_arc(FirstOf<T, JetOf<T>>& jets, const ArcFrame<T>& arc, const T& c,
                  const ArcPoint<T>& at, const T& m, const T& gap, const Law& law) {
  return jets.take((arc.sweep < T(kSweep8)) & (m > arc.far8 * gap),
                   [&] { return arc_nodes(arc, c, arc.node8_x, arc.node8_y, at, law); }) ||
         jets.take(m > arc.far14 * gap,
                   [&] { return arc_nodes(arc, c, arc.node14_x, arc.node14_y, at, law); });
}

}  // namespace detail
}  // namespace cs2mesh
