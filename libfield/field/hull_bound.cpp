#include "libfield/field/hull_bound.h"

#include <algorithm>

#include "libfield/field/field_data.h"
#include "libfield/field/log_hull.h"
#include "libfield/field/near_sum.h"

namespace cs2mesh {

HullBound ImplicitSurface::hull_bound(std::span<const Vec3d> points,
                                      std::span<const Vec3d> directions) const {
  Aabb box;
  for (const Vec3d& p : points) box.include(p);
  HullBound bound;
  bound.bend = derivative_bound(2, box);
  if (directions.empty()) return bound;
  const std::array<Interval, 3> gradient = enclose_gradient(box);
  bound.slope = HullBound::kInfinity;
  for (const Vec3d& u : directions) bound.slope = std::min(bound.slope, least_along(gradient, u));
  return bound;
}

namespace {

/// A lower bound of the slope of log(1 + F), where that of F is positive; else of no use.
double slope_of_sum(const Field& field, const Aabb& box, std::span<const Vec3d> directions) {
  const std::array<Interval, 3> gradient = field.enclose_gradient(box);
  double least = HullBound::kInfinity;
  for (const Vec3d& u : directions) least = std::min(least, least_along(gradient, u));
  return least > 0 ? least / (1 + field.enclose(box).hi) : -HullBound::kInfinity;
}

}  // namespace

HullBound Field::hull_bound(std::span<const Vec3d> points,
                            std::span<const Vec3d> directions) const {
  Aabb box;
  for (const Vec3d& p : points) box.include(p);
  require(box.finite(), "hull_bound needs finite points");
  if (near_sum_ && box_.contains(box)) {
    BatchBox hull(box);
    double radius = 0.0;
    for (const Vec3d& p : points) radius = std::max(radius, norm(p - hull.center));
    hull.radius = std::min(hull.radius, radius * (1 + 1e-12));
    HullBound bound;
    bound.error = data_->error_budget;
    if (near_sum_->get()->hull_bound(hull, directions, bound)) return bound;
  }
  std::vector<std::uint32_t> list;
  near_terms(box, list);
  // Those of far fields are of no list.
  for (std::size_t i = data_->plain_count; i < data_->terms.size(); ++i) {
    list.push_back(static_cast<std::uint32_t>(i));
  }
  HullBound bound;
  const bool in_exponent = std::all_of(list.begin(), list.end(), [&](std::uint32_t i) {
    return has_log_hull(data_->terms[i], box);
  });
  if (in_exponent) {
    bound.in_exponent = true;
    LogHull hull(points, directions);
    for (const std::uint32_t i : list) hull.add(data_->terms[i]);
    hull.bound(bound);
    // Of what is longer than its kernel the exponent says little.
    const bool has_lengths = std::any_of(list.begin(), list.end(), [this](std::uint32_t i) {
      return !std::holds_alternative<Point>(data_->terms[i].primitive);
    });
    if (has_lengths && !(bound.slope > 0))
      bound.slope = std::max(bound.slope, slope_of_sum(*this, box, directions));
  } else {
    bound = ImplicitSurface::hull_bound(points, directions);
  }
  bound.error = data_->error_budget;
  return bound;
}

}  // namespace cs2mesh
