// Where F changes sign along segments whose ends lie on different sides.
#pragma once

#include <cstddef>
#include <span>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

/// A segment whose ends differ in sign (F >= 0 is inside), with the jets of F there.
struct CrossedEdge {
  Vec3d a, b;
  Jet at_a, at_b;
};

struct EdgeRootCounts {
  std::size_t jets = 0;     ///< evaluations
  std::size_t rounds = 0;   ///< batches
  std::size_t clamped = 0;  ///< roots moved off an end of their edge
};

/// The root in [0, 1] of the cubic with values f0, f1 of unlike sign and slopes d0, d1 at 0 and 1.
double hermite_root(double f0, double d0, double f1, double d1);

/// For each edge a point a + t (b - a), with F = 0 there up to the rounding of F, or with the sign
/// change enclosed to 1e-15 of the coordinates (a jump, or a gradient of 0). All edges iterate
/// together: guess by the Hermite cubic, then Newton's method on the jets, kept inside the bracket;
/// where Newton's method stalls, bisection. Smooth F takes one or two rounds.
///
/// t is kept at least kEndClearance away from both ends, so that crossings of different edges never
/// coincide. That moves a root only where F vanishes at an end itself.
inline constexpr double kEndClearance = 1e-6;
void find_roots(const ImplicitSurface& surface, std::span<const CrossedEdge> edges,
                std::span<Vec3d> roots, EdgeRootCounts& counts);

}  // namespace cs2mesh
