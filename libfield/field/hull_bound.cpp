#include "libfield/field/hull_bound.h"

#include <algorithm>

#include "libfield/field/field_data.h"
#include "libfield/field/log_hull.h"

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

HullBound Field::hull_bound(std::span<const Vec3d> points,
                            std::span<const Vec3d> directions) const {
  Aabb box;
  for (const Vec3d& p : points) box.include(p);
  require(box.finite(), "hull_bound needs finite points");
  std::vector<std::uint32_t> list;
  near_terms(box, list);
  // Those of far fields are of no list.
  for (std::size_t i = data_->plain_count; i < data_->terms.size(); ++i) {
    list.push_back(static_cast<std::uint32_t>(i));
  }
  HullBound bound;
  const bool in_exponent = std::all_of(
      list.begin(), list.end(), [this](std::uint32_t i) { return has_log_hull(data_->terms[i]); });
  if (in_exponent) {
    bound.in_exponent = true;
    LogHull hull(points, directions);
    for (const std::uint32_t i : list) hull.add(data_->terms[i]);
    hull.bound(bound);
  } else {
    bound = ImplicitSurface::hull_bound(points, directions);
  }
  bound.error = data_->error_budget;
  return bound;
}

}  // namespace cs2mesh
