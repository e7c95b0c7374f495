// Where a triangle with its corners on a surface is likely to be farthest from it.
#pragma once

#include <array>
#include <cmath>

#include "libfield/base/jet.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// The point of a triangle that is farthest from a sphere through its corners: the circumcentre if
/// the triangle is acute, else the middle of its longest side.
inline Vec3d sample_point(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Vec3d p[3] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  double side[3];  // squared length, opposite to the corner
  for (std::size_t i = 0; i < 3; ++i) side[i] = squared_norm(p[(i + 2) % 3] - p[(i + 1) % 3]);
  const double all = side[0] + side[1] + side[2];
  // Barycentric weights a^2 (b^2 + c^2 - a^2) of the circumcentre.
  double weight[3];
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(2 * side[i] < all)) return 0.5 * (p[(i + 1) % 3] + p[(i + 2) % 3]);
    weight[i] = side[i] * (all - 2 * side[i]);
  }
  const double sum = weight[0] + weight[1] + weight[2];
  return (weight[0] / sum) * p[0] + (weight[1] / sum) * p[1] + (weight[2] / sum) * p[2];
}

/// Points all over a triangle, for a closer look: on its edges half way and a quarter from either
/// end (a chord across a crease is mostly farthest from it off its middle), its centroid, and the
/// points half way from that to the corners.
inline std::array<Vec3d, 13> closer_points(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  const Vec3d p[3] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  const Vec3d center = (p[0] + p[1] + p[2]) / 3.0;
  std::array<Vec3d, 13> points;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double share : {0.5, 0.25, 0.75}) {
      points[count++] = (1 - share) * p[i] + share * p[(i + 1) % 3];
    }
    points[count++] = 0.5 * (center + p[i]);
  }
  points[count] = center;
  return points;
}

/// |F| / |grad F|, or `otherwise` where the gradient does not tell.
inline double first_order_distance(const Jet& jet, double otherwise) {
  if (jet.value == 0) return 0.0;
  const double distance = std::abs(jet.value) / norm(jet.gradient);
  return distance <= otherwise ? distance : otherwise;
}

}  // namespace cs2mesh
