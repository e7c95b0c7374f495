#include "libfield/base/principal_axes.h"

#include <cmath>

namespace cs2mesh {
namespace {

Mat3 rows_of(const Symmetric3& m) {
  return {{Vec3d{m.xx, m.xy, m.xz}, Vec3d{m.xy, m.yy, m.yz}, Vec3d{m.xz, m.yz, m.zz}}};
}

/// The rotation in the plane of axes i and j that makes the entry (i, j) 0; the smaller of the two
/// angles that do.
Mat3 rotation(const Mat3& a, std::size_t i, std::size_t j) {
  const double zeta = 0.5 * (a.row[j][j] - a.row[i][i]) / a.row[i][j];
  const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + std::hypot(1.0, zeta));
  const double c = 1 / std::hypot(1.0, t);
  Mat3 turn;
  turn.row[i][i] = turn.row[j][j] = c;
  turn.row[i][j] = -t * c;
  turn.row[j][i] = t * c;
  return turn;
}

}  // namespace

PrincipalAxes principal_axes(const Symmetric3& m) {
  Mat3 a = rows_of(m);
  Mat3 axis;
  constexpr int kMostSweeps = 50;  // it converges quadratically, in about 5
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    bool turned = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      if (std::abs(a.row[i][j]) <= 1e-17 * (std::abs(a.row[i][i]) + std::abs(a.row[j][j]))) {
        continue;
      }
      const Mat3 turn = rotation(a, i, j);
      a = turn * a * transpose(turn);
      a.row[i][j] = a.row[j][i] = 0;
      axis = turn * axis;
      turned = true;
    }
    if (!turned) break;
  }
  return {axis, {a.row[0][0], a.row[1][1], a.row[2][2]}};
}

}  // namespace cs2mesh
