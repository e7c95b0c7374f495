// How high a surface is above a triangle, as F at the corners tells: by its value the height there,
// by its gradient the normal, which says how the surface bends in between (sagitta.h). To second
// order, so that it takes a look elsewhere to know whether it holds.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libfield/base/jet.h"
#include "polygonize/fold.h"
#include "polygonize/sagitta.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {

class ToldHeights {
 public:
  /// The corners counter-clockwise seen from outside, and the jets of F there.
  ToldHeights(const TriangleCorners& corners, const std::array<Jet, 3>& jets) : corners_(corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      normals_[k] = -1.0 / norm_of_any(jets[k].gradient) * jets[k].gradient;
      heights_[k] = height_of(jets[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      rises_[k] = sagitta(corners[k], normals_[k], corners[next], normals_[next]);
    }
  }

  /// How far the surface is from where it would be above a point of the triangle, as F tells there,
  /// to the first order. Infinite where F tells nothing.
  double off_by(const Vec3d& point, const Jet& jet) const {
    const double off = std::abs(height_of(jet) - at(point));
    return std::isfinite(off) ? off : std::numeric_limits<double>::infinity();
  }

  /// Whether the surface is within that distance of the triangle all over if it is nowhere farther
  /// than twice `off` from what is told, and the normals tell of it: not where it turns by more
  /// than 60 degrees between two corners, or leans as much against the triangle.
  bool are_within(double distance, double off) const {
    constexpr double kTurn = 0.5;  // cosine
    const Vec3d area = cross(corners_[1] - corners_[0], corners_[2] - corners_[0]);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(dot(normals_[k], normals_[(k + 1) % 3]) > kTurn)) return false;
      if (!(dot(normals_[k], area) > kTurn * norm(area))) return false;
    }
    const auto [low, high] = deviation_range(rises_[0], rises_[1], rises_[2]);
    const std::pair<double, double> range = std::minmax({heights_[0], heights_[1], heights_[2]});
    const double slack = 2 * off + skew();
    return high + range.second + slack <= distance && -low - range.first + slack <= distance;
  }

 private:
  static double height_of(const Jet& jet) { return leveled(jet.value) / norm_of_any(jet.gradient); }

  double at(const Vec3d& point) const {
    const Vec3d area = cross(corners_[1] - corners_[0], corners_[2] - corners_[0]);
    std::array<double, 3> weight{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d &a = corners_[(k + 1) % 3], &b = corners_[(k + 2) % 3];
      weight[k] = dot(area, cross(a - point, b - point)) / squared_norm(area);
    }
    double height = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      height += weight[k] * (heights_[k] + 4 * rises_[k] * weight[(k + 1) % 3]);
    }
    return height;
  }

  /// The most by which the cubic over an edge with the normals at its ends differs from the
  /// quadratic: what slopes differ by times the most of t (1 - t) (1 / 2 - t).
  double skew() const {
    constexpr double kMost = 0.0482;
    double most = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const Vec3d edge = corners_[next] - corners_[k];
      most = std::max(most, std::abs(dot(edge, normals_[k] + normals_[next])));
    }
    return kMost * most;
  }

  TriangleCorners corners_;
  std::array<Vec3d, 3> normals_;
  std::array<double, 3> heights_{}, rises_{};  ///< at the corners; over the edges that begin there
};

}  // namespace cs2mesh
