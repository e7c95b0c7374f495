// The fields of all kernels over all primitives: integral(kernel, primitive, p) gives value and
// gradient at p, the kernel's amplitude included.
//
//            point        segment             arc             triangle            plane
//  cauchy    closed       closed              closed          closed              closed
//  gaussian  closed       closed              nodes           edges               closed
//  inverse   closed       closed              closed          closed              divergent
//  squared   closed       closed              closed          edges               divergent
//  metaball  closed       closed              nodes           closed              closed
//  soft      closed       closed              nodes (exact)   closed              closed
//  quartic   closed       closed              nodes (exact)   closed              closed
//
// A segment with a weight along it is closed with Cauchy and Gaussian, and has no field with the
// others.
//
// To add a closed form: its file, its #include here, its word in this table.
#pragma once

#include "libfield/integral/cauchy_arc.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/cauchy_triangle.h"
#include "libfield/integral/gaussian_arc.h"
#include "libfield/integral/gaussian_segment.h"
#include "libfield/integral/gaussian_triangle.h"
#include "libfield/integral/inverse_arc.h"
#include "libfield/integral/inverse_segment.h"
#include "libfield/integral/inverse_triangle.h"
#include "libfield/integral/metaball_arc.h"
#include "libfield/integral/metaball_triangle.h"
#include "libfield/integral/plane.h"
#include "libfield/integral/point.h"
#include "libfield/integral/quadrature.h"
#include "libfield/integral/squared_triangle.h"
#include "libfield/integral/support_arc.h"
#include "libfield/integral/support_segment.h"
#include "libfield/integral/support_triangle.h"
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

}  // namespace cs2mesh
