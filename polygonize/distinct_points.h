// Points that are given many times, once each.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

#include "libfield/base/vec.h"

namespace cs2mesh {

/// The points of a list, those of equal coordinates once, in the order of their coordinates; none
/// may be NaN. O(n log n).
class DistinctPoints {
 public:
  explicit DistinctPoints(std::span<const Vec3d> points) : number_(points.size()) {
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto coordinates = [&](std::size_t i) {
      return std::array{points[i].x, points[i].y, points[i].z};
    };
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return coordinates(a) < coordinates(b); });
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i == 0 || coordinates(order[i]) != coordinates(order[i - 1])) {
        points_.push_back(points[order[i]]);
      }
      number_[order[i]] = points_.size() - 1;
    }
  }

  std::span<const Vec3d> points() const { return points_; }
  /// Which of points() is the point of that number in the list.
  std::size_t number(std::size_t i) const { return number_[i]; }

 private:
  std::vector<Vec3d> points_;
  std::vector<std::size_t> number_;
};

}  // namespace cs2mesh
