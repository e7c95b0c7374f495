// Where a triangle with its corners on a surface is likely to be farthest from it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

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

/// What F - T is to the first order in log F, F being `value` + T with T = 1: fields are as steep
/// as exponentials, so that is nearer to linear, and inside them F - T alone would hide how deep.
/// Below F = 0 the value itself.
inline double leveled(double value) {
  return value > -1 ? (1 + value) * std::log1p(value) : value;
}

/// As norm(), also where the squares of the components overflow: deep inside of stiff fields.
inline double norm_of_any(const Vec3d& a) {
  const double length = norm(a);
  return length <= std::numeric_limits<double>::max() ? length : std::hypot(a.x, a.y, a.z);
}

/// The distance to the surface as |F| and |grad F| tell it, or `otherwise` where the gradient does
/// not; of the linear and the logarithmic estimate the greater.
inline double first_order_distance(const Jet& jet, double otherwise) {
  if (jet.value == 0) return 0.0;
  const double rise = std::max(std::abs(jet.value), std::abs(leveled(jet.value)));
  const double distance = rise / norm_of_any(jet.gradient);
  return distance <= otherwise ? distance : otherwise;
}

/// How closely a triangle is to be looked at.
enum class Look { enough, closer, all_over };

/// What the jet at the sample point of a triangle leaves open: closer from the distance `closer`
/// on, all over where the surface leans away from the triangle, so that it turns within it.
inline Look look_of(const TriangleMesh& mesh, std::size_t triangle, const Jet& jet, double distance,
                    double closer, double small) {
  constexpr double kLeaning = 0.9;  // cosine
  const Vec3d area = area_vector(mesh, triangle);
  if (!(-dot(area, jet.gradient) > kLeaning * norm(area) * norm(jet.gradient))) {
    return small > 0 ? Look::all_over : Look::closer;
  }
  const auto& t = mesh.triangles[triangle];
  const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  const double longest = std::max({squared_norm(b - a), squared_norm(c - b), squared_norm(a - c)});
  return distance > closer || longest < small * small ? Look::closer : Look::enough;
}

/// The points of that look beyond the sample point.
inline std::vector<Vec3d> more_points(const TriangleMesh& mesh, std::size_t triangle, Look look) {
  std::vector<Vec3d> points;
  if (look == Look::enough) return points;
  const auto few = closer_points(mesh, triangle);
  points.assign(few.begin(), few.end());
  if (look == Look::all_over) {
    constexpr int kSteps = 9;
    const auto& t = mesh.triangles[triangle];
    const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        points.push_back((1.0 / kSteps) * (i * a + j * b + (kSteps - i - j) * c));
      }
    }
  }
  return points;
}

}  // namespace cs2mesh
