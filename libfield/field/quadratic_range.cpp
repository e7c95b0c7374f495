#include "libfield/field/quadratic_range.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cs2mesh {
namespace {

/// The axes that are still free, the others having been put to an end of the box.
struct Free {
  std::array<bool, 3> axis{true, true, true};
  Vec3d g;
  double value = 0.0;  ///< of the axes that are not
};

class Quadratic {
 public:
  Quadratic(const Symmetric3& h, const Vec3d& half) : half_(half) {
    rows_ = {Vec3d{h.xx, h.xy, h.xz}, Vec3d{h.xy, h.yy, h.yz}, Vec3d{h.xz, h.yz, h.zz}};
  }

  /// An upper bound of the greatest value.
  double greatest(Free free) const {
    // Where the slope along an axis keeps its sign, the greatest value is at that end.
    for (std::size_t i = 0; i < 3;) {
      if (free.axis[i] && std::abs(free.g[i]) >= variation(free, i)) {
        put(free, i, free.g[i] >= 0 ? half_[i] : -half_[i]);
        i = 0;  // the slopes of the others have changed
      } else {
        ++i;
      }
    }
    // Along an axis of positive curvature it is at one of the two.
    for (std::size_t i = 0; i < 3; ++i) {
      if (!free.axis[i] || rows_[i][i] < 0) continue;
      Free other = free;
      put(free, i, half_[i]);
      put(other, i, -half_[i]);
      return std::max(greatest(free), greatest(other));
    }
    return free.value + separate(free);
  }

 private:
  /// How much the slope along an axis may differ from g.
  double variation(const Free& free, std::size_t i) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < 3; ++j) {
      if (free.axis[j]) sum += std::abs(rows_[i][j]) * half_[j];
    }
    return sum;
  }

  void put(Free& free, std::size_t i, double end) const {
    free.axis[i] = false;
    free.value += (free.g[i] + 0.5 * rows_[i][i] * end) * end;
    for (std::size_t j = 0; j < 3; ++j) free.g[j] += rows_[i][j] * end;
  }

  /// The greatest value along each of the free axes, whose curvature is negative, and what their
  /// products may add.
  double separate(const Free& free) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!free.axis[i]) continue;
      const double top = std::clamp(-free.g[i] / rows_[i][i], -half_[i], half_[i]);
      sum += (free.g[i] + 0.5 * rows_[i][i] * top) * top;
      for (std::size_t j = 0; j < i; ++j) {
        if (free.axis[j]) sum += std::abs(rows_[i][j]) * half_[i] * half_[j];
      }
    }
    return sum;
  }

  std::array<Vec3d, 3> rows_;
  Vec3d half_;
};

}  // namespace

Interval quadratic_range(const Vec3d& g, const Symmetric3& h, const Vec3d& half) {
  const double slope = std::abs(g.x) * half.x + std::abs(g.y) * half.y + std::abs(g.z) * half.z;
  if (h == Symmetric3{}) return widened(Interval(0.0), slope * (1 + 1e-14));
  const Free up{{true, true, true}, g, 0.0}, down{{true, true, true}, -g, 0.0};
  const double most = Quadratic(h, half).greatest(up);
  const double least = -Quadratic(-1.0 * h, half).greatest(down);
  const double size = slope + norm(h) * squared_norm(half);
  return widened(Interval(std::min(least, 0.0), std::max(most, 0.0)), 1e-14 * size);
}

}  // namespace cs2mesh
