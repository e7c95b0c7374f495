// From the thickness a user asks for to a kernel's width and strength: alone, a primitive's surface
// F = T = 1 passes at distance R (the radius in isolation) from its characteristic point, and the
// blobbiness B < 0 says how fast the field falls there (Blinn 1982 for the Gaussian point, where
// d ln F / d ln r = 2B at r = R; thesis section 3.1). With b = -B:
//     gaussian a = sqrt(b) / R, cauchy s = sqrt(b) / R;
//     finite supports: the unique support for which an isolated point has Blinn's slope:
//       quartic R sqrt(1 + 2/b); metaballs R (1 + b) / b for b >= 1/2, else R sqrt(3 (1 + b) / b);
//       soft R / sqrt(x), x = b v (5 + 4v) / (10 + 12v) = 1 - v,
//         v = 20 / ((5b - 2) + sqrt((5b - 2)^2 + 160 b + 480));
//     the inverse kernels have no width: B does not matter to them.
// Strength S = 1 / f at the characteristic point, f the field of unit amplitude. That point is at R
// beside the middle of a segment (of weight 1, if it has one along it), at R above the middle of an
// arc or the centroid of a triangle or polygon, anywhere at R from a point or plane. S reaches
// e^1000, so its logarithm is what counts.
#pragma once

#include "libfield/kernel/kind.h"
#include "libfield/primitive/polygon.h"
#include "libfield/primitive/primitive.h"

namespace cs2mesh {

/// s, a or the support radius for radius in isolation R > 0 and blobbiness B < 0; 0 for the inverse
/// kernels.
double kernel_width(KernelKind kind, double radius, double blobbiness);

struct Isolation {
  double width;         ///< 0 for the inverse kernels
  double strength;      ///< infinite where it overflows
  double log_strength;  ///< accurate to 1e-12 of its size or absolutely
};

/// Width and strength for R > 0 and B < 0. An inverse kernel over a plane has no field: strength 0,
/// log_strength -infinity.
Isolation isolate(KernelKind kind, const Primitive& primitive, double radius, double blobbiness);

/// The strength for that width (> 0, ignored for the inverse kernels); infinite if the
/// characteristic point is outside the support.
Isolation isolate_at_width(KernelKind kind, const Primitive& primitive, double radius,
                           double width);

/// Of a polygon, whose pieces share one strength: the characteristic point is R above the centroid
/// of the whole.
Isolation isolate_at_width(KernelKind kind, const Polygon& polygon, double radius, double width);

/// The strength for which an infinite line has its surface at the distance `radius`. Infinite where
/// that is outside of the support; an inverse kernel has none (ContractViolation).
Isolation isolate_line_at_width(KernelKind kind, double radius, double width);

}  // namespace cs2mesh
