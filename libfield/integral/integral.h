// The fields of all kernels over all primitives: integral(kernel, primitive, p) gives value and
// gradient at p, the kernel's amplitude included.
//
//            point        segment             arc             triangle            plane
//  cauchy    closed       closed              closed          closed              closed
//  gaussian  closed       closed              quadrature      quadrature          closed
//  inverse   closed       closed              quadrature      quadrature          divergent
//  squared   closed       closed              quadrature      quadrature          divergent
//  metaball  closed       closed              quadrature      quadrature          closed
//  soft      closed       closed              nodes (exact)   quadrature          closed
//  quartic   closed       closed              nodes (exact)   quadrature          closed
//
// A segment with a weight along it is closed with Cauchy and Gaussian, and has no field with the
// others.
//
// To add a closed form: its file, its #include here, its word in this table.
#pragma once

#include "libfield/integral/cauchy_arc.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/cauchy_triangle.h"
#include "libfield/integral/gaussian_segment.h"
#include "libfield/integral/inverse_segment.h"
#include "libfield/integral/plane.h"
#include "libfield/integral/point.h"
#include "libfield/integral/quadrature.h"
#include "libfield/integral/support_arc.h"
#include "libfield/integral/support_segment.h"
#include "libfield/integral/tapered_segment.h"

namespace cs2mesh {

/// Whether the field of that kernel over that primitive is infinite everywhere.
template <class K, class P>
inline constexpr bool kDiverges = detail::kIsInverse<K>&& std::is_same_v<P, Plane>;

/// Whether there is a field of that kernel over that primitive.
template <class K, class P>
inline constexpr bool kHasField =
    !kDiverges<K, P> && (!std::is_same_v<P, TaperedSegment> || std::is_same_v<K, Cauchy> ||
                         std::is_same_v<K, Gaussian>);

/// Whether quadrature stands in for a closed form; the table above as code.
template <class K, class P>
inline constexpr bool kNeedsQuadrature =
    !std::is_same_v<K, Cauchy> &&
    ((std::is_same_v<P, Arc> && !detail::kIsPolynomial<K>) || std::is_same_v<P, Triangle>);

/// Pairs without a closed form, in double alone.
template <class K, class P>
requires kNeedsQuadrature<K, P> Jet integral(const K& kernel, const P& primitive, const Vec3d& p) {
  return quadrature(kernel, primitive, p);
}

}  // namespace cs2mesh
