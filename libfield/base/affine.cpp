#include "libfield/base/affine.h"

#include <cmath>
#include <numbers>

namespace cs2mesh {

Mat3 operator*(const Mat3& a, const Mat3& b) {
  const Mat3 columns = transpose(b);
  Mat3 product;
  for (std::size_t i = 0; i < 3; ++i) {
    product.row[i] = {dot(a.row[i], columns.row[0]), dot(a.row[i], columns.row[1]),
                      dot(a.row[i], columns.row[2])};
  }
  return product;
}

Mat3 transpose(const Mat3& m) {
  return {{Vec3d{m.row[0].x, m.row[1].x, m.row[2].x}, Vec3d{m.row[0].y, m.row[1].y, m.row[2].y},
           Vec3d{m.row[0].z, m.row[1].z, m.row[2].z}}};
}

double determinant(const Mat3& m) {
  return dot(m.row[0], cross(m.row[1], m.row[2]));
}

Mat3 inverse(const Mat3& m) {
  const double scale = 1.0 / determinant(m);
  return transpose({{scale * cross(m.row[1], m.row[2]), scale * cross(m.row[2], m.row[0]),
                     scale * cross(m.row[0], m.row[1])}});
}

double similarity_factor(const Mat3& m) {
  constexpr double kTolerance = 1e-12;
  const double squared =
      (squared_norm(m.row[0]) + squared_norm(m.row[1]) + squared_norm(m.row[2])) / 3;
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::abs(squared_norm(m.row[i]) - squared) > kTolerance * squared) return 0.0;
    if (std::abs(dot(m.row[i], m.row[(i + 1) % 3])) > kTolerance * squared) return 0.0;
  }
  return std::sqrt(squared);
}

double stretch_bound(const Mat3& m) {
  if (const double k = similarity_factor(m); k > 0) return k * (1 + 1e-11);
  return std::sqrt(squared_norm(m.row[0]) + squared_norm(m.row[1]) + squared_norm(m.row[2]));
}

Affine Affine::scale(const Vec3d& s) {
  return {{{Vec3d{s.x, 0, 0}, Vec3d{0, s.y, 0}, Vec3d{0, 0, s.z}}}, {}};
}

Affine Affine::rotate(const Vec3d& axis, double degrees) {
  // Rodrigues' formula.
  const Vec3d n = normalized(axis);
  const double angle = degrees * (std::numbers::pi / 180.0);
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double v = 1.0 - c;
  return {{{Vec3d{c + n.x * n.x * v, n.x * n.y * v - n.z * s, n.x * n.z * v + n.y * s},
            Vec3d{n.y * n.x * v + n.z * s, c + n.y * n.y * v, n.y * n.z * v - n.x * s},
            Vec3d{n.z * n.x * v - n.y * s, n.z * n.y * v + n.x * s, c + n.z * n.z * v}}},
          {}};
}

Affine inverse(const Affine& m) {
  const Mat3 linear = inverse(m.linear);
  return {linear, -(linear * m.translation)};
}

}  // namespace cs2mesh
