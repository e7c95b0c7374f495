// A box as a term sees it: where it lies in the coordinates of the primitive, how far the
// primitive is from it, and how much the integral's derivatives may be in it.
//
// Taylor's remainder weighs the derivative near the centre most, where it is not the greatest:
//     f(p0 + d) = polynomial of order k - 1 + int_0^1 (1 - t)^(k-1) / (k-1)! D^k f(p0 + t d)[d^k]
//     dt,
// and the part of the box within t of its centre keeps the distance near(t). In two pieces,
// |D^k f| <= E_k(near(1/2)) for t <= 1/2 and E_k(near(1)) beyond.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libfield/field/quadratic_range.h"
#include "libfield/field/term_visit.h"
#include "libfield/integral/bound.h"
#include "libfield/primitive/nearest_point.h"

namespace cs2mesh {

/// A box in the coordinates of the primitive, as a ball about its centre.
struct LocalBox {
  Vec3d center;
  double radius = 0.0;   ///< half the diagonal, rounded up
  double stretch = 1.0;  ///< upper bound of |to_local|
  Vec3d half;            ///< the half edges, in the scene, rounded up
  Aabb box;
};

/// Rounded up, the rounding of the centre included.
inline Vec3d half_edges(const Aabb& box) {
  const Vec3d center = box.center();
  return (1 + 4 * std::numeric_limits<double>::epsilon()) * max(box.max - center, center - box.min);
}

inline LocalBox local_box(const Term& term, const Aabb& box) {
  LocalBox local{box.center(), 0.0, 1.0, half_edges(box), box};
  local.radius = norm(local.half) * (1 + 4 * std::numeric_limits<double>::epsilon());
  if (!term.to_local) return local;
  local.center = (*term.to_local)(local.center);
  local.stretch = stretch_bound(term.to_local->linear);
  local.radius *= local.stretch;
  local.box = {};
  for (int corner = 0; corner < 8; ++corner)
    local.box.include((*term.to_local)(box.corner(corner)));
  return local;
}

/// Lower bounds of the distance between a primitive and a box that shrinks to its centre.
struct Gap {
  double distance = 0.0;  ///< from the centre
  double contact = 0.0;   ///< from the centre to some point of the primitive, near the nearest
  double reach = 0.0;     ///< how far the box extends towards the primitive
  double slack = 0.0;     ///< of rounding

  /// Of the box t times its size.
  double near(double t) const { return std::max(0.0, distance - t * reach - slack); }
};

/// As distance(arc, p), without an angle: p lies over the arc where cos(azimuth) >= cos(sweep / 2).
inline double distance_to_arc(const ArcFrame<double>& arc, const Vec3d& p) {
  const Vec3d d = p - arc.center;
  const double x = dot(d, arc.ex);
  const double y = std::abs(dot(d, arc.ey));
  const double z = dot(d, arc.normal);
  const double rho = std::sqrt(x * x + y * y);
  const double cosine = 2 * arc.cos_quarter * arc.cos_quarter - 1;
  if (x >= rho * cosine) return std::sqrt((rho - arc.radius) * (rho - arc.radius) + z * z);
  const double dx = x - arc.radius * cosine;
  const double dy = y - arc.radius * arc.sin_half;
  return std::sqrt(dx * dx + dy * dy + z * z);
}

/// How far a box of those half edges in the scene extends along a direction in local coordinates.
inline double extent_along(const Term& term, const Vec3d& direction, const Vec3d& half) {
  const Vec3d way = term.to_local ? transpose(term.to_local->linear) * direction : direction;
  return extent_along(way, half);
}

/// The least (p - v) . direction over the vertices of a convex primitive.
inline double separation(const Point& point, const Vec3d& p, const Vec3d& direction) {
  return dot(p - point.position, direction);
}
inline double separation(const Segment& segment, const Vec3d& p, const Vec3d& direction) {
  return std::min(dot(p - segment.a, direction), dot(p - segment.b, direction));
}
inline double separation(const TaperedSegment& segment, const Vec3d& p, const Vec3d& direction) {
  return separation(segment.axis, p, direction);
}
inline double separation(const Triangle& triangle, const Vec3d& p, const Vec3d& direction) {
  const auto& v = triangle.vertex;
  return std::min({dot(p - v[0], direction), dot(p - v[1], direction), dot(p - v[2], direction)});
}
/// Of an arc likewise, in closed form.
inline double separation(const Arc& arc, const Vec3d& p, const Vec3d& direction) {
  const double x = dot(arc.ex, direction), y = dot(arc.ey, direction);
  // How far its points lie along the direction at most: x cos t + y sin t from the centre.
  const double half = 0.5 * arc.sweep;
  const bool within = std::abs(std::atan2(y, x)) < half;
  const double ahead =
      within ? std::hypot(x, y) : x * std::cos(half) + std::abs(y) * std::sin(half);
  return dot(p - arc.center, direction) - arc.radius * ahead;
}
/// Of a plane along its normal, on either side.
inline double separation(const Plane& plane, const Vec3d& p, const Vec3d& direction) {
  return std::abs(dot(p - plane.point, direction));
}

/// How large a primitive is beside a point; of a plane, how large the coordinates are that tell the
/// distance.
template <class P>
double extent(const P& primitive, const Vec3d& /*p*/) {
  return size(primitive);
}
inline double extent(const Plane& plane, const Vec3d& p) {
  return norm(p) + norm(plane.point);
}

/// Of the box with that centre (in local coordinates) and those half edges (in the scene); radius
/// is half its diagonal in local coordinates. A convex primitive lies behind the plane through the
/// nearest point and across the way to it; an arc need not.
template <class P>
Gap gap(const Term& term, const P& primitive, const Vec3d& center, const Vec3d& half,
        double radius) {
  constexpr double kUlps = 16 * std::numeric_limits<double>::epsilon();
  Gap g;
  if constexpr (std::is_same_v<P, Arc>) {
    g.distance = distance_to_arc(frame_for<Arc>(term), center);
    g.contact = g.distance;
    g.reach = radius;
  } else {
    const Vec3d way = center - nearest_point(primitive, center);
    g.contact = norm(way);
    if (!(g.contact > 0)) return g;
    Vec3d direction = way / g.contact;
    // All but on a plane, the way is what rounding left of it.
    if constexpr (std::is_same_v<P, Plane>) direction = primitive.normal;
    g.distance = std::max(0.0, separation(primitive, center, direction));
    g.reach = extent_along(term, direction, half);
  }
  g.slack = kUlps * (g.contact + extent(primitive, center) + radius);
  return g;
}

/// derivative_bound() at that distance from the primitive; far from it, its mass in the nearest
/// place is as good and cheaper.
template <class K, class P>
double near_bound(const K& kernel, const P& primitive, int order, double near) {
  if constexpr (!std::is_same_v<P, Plane>) {
    // Remainders of higher order are worth a closer look.
    if (near > (order > 2 ? 2.0 : 1.0) * size(primitive)) {
      return mass_bound(primitive) * kernel.derivative_envelope(order, near) * (1 + 1e-12);
    }
  }
  return derivative_bound(kernel, primitive, order, near);
}

/// A lower bound of the distance between a primitive and a box; for points it is the distance, and
/// for segments positive wherever it is: two convex bodies that do not meet are apart along a
/// normal of a face or along the cross product of two edges.
template <class P>
double box_distance(const P& /*primitive*/, const Aabb& /*box*/) {
  return 0.0;
}
inline double box_distance(const Point& point, const Aabb& box) {
  return box.distance(point.position);
}
inline double box_distance(const Segment& segment, const Aabb& box) {
  const Vec3d along = segment.b - segment.a;
  const Vec3d from = segment.a - box.center();
  const Vec3d half = half_edges(box);
  double most = box.distance(bounds(segment));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3d edge;
    edge[axis] = 1.0;
    const Vec3d way = cross(along, edge);
    const double length = norm(way);
    if (!(length > 0)) continue;
    const double reach =
        std::abs(way.x) * half.x + std::abs(way.y) * half.y + std::abs(way.z) * half.z;
    most = std::max(most, (std::abs(dot(from, way)) - reach) / length);
  }
  return most;
}

inline double box_distance(const TaperedSegment& segment, const Aabb& box) {
  return box_distance(segment.axis, box);
}

/// A lower bound of the distance of the primitive from a box, an upper bound of that of any of its
/// elements, and the scale of coordinates relative to it.
struct Reach {
  double near = 0.0, far = 0.0, scale = 0.0;
};

template <class P>
Reach reach(const Term& term, const P& primitive, const LocalBox& local) {
  const Gap g = gap(term, primitive, local.center, local.half, local.radius);
  Reach r;
  r.near = g.near(1.0);
  // Of boxes that are far beside their size, balls tell enough.
  if (r.near < local.radius) {
    r.near = std::max(r.near, box_distance(primitive, local.box) * (1 - 1e-12) - g.slack);
  }
  r.scale = g.contact + extent(primitive, local.center);
  r.far = g.contact + size(primitive) + local.radius + g.slack;
  // Of p in local coordinates the map leaves an error of its own.
  if (term.to_local) r.scale += norm(local.center) + norm(term.to_local->translation);
  return r;
}

/// Contains the integral alone.
template <class K, class P>
Interval integral_range(const K& kernel, const P& primitive, const Reach& r) {
  const double highest = near_bound(kernel, primitive, 0, r.near);
  // Every element of the primitive is nearer than r.far, and h decreases.
  const double mass = measure(primitive);
  const double lowest =
      std::isfinite(mass) ? mass * kernel.profile(r.far * r.far) * (1 - 1e-12) : 0.0;
  return {std::min(lowest, highest), highest};
}

/// Where the weight may be of both signs, int w h is between its least and its greatest value, or
/// 0, times int h. Where it is not negative, every element of it is nearer than r.far, as above.
template <class K>
Interval integral_range(const K& kernel, const TaperedSegment& segment, const Reach& r) {
  const SegmentWeight& w = segment.weight;
  if (std::min({w.b0, w.b1, w.b2}) >= 0) {
    const double highest = near_bound(kernel, segment, 0, r.near);
    const double mass = mean(w) * measure(segment);
    return {std::min(mass * kernel.profile(r.far * r.far) * (1 - 1e-12), highest), highest};
  }
  const double plain = near_bound(kernel, segment.axis, 0, r.near);
  const Interval weights = hull(range(w), 0.0);
  return {weights.lo * plain * (1 + 1e-12), weights.hi * plain * (1 + 1e-12)};
}

/// Value and gradient whose rounding is that of a field's, if they are greater than the field's
/// own: where a weight has coefficients of both signs, those of the field with their absolute
/// values.
struct RoundingSize {
  double value = 0.0, slope = 0.0;
};
template <class K, class P>
RoundingSize rounding_size(const K& /*kernel*/, const P& /*primitive*/, const Reach& /*r*/) {
  return {};
}
template <class K>
RoundingSize rounding_size(const K& kernel, const TaperedSegment& segment, const Reach& r) {
  const SegmentWeight& w = segment.weight;
  if (std::min({w.b0, w.b1, w.b2}) >= 0) return {};
  const double greatest = std::max({std::abs(w.b0), std::abs(w.b1), std::abs(w.b2)});
  return {greatest * near_bound(kernel, segment.axis, 0, r.near),
          greatest * near_bound(kernel, segment.axis, 1, r.near)};
}

// The closed forms and rules are tested to 64 ulp of backward error.
inline constexpr double kBackwardError = 64 * std::numeric_limits<double>::epsilon();

/// Longest edge over smallest height of a triangle, 1 for the others: how much the rounding of the
/// vertices is magnified.
template <class P>
double condition_number(const P& /*primitive*/) {
  return 1;
}
inline double condition_number(const Triangle& triangle) {
  const double longest = size(triangle);
  return std::min(longest * longest / (2 * measure(triangle)), 1e12);
}

/// What rounding leaves open of a gradient of norm `slope`, where curvature is at most `turn`.
inline double gradient_error(double condition, double slope, double turn, double scale) {
  return kBackwardError * (condition * slope + turn * scale);
}

/// Moves the points to local coordinates and takes the integral there.
template <class K, class P>
void local_jets(const Term& term, const K& kernel, const P& primitive, std::span<Vec3d> points,
                std::span<Jet> jets) {
  if (term.to_local) {
    for (Vec3d& p : points) p = (*term.to_local)(p);
  }
  std::fill_n(jets.begin(), points.size(), Jet{});
  add_integrals(term, kernel, primitive, 1.0, std::span<const Vec3d>(points),
                jets.first(points.size()));
}

/// near_bound(), for order 3 that between kinks, for many distances from `near` to near + span, for
/// the price of a few: it falls with the distance, so a step function of that will do.
template <class K, class P>
class BoundSteps {
 public:
  /// Nothing is nearer than `near`. A span of 0 makes no steps: each bound is computed.
  BoundSteps(const K& kernel, const P& primitive, int order, double near, double span)
      : kernel_(kernel), primitive_(primitive), order_(order), near_(near), step_(span / kSteps) {
    bounds_.fill(-1.0);
  }
  double at(double distance) {
    if (!(step_ > 0.0)) return bound(std::max(distance, near_));
    const double steps = std::clamp((distance - near_) / step_, 0.0, kSteps - 1.0);
    const auto k = static_cast<std::size_t>(steps);
    if (bounds_[k] < 0.0) {
      bounds_[k] = bound(near_ + static_cast<double>(k) * step_);
    }
    return bounds_[k];
  }

 private:
  static constexpr int kSteps = 16;

  double bound(double distance) const {
    if constexpr (kHasKinks<K> && !std::is_same_v<P, Plane>) {
      if (order_ == 3) return near_bound(SmoothPieces<K>{kernel_}, primitive_, order_, distance);
    }
    return near_bound(kernel_, primitive_, order_, distance);
  }

  const K& kernel_;
  const P& primitive_;
  int order_;
  double near_ = 0.0, step_ = 0.0;
  std::array<double, kSteps> bounds_;
};

}  // namespace cs2mesh
