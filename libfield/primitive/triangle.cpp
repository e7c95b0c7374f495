#include "libfield/primitive/triangle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/primitive/segment.h"

namespace cs2mesh {

Vec3d area_vector(const Triangle& triangle) {
  const auto& v = triangle.vertex;
  const std::array<Vec3d, 3> edge{v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  std::size_t longest = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    if (squared_norm(edge[i]) > squared_norm(edge[longest])) longest = i;
  }
  return cross(edge[(longest + 1) % 3], edge[(longest + 2) % 3]);
}

double measure(const Triangle& triangle) {
  return 0.5 * norm(area_vector(triangle));
}

double distance(const Triangle& triangle, const Vec3d& p) {
  // The nearest point is on an edge, or the foot of p if that lies inside.
  const auto& v = triangle.vertex;
  const Vec3d area = area_vector(triangle);
  double nearest = std::numeric_limits<double>::infinity();
  bool foot_inside = squared_norm(area) > 0.0;
  std::size_t nearest_vertex = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d& a = v[i];
    const Vec3d& b = v[(i + 1) % 3];
    nearest = std::min(nearest, distance(Segment{a, b}, p));
    foot_inside = foot_inside && dot(cross(area, b - a), p - a) >= 0.0;
    if (squared_norm(p - a) < squared_norm(p - v[nearest_vertex])) nearest_vertex = i;
  }
  if (!foot_inside) return nearest;
  return std::min(nearest, std::abs(dot(p - v[nearest_vertex], normalized(area))));
}

Aabb bounds(const Triangle& triangle) {
  Aabb box;
  for (const Vec3d& vertex : triangle.vertex) box.include(vertex);
  return box;
}

Vec3d middle(const Triangle& triangle) {
  const auto& v = triangle.vertex;
  return v[0] + ((v[1] - v[0]) + (v[2] - v[0])) / 3.0;
}

double size(const Triangle& triangle) {
  const auto& v = triangle.vertex;
  return std::max({norm(v[1] - v[0]), norm(v[2] - v[1]), norm(v[0] - v[2])});
}

namespace {

struct Gradients {
  Vec3d u, v;
};

// The dual basis of the two edges at V1; zero if the triangle has no area.
Gradients gradients(const Triangle& triangle) {
  const Vec3d area = area_vector(triangle);
  const double squared_area = squared_norm(area);
  if (!(squared_area > 0.0)) return {};
  const Vec3d edge_u = triangle.vertex[1] - triangle.vertex[0];
  const Vec3d edge_v = triangle.vertex[2] - triangle.vertex[0];
  return {cross(edge_v, area) / squared_area, cross(area, edge_u) / squared_area};
}

}  // namespace

Uv uv(const Triangle& triangle, const Vec3d& p) {
  const Gradients g = gradients(triangle);
  const Vec3d d = p - triangle.vertex[0];
  const double u = dot(d, g.u);
  const double v = dot(d, g.v);
  Uv result{std::clamp(u, 0.0, 1.0), std::clamp(v, 0.0, 1.0), {}, {}};
  if (0.0 < u && u < 1.0) result.grad_u = g.u;
  if (0.0 < v && v < 1.0) result.grad_v = g.v;
  return result;
}

UvIntervals enclose_uv(const Triangle& triangle, const Aabb& box) {
  const Gradients g = gradients(triangle);
  const Vec3d& origin = triangle.vertex[0];
  const double reach = box.farthest_distance(origin);
  const auto enclose = [&](const Vec3d& gradient) {
    const double slack = 1e-15 * norm(gradient) * reach;
    return clamped_to_unit(widened(enclose_linear(gradient, origin, box), slack));
  };
  return {enclose(g.u), enclose(g.v)};
}

Triangle transformed(const Triangle& triangle, const Affine& map) {
  const auto& v = triangle.vertex;
  return {{map(v[0]), map(v[1]), map(v[2])}};
}

}  // namespace cs2mesh
