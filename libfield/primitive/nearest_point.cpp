#include "libfield/primitive/nearest_point.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cs2mesh {

Vec3d nearest_point(const Point& point, const Vec3d& /*p*/) {
  return point.position;
}

Vec3d nearest_point(const Segment& segment, const Vec3d& p) {
  const Vec3d ab = segment.b - segment.a;
  const double t = dot(p - segment.a, ab) / squared_norm(ab);
  return t >= 0.5 ? segment.b - std::clamp(1 - t, 0.0, 1.0) * ab
                  : segment.a + std::clamp(t, 0.0, 1.0) * ab;
}

Vec3d nearest_point(const TaperedSegment& segment, const Vec3d& p) {
  return nearest_point(segment.axis, p);
}

Vec3d nearest_point(const Arc& arc, const Vec3d& p) {
  const Vec3d d = p - arc.center;
  const double half = 0.5 * arc.sweep;
  const double angle = std::clamp(std::atan2(dot(d, arc.ey), dot(d, arc.ex)), -half, half);
  return arc.center + arc.radius * (std::cos(angle) * arc.ex + std::sin(angle) * arc.ey);
}

bool is_above(const Triangle& triangle, const Vec3d& p) {
  const auto& [a, b, c] = triangle.vertex;
  const Vec3d n = cross(b - a, c - a);
  return dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 &&
         dot(cross(a - c, p - c), n) >= 0;
}

namespace {

/// The edge whose nearest point is nearest, and that point.
std::pair<Segment, Vec3d> nearest_on_edges(const Triangle& triangle, const Vec3d& p) {
  const auto& [a, b, c] = triangle.vertex;
  Segment best{a, b};
  Vec3d point = nearest_point(best, p);
  double least = squared_norm(point - p);
  for (const Segment& edge : {Segment{b, c}, Segment{c, a}}) {
    const Vec3d other = nearest_point(edge, p);
    const double squared = squared_norm(other - p);
    if (squared < least) best = edge, point = other, least = squared;
  }
  return {best, point};
}

}  // namespace

Segment nearest_edge(const Triangle& triangle, const Vec3d& p) {
  return nearest_on_edges(triangle, p).first;
}

Vec3d nearest_point(const Triangle& triangle, const Vec3d& p) {
  if (!is_above(triangle, p)) return nearest_on_edges(triangle, p).second;
  const auto& [a, b, c] = triangle.vertex;
  const Vec3d n = cross(b - a, c - a);
  return p - (dot(p - a, n) / squared_norm(n)) * n;
}

Vec3d nearest_point(const Plane& plane, const Vec3d& p) {
  return p - dot(p - plane.point, plane.normal) * plane.normal;
}

}  // namespace cs2mesh
