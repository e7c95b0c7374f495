#include "libfield/primitive/plane.h"

#include <cmath>
#include <limits>

#include "libfield/base/check.h"

namespace cs2mesh {

double measure(const Plane&) {
  return std::numeric_limits<double>::infinity();
}

double distance(const Plane& plane, const Vec3d& p) {
  return std::abs(dot(p - plane.point, plane.normal));
}

Aabb bounds(const Plane& plane) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Aabb box{{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double next = plane.normal[(axis + 1) % 3];
    const double last = plane.normal[(axis + 2) % 3];
    if (next == 0.0 && last == 0.0) box.min[axis] = box.max[axis] = plane.point[axis];
  }
  return box;
}

Vec3d middle(const Plane& plane) {
  return plane.point;
}

double size(const Plane&) {
  return std::numeric_limits<double>::infinity();
}

Uv uv(const Plane& plane, const Vec3d& p) {
  const Vec3d x_axis = reference_axis(plane.normal);
  const Vec3d y_axis = cross(plane.normal, x_axis);
  const Vec3d d = p - plane.point;
  return {dot(d, x_axis), dot(d, y_axis), x_axis, y_axis};
}

UvIntervals enclose_uv(const Plane& plane, const Aabb& box) {
  const Vec3d x_axis = reference_axis(plane.normal);
  const Vec3d y_axis = cross(plane.normal, x_axis);
  return {enclose_linear(x_axis, plane.point, box), enclose_linear(y_axis, plane.point, box)};
}

Plane transformed(const Plane& plane, const Affine& map) {
  // Normals go with the inverse transpose, which is the cofactor matrix over the determinant.
  const auto& [r0, r1, r2] = map.linear.row;
  const Mat3 cofactors{{cross(r1, r2), cross(r2, r0), cross(r0, r1)}};
  const Vec3d normal = cofactors * plane.normal;
  require(squared_norm(normal) > 0.0, "a plane needs an invertible map");
  const double side = determinant(map.linear) < 0.0 ? -1.0 : 1.0;
  return {map(plane.point), side * normalized(normal)};
}

}  // namespace cs2mesh
