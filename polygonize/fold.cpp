#include "polygonize/fold.h"

namespace cs2mesh {
namespace {

Vec3d normal(const TriangleCorners& t) {
  return cross(t[1] - t[0], t[2] - t[0]);
}

}  // namespace

bool faces_outward(const ImplicitSurface& surface, const TriangleCorners& triangle) {
  constexpr double kLeast = 0.3;  // cosine
  const Vec3d middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
  const Vec3d gradient = surface.jet(middle).gradient, n = normal(triangle);
  return -dot(n, gradient / norm(gradient)) > kLeast * norm(n);
}

bool folded(const ImplicitSurface& surface, const TriangleCorners& one,
            const TriangleCorners& other, double sharpest) {
  const Vec3d a = normal(one), b = normal(other);
  if (dot(a, b) > sharpest * norm(a) * norm(b)) return false;
  return !faces_outward(surface, one) || !faces_outward(surface, other);
}

}  // namespace cs2mesh
