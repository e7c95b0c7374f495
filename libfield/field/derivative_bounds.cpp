#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "libfield/field/box_view.h"
#include "libfield/field/term_bounds.h"
#include "libfield/field/weight_bounds.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::array<Interval, 3> ball(const Vec3d& center, double radius) {
  return {widened(center.x, radius), widened(center.y, radius), widened(center.z, radius)};
}

/// The transposed linear map applied to a box of gradients.
std::array<Interval, 3> to_world_gradient(const Term& term, const std::array<Interval, 3>& local) {
  if (!term.to_local) return local;
  const Mat3 map = transpose(term.to_local->linear);
  std::array<Interval, 3> world;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d& row = map.row[i];
    world[i] = Interval(row.x) * local[0] + Interval(row.y) * local[1] + Interval(row.z) * local[2];
  }
  return world;
}

}  // namespace

std::array<Interval, 3> gradient_bound(const Term& term, const Aabb& box) {
  const LocalBox local = local_box(term, box);
  return visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    const Gap g = gap(term, primitive, local.center, local.half, local.radius);
    const double slope = near_bound(kernel, primitive, 1, g.near(1.0));
    const double turn = local.radius * (0.5 * near_bound(kernel, primitive, 2, g.near(0.5)) +
                                        0.5 * near_bound(kernel, primitive, 2, g.near(1.0)));
    std::array<Interval, 3> gradient = ball({}, slope);
    if (turn < slope) {
      const Jet center = integral_of(term, kernel, primitive, local.center);
      const std::array<Interval, 3> near = ball(center.gradient, turn);
      for (std::size_t i = 0; i < 3; ++i) gradient[i] = intersection(gradient[i], near[i]);
    }
    if (!term.profiles.empty()) {
      const Interval field = integral_range(kernel, primitive, reach(term, primitive, local));
      const WeightBound weight = weight_bound(term, primitive, local);
      for (std::size_t i = 0; i < 3; ++i) {
        gradient[i] = weight.w * gradient[i] + field * weight.gradient[i];
      }
    }
    for (Interval& component : gradient) component = Interval(term.sign) * component;
    return to_world_gradient(term, gradient);
  });
}

double derivative_bound(const Term& term, int order, const Aabb& box) {
  const LocalBox local = local_box(term, box);
  return visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    double factor = std::pow(local.stretch, order) * (1 + 1e-14);
    if (!term.profiles.empty()) {
      const std::optional<Interval> flat = flat_weight(term, primitive, local);
      if (!flat) return kInfinity;
      factor *= flat->magnitude();
    }
    const Gap g = gap(term, primitive, local.center, local.half, local.radius);
    const double bound = near_bound(kernel, primitive, order, g.near(1.0));
    return bound == 0 ? 0.0 : factor * bound;
  });
}

}  // namespace cs2mesh
