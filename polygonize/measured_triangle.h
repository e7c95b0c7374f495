// The shape of a triangle where lengths are measured by a quadratic form.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/base/jet2.h"

namespace cs2mesh {

/// Seen from a corner: the products u.u, u.v and v.v of the edges from it, measured by a form.
class MeasuredTriangle {
 public:
  MeasuredTriangle(const Symmetric3& form, const Vec3d& u, const Vec3d& v) : u_(u), v_(v) {
    const Vec3d fu = form * u;
    uu_ = dot(u, fu);
    uv_ = dot(v, fu);
    vv_ = dot(v, form * v);
  }

  /// Twice the area; 0 if it is degenerate.
  double area() const { return std::sqrt(std::max(uu_ * vv_ - uv_ * uv_, 0.0)); }

  /// 1 for an equilateral triangle, 0 for one without area; 1 if the form is zero.
  double quality() const {
    const double sides = 2 * (uu_ + vv_ - uv_);
    return sides > 0 ? 2 * std::sqrt(3.0) * area() / sides : 1.0;
  }

  /// Whether the angle at the corner is obtuse.
  bool is_obtuse() const { return uv_ < 0; }
  /// Of the angle at the corner.
  double cotangent() const { return uv_ / std::max(area(), std::numeric_limits<double>::min()); }

  /// The way from the corner to the circumcentre, or to the middle of the longest side where that
  /// is not inside: the same point from every corner. Zero if it is degenerate.
  Vec3d to_centre() const {
    const double square = uu_ * vv_ - uv_ * uv_;
    if (!(square > 0)) return {};
    if (uv_ <= 0) return 0.5 * (u_ + v_);
    if (uu_ <= uv_) return 0.5 * v_;
    if (vv_ <= uv_) return 0.5 * u_;
    return (0.5 / square) * (vv_ * (uu_ - uv_) * u_ + uu_ * (vv_ - uv_) * v_);
  }

 private:
  Vec3d u_, v_;
  double uu_ = 0.0, uv_ = 0.0, vv_ = 0.0;
};

}  // namespace cs2mesh
