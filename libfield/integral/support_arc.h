// Soft objects and quartic kernels over a circular arc:
//     f = c int h dphi,   grad f = 2c [((rho - c) N0 + c N1) e_rho - c Ns e_phi + z N0 n],
//     N0 = int K dphi,  N1 = int K (1 - cos phi) dphi,  Ns = int K sin phi dphi,  K = dh/du.
//
// Legend: c radius, theta sweep; rho, alpha, z cylindrical coordinates of p about the arc's axis,
// alpha counted from the middle of the arc; phi the azimuth of the arc's points less alpha; R the
// support, v = 1 - u / R^2 = (x - 4 c rho sin^2(phi / 2)) / R^2 with x = R^2 - (rho - c)^2 - z^2.
//
// Within the support, |phi| <= phi_c with 4 c rho sin^2(phi_c / 2) = x (all around if x is
// greater), h and K are trigonometric polynomials of degree 3: twenty Gauss-Legendre nodes a piece
// leave an error of 1e-20, over as much as a turn. There are two pieces at most, the second where
// an arc of more than half a turn comes near to p with both ends. All terms of a value are
// positive. Value and gradient are within a few ulp of the exact result for inputs moved by a few
// ulp. 0 outside the support; finite for every finite p.
#pragma once

#include <cmath>
#include <type_traits>

#include "libfield/base/jet.h"
#include "libfield/integral/arc_window.h"
#include "libfield/integral/support_segment.h"

namespace cs2mesh {
namespace detail {

/// The kernel by v = x - gap sin^2(phi / 2); x and gap = 4 c rho in units of R^2, K for support 1.
template <class K, class T>
struct SupportArcLaw {
  const K& kernel;
  T x, gap;

  SupportLaw<T> at(const T& s2) const {
    using std::max;
    return law(kernel, T(max(T(0), T(x - gap * s2))));
  }
};

template <class K, class T>
JetOf<T> support_arc(const K& kernel, const ArcFrame<T>& arc, const Vec3<T>& point) {
  using std::max;
  using std::sqrt;
  const ArcPoint<T> at = arc_point(arc, Vec3<T>(point - arc.center));
  const T radius(kernel.radius), c = arc.radius;
  const T apart = at.rho - c;
  const T least = sqrt(apart * apart + at.z * at.z);
  const auto reached = least < radius;
  if (!any(reached)) return {};
  const T per_square = T(1) / (radius * radius);
  const T x = max(T(0), T((radius - least) * (radius + least) * per_square));
  const T gap = T(4) * c * at.rho * per_square;

  const auto whole = gap <= x;
  const T reach = T(2) * vmath::atan2(T(sqrt(x)), T(sqrt(max(T(0), T(gap - x)))));
  const ArcWindow<T> window(arc, at, reach, whole);
  const SupportArcLaw<K, T> law{kernel, x, gap};
  ArcSums<T> sum = arc_stretch<20>(law, window.from, window.span);
  if (any(window.behind > T(0))) sum += arc_stretch<20>(law, window.behind_from, window.behind);
  const JetOf<T> jet = T(kernel.amplitude) * unmirrored_arc_jet(arc, at, apart, sum, per_square);
  return select(reached, jet, JetOf<T>{});
}

}  // namespace detail

/// Value and gradient; see the head of this file.
template <class K, class T>
requires(std::is_same_v<K, Soft> ||
         std::is_same_v<K, Quartic>) JetOf<T> integral(const K& kernel, const ArcFrame<T>& arc,
                                                       const Vec3<T>& point) {
  return detail::support_arc(kernel, arc, point);
}
template <class K>
requires(std::is_same_v<K, Soft> || std::is_same_v<K, Quartic>) Jet
    integral(const K& kernel, const Arc& arc, const Vec3d& point) {
  return integral(kernel, ArcFrame<double>(arc), point);
}

}  // namespace cs2mesh
