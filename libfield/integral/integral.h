// The fields of all kernels over all primitives: integral(kernel, primitive, p) gives value and
// gradient at p, the kernel's amplitude included.
//
//            point        segment             arc             triangle            plane
//  cauchy    closed       closed              closed          closed              closed
//  gaussian  closed       closed              quadrature      edges               closed
//  inverse   closed       closed              quadrature      closed              divergent
//  squared   closed       closed              quadrature      edges               divergent
//  metaball  closed       closed              quadrature      closed              closed
//  soft      closed       closed              nodes (exact)   closed              closed
//  quartic   closed       closed              nodes (exact)   closed              closed
//
// To add a closed form: its file, its #include here, its word in this table.
#pragma once

#include "libfield/integral/cauchy_arc.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/cauchy_triangle.h"
#include "libfield/integral/gaussian_segment.h"
#include "libfield/integral/gaussian_triangle.h"
#include "libfield/integral/inverse_segment.h"
#include "libfield/integral/inverse_triangle.h"
#include "libfield/integral/metaball_triangle.h"
#include "libfield/integral/plane.h"
#include "libfield/integral/point.h"
#include "libfield/integral/quadrature.h"
#include "libfield/integral/squared_triangle.h"
#include "libfield/integral/support_arc.h"
#include "libfield/integral/support_segment.h"
#include "libfield/integral/support_triangle.h"

namespace cs2mesh {

/// Whether the field of that kernel over that primitive is infinite everywhere.
template <class K, class P>
inline constexpr bool kDiverges = detail::kIsInverse<K>&& std::is_same_v<P, Plane>;

/// Whether quadrature stands in for a closed form; the table above as code.
template <class K, class P>
inline constexpr bool kNeedsQuadrature =
    std::is_same_v<P, Arc> && !std::is_same_v<K, Cauchy> && !detail::kIsPolynomial<K>;

/// Pairs without a closed form, in double alone.
template <class K, class P>
requires kNeedsQuadrature<K, P> Jet integral(const K& kernel, const P& primitive, const Vec3d& p) {
  return quadrature(kernel, primitive, p);
}

}  // namespace cs2mesh
