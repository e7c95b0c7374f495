#include "libfield/primitive/nearest_point.h"

#include <algorithm>
#include <cmath>

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

Vec3d nearest_point(const Arc& arc, const Vec3d& p) {
  const Vec3d d = p - arc.center;
  const double half = 0.5 * arc.sweep;
  const double angle = std::clamp(std::atan2(dot(d, arc.ey), dot(d, arc.ex)), -half, half);
  return arc.center + arc.radius * (std::cos(angle) * arc.ex + std::sin(angle) * arc.ey);
}

Vec3d nearest_point(const Triangle& triangle, const Vec3d& p) {
  const auto& [a, b, c] = triangle.vertex;
  const Vec3d n = cross(b - a, c - a);
  // Inside the prism over the triangle the foot is the projection, elsewhere it is on an edge.
  const bool above = dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 &&
                     dot(cross(a - c, p - c), n) >= 0;
  if (above) return p - (dot(p - a, n) / squared_norm(n)) * n;
  Vec3d best = nearest_point(Segment{a, b}, p);
  for (const Segment& edge : {Segment{b, c}, Segment{c, a}}) {
    const Vec3d q = nearest_point(edge, p);
    if (squared_norm(q - p) < squared_norm(best - p)) best = q;
  }
  return best;
}

Vec3d nearest_point(const Plane& plane, const Vec3d& p) {
  return p - dot(p - plane.point, plane.normal) * plane.normal;
}

}  // namespace cs2mesh
