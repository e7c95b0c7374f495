#include "polygonize/plane_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cs2mesh {
namespace {

using Row = std::array<double, 3>;
using Matrix = std::array<Row, 3>;

/// A rotation in the plane of axes p and q that makes m[p][q] vanish (Jacobi 1846), gathered in the
/// columns of `axes`.
void rotate(Matrix& m, Matrix& axes, std::size_t p, std::size_t q) {
  if (m[p][q] == 0) return;
  const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
  const double t = (theta >= 0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
  const double c = 1 / std::sqrt(t * t + 1), s = t * c;
  for (std::size_t k = 0; k < 3; ++k) {
    const double kp = m[k][p], kq = m[k][q];
    m[k][p] = c * kp - s * kq;
    m[k][q] = s * kp + c * kq;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double pk = m[p][k], qk = m[q][k];
    m[p][k] = c * pk - s * qk;
    m[q][k] = s * pk + c * qk;
    const double kp = axes[k][p], kq = axes[k][q];
    axes[k][p] = c * kp - s * kq;
    axes[k][q] = s * kp + c * kq;
  }
}

}  // namespace

Vec3d point_near_planes(std::span<const Plane> planes, const Vec3d& start, double cutoff) {
  // Normal equations about the start: (sum n n^T) x = sum n (offset - n . start).
  Matrix m{};
  Vec3d right{};
  for (const Plane& plane : planes) {
    const Vec3d& n = plane.normal;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) m[i][j] += n[i] * n[j];
    }
    right += (plane.offset - dot(n, start)) * n;
  }

  // Principal directions; the sweeps converge quadratically.
  constexpr int kSweeps = 6;
  Matrix axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    rotate(m, axes, 0, 1);
    rotate(m, axes, 0, 2);
    rotate(m, axes, 1, 2);
  }
  const double strongest = std::max({m[0][0], m[1][1], m[2][2]});
  Vec3d x = start;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(m[k][k] > cutoff * strongest)) continue;
    const Vec3d axis{axes[0][k], axes[1][k], axes[2][k]};
    x += (dot(axis, right) / m[k][k]) * axis;
  }
  return x;
}

}  // namespace cs2mesh
