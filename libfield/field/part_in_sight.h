// How far ahead the part of a primitive lies that a ball cuts out of it: what bounds of kernels are
// made of that end somewhere, or nearly so, beside primitives longer than their reach.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libfield/primitive/primitive.h"

namespace cs2mesh {

/// A lower bound of direction . (s - p) over the points s of the primitive within `sight` of p,
/// lengths of any unit; positive if there are none. Takes some 5 ns (points) to 100 ns (arcs).
inline double least_ahead(const Point& point, const Vec3d& p, const Vec3d& direction,
                          double /*sight*/) {
  return dot(point.position - p, direction);
}

/// The ends of the chord that a ball about p cuts out of the segment.
inline double least_ahead(const Segment& segment, const Vec3d& p, const Vec3d& direction,
                          double sight) {
  const Vec3d ab = segment.b - segment.a;
  const double length = norm(ab);
  const Vec3d axis = ab / length, from = segment.a - p;
  const double foot = -dot(from, axis);
  const double across = squared_norm(from + foot * axis);
  if (!(sight * sight > across)) return sight * norm(direction);
  const double half = std::sqrt(sight * sight - across) * (1 + 1e-12);
  const double first = std::max(0.0, foot - half), last = std::min(length, foot + half);
  if (first > last) return sight * norm(direction);
  return dot(from, direction) + std::min(first * dot(axis, direction), last * dot(axis, direction));
}

/// Over the disc that the ball cuts out of its plane.
inline double least_ahead(const Triangle& triangle, const Vec3d& p, const Vec3d& direction,
                          double sight) {
  const auto& v = triangle.vertex;
  const Vec3d area = cross(v[1] - v[0], v[2] - v[0]);
  const Vec3d normal = area / norm(area);
  const double height = dot(v[0] - p, normal);
  if (!(sight > std::abs(height))) return sight * norm(direction);
  const double disc = std::sqrt(sight * sight - height * height) * (1 + 1e-12);
  const double upwards = dot(direction, normal);
  const double in_plane = norm(direction - upwards * normal) + 1e-12 * norm(direction);
  return upwards * height - in_plane * disc;
}

/// From the centre (x, y) . (cos t, sin t), at least, for t from `first` to `last`, at most a turn.
inline double least_along_arc(double x, double y, double first, double last) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double lowest = std::atan2(-y, -x);
  if (lowest + kTurn * std::ceil((first - lowest) / kTurn) <= last) return -std::hypot(x, y);
  return std::min(x * std::cos(first) + y * std::sin(first),
                  x * std::cos(last) + y * std::sin(last));
}

/// Over the window of angles in which |s - p| <= sight, a piece of it before and one behind the
/// arc's seam if there are two.
inline double least_ahead(const Arc& arc, const Vec3d& p, const Vec3d& direction, double sight) {
  constexpr double kTurn = 2 * std::numbers::pi, kSlack = 1e-9;
  const Vec3d d = p - arc.center;
  const double px = dot(d, arc.ex), py = dot(d, arc.ey);
  const double c = arc.radius, half = 0.5 * arc.sweep;
  const double rho = std::hypot(px, py);
  const double cosine = (squared_norm(d) + c * c - sight * sight) / (2 * c * rho);
  if (cosine > 1) return sight * norm(direction);
  const double x = c * dot(arc.ex, direction), y = c * dot(arc.ey, direction);
  const double to_center = dot(arc.center - p, direction);
  if (!(cosine > -1)) return to_center + least_along_arc(x, y, -half, half);
  const double window = std::acos(cosine) + kSlack, azimuth = std::atan2(py, px);
  double least = sight * norm(direction);
  for (const double shift : {-kTurn, 0.0, kTurn}) {
    const double first = std::max(-half, azimuth - window + shift);
    const double last = std::min(half, azimuth + window + shift);
    if (first <= last) least = std::min(least, to_center + least_along_arc(x, y, first, last));
  }
  return least;
}

}  // namespace cs2mesh
