#include "polygonize/triangle_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cs2mesh {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace

double smallest_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return std::atan(tangent_of_smallest_angle(a, b, c)) / kDegree;
}

double tangent_of(double degrees) {
  return std::tan(degrees * kDegree);
}

TriangleShapes triangle_shapes(const TriangleMesh& mesh) {
  TriangleShapes shapes;
  const auto known = [&](TriangleMesh::Index v) { return v < mesh.positions.size(); };
  for (const auto& t : mesh.triangles) {
    if (!std::all_of(t.begin(), t.end(), known)) continue;
    const double angle =
        smallest_angle(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
    shapes.min_angle_deg = std::min(shapes.min_angle_deg, angle);
    if (angle < kThinAngle) ++shapes.thin;
  }
  return shapes;
}

}  // namespace cs2mesh
