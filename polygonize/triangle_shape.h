// How well the triangles of a mesh are shaped.
#pragma once

#include <algorithm>
#include <cstddef>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Triangles with an angle below this, in degrees, count as thin.
inline constexpr double kThinAngle = 20.0;

/// The smallest angle of a triangle, in degrees: 60 if it is equilateral, 0 if two corners or all
/// lie on a line. 0 for corners that are not finite.
double smallest_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c);
/// Its tangent, which tells the same of which triangle is the thinner, sooner.
inline double tangent_of_smallest_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  // It lies opposite to the shortest side, hence at the corner with the greatest product of edges:
  // the square of a side is the sum of the products at its ends.
  const Vec3d u = b - a, v = c - b, w = a - c;
  const double beside = std::max({-dot(u, v), -dot(v, w), -dot(w, u)});
  const double twice_area = norm(cross(u, v));
  return twice_area > 0 ? twice_area / beside : 0.0;
}
/// The tangent of an angle in degrees.
double tangent_of(double degrees);

struct TriangleShapes {
  double min_angle_deg = 60.0;  ///< of all; 60 for a mesh without triangles
  std::size_t thin = 0;         ///< triangles with an angle below kThinAngle
};

/// Triangles with an index out of range are left out. O(n).
TriangleShapes triangle_shapes(const TriangleMesh& mesh);

}  // namespace cs2mesh
