#include "libfield/art/decompose.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace cs2mesh {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// Turns two columns of `a` by the angle that makes them orthogonal, and those of `v` alike.
/// Returns the cosine between them before.
double orthogonalize(Mat3& a, Mat3& v, std::size_t i, std::size_t j) {
  // The rows of these matrices are the columns of the decomposition's.
  const double ii = squared_norm(a.row[i]);
  const double jj = squared_norm(a.row[j]);
  const double ij = dot(a.row[i], a.row[j]);
  if (ij == 0.0) return 0.0;
  const double zeta = (jj - ii) / (2.0 * ij);
  const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + std::hypot(1.0, zeta));
  const double c = 1.0 / std::hypot(1.0, t);
  const double s = c * t;
  for (Mat3* m : {&a, &v}) {
    const Vec3d p = m->row[i];
    const Vec3d q = m->row[j];
    m->row[i] = c * p - s * q;
    m->row[j] = s * p + c * q;
  }
  return std::abs(ij) / std::sqrt(ii * jj);
}

/// Axis and angle of a rotation matrix, by its quaternion's largest component.
TransformStep rotation(const Mat3& m) {
  const auto& r = m.row;
  const double trace = r[0].x + r[1].y + r[2].z;
  double w = 0;
  Vec3d q;
  if (trace > 0) {
    w = 1.0 + trace;
    q = {r[2].y - r[1].z, r[0].z - r[2].x, r[1].x - r[0].y};
  } else {
    const std::size_t i = r[0].x >= r[1].y && r[0].x >= r[2].z ? 0 : r[1].y >= r[2].z ? 1 : 2;
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    w = r[k][j] - r[j][k];
    q[i] = 1.0 + r[i][i] - r[j][j] - r[k][k];
    q[j] = r[j][i] + r[i][j];
    q[k] = r[k][i] + r[i][k];
  }
  const double sine = norm(q);
  if (sine == 0.0) return {TransformStep::Kind::rotate, {0, 0, 1}, 0.0};
  return {TransformStep::Kind::rotate, q / sine, 2.0 * std::atan2(sine, w) * kDegreesPerRadian};
}

void append_rotation(const Mat3& m, std::vector<TransformStep>& steps) {
  const TransformStep step = rotation(m);
  if (step.degrees != 0.0) steps.push_back(step);
}

bool is_diagonal(const Mat3& m) {
  return m.row[0].y == 0 && m.row[0].z == 0 && m.row[1].x == 0 && m.row[1].z == 0 &&
         m.row[2].x == 0 && m.row[2].y == 0;
}

void append_linear(const Mat3& linear, std::vector<TransformStep>& steps) {
  if (linear == Mat3{}) return;
  if (is_diagonal(linear)) {
    steps.push_back(
        {TransformStep::Kind::scale, {linear.row[0].x, linear.row[1].y, linear.row[2].z}, 0.0});
    return;
  }

  // Rotate the columns until they are orthogonal: A V = U S.
  Mat3 a = transpose(linear);
  Mat3 v;
  constexpr int kMaxSweeps = 60;  // it converges quadratically, in about 6
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double cosine = 0.0;
    for (std::size_t i = 0; i < 3; ++i) cosine += orthogonalize(a, v, i, (i + 1) % 3);
    if (cosine <= std::numeric_limits<double>::epsilon()) break;
  }

  // Split U S; V is a rotation already, U becomes one by the sign of a factor.
  Vec3d factors;
  Mat3 u;
  for (std::size_t i = 0; i < 3; ++i) {
    factors[i] = norm(a.row[i]);
    u.row[i] = a.row[i] / factors[i];
  }
  if (determinant(u) < 0) {
    factors.z = -factors.z;
    u.row[2] = -u.row[2];
  }
  constexpr double kSimilar = 1e-15;
  const bool uniform = std::abs(factors.x - factors.y) <= kSimilar * factors.x &&
                       std::abs(factors.x - factors.z) <= kSimilar * factors.x;
  if (uniform) {
    append_rotation(transpose(u) * v, steps);
    if (factors != Vec3d{1, 1, 1}) steps.push_back({TransformStep::Kind::scale, factors, 0.0});
    return;
  }
  append_rotation(v, steps);
  steps.push_back({TransformStep::Kind::scale, factors, 0.0});
  append_rotation(transpose(u), steps);
}

}  // namespace

std::vector<TransformStep> decompose(const Affine& map) {
  std::vector<TransformStep> steps;
  append_linear(map.linear, steps);
  if (map.translation != Vec3d{}) {
    steps.push_back({TransformStep::Kind::translate, map.translation, 0.0});
  }
  return steps;
}

}  // namespace cs2mesh
