// One summand of a field: f(p) = sign * w(u, v) * I(M^-1 p), with I the convolution of a kernel
// (its amplitude included) over a primitive, w the product of its strength profiles.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "libfield/base/aabb.h"
#include "libfield/base/affine.h"
#include "libfield/base/jet2.h"
#include "libfield/integral/frames.h"
#include "libfield/kernel/kernel.h"
#include "libfield/primitive/primitive.h"
#include "libfield/profile/profile.h"

namespace cs2mesh {

/// What the closed forms need of a primitive, computed once; alternatives in the order of
/// Primitive. The large ones stand apart, so that a scene of small primitives does not pay for
/// them.
using Frame =
    std::variant<Point, SegmentFrame<double>, std::shared_ptr<const ArcFrame<double>>,
                 std::shared_ptr<const TriangleFrame<double>>, Plane, TaperedFrame<double>>;
Frame frame_of(const Primitive& primitive);

/// Kernel and primitive are in scene coordinates, unless `to_local` is set: then in those to which
/// it maps scene points. Similarities are folded into kernel and primitive instead.
struct Term {
  Kernel kernel;
  Primitive primitive;
  Frame frame;  ///< frame_of(primitive)
  std::shared_ptr<const Affine> to_local;
  double sign = 1.0;  ///< +1 or -1
  std::vector<StrengthProfile> profiles;
  /// Where the primitive is a piece of a polygon: the triangle whose u and v the profiles take.
  std::shared_ptr<const Triangle> chart;
  int material = 0;
};

/// The primitive whose u and v the profiles take.
template <class P>
const P& chart_of(const Term& /*term*/, const P& primitive) {
  return primitive;
}
inline const Triangle& chart_of(const Term& term, const Triangle& piece) {
  return term.chart ? *term.chart : piece;
}

/// Adds f and its gradient at each point to `sums`.
void accumulate(const Term& term, std::span<const Vec3d> points, std::span<Jet> sums);
/// Adds f alone, which costs less; the same bits.
void accumulate(const Term& term, std::span<const Vec3d> points, std::span<double> sums);
/// Adds the second derivative of f alone; exact where profiles have no corner.
void accumulate(const Term& term, std::span<const Vec3d> points, std::span<Symmetric3> sums);

/// An upper bound of |f| at every point at least `distance` from the primitive's box.
double magnitude_bound(const Term& term, double distance);

/// A distance (rounded up) beyond which |f| <= epsilon, measured in scene coordinates from the box
/// of the primitive. Infinite if there is none.
double influence_distance(const Term& term, double epsilon);

/// Contains the primitive, in scene coordinates.
Aabb skeleton_box(const Term& term);

}  // namespace cs2mesh
