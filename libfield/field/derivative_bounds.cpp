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

/// Bounds of the gradient of the term from those of the integral's, in local coordinates.
template <class K, class P>
std::array<Interval, 3> weighted(const Term& term, const K& kernel, const P& primitive,
                                 const LocalBox& local, std::array<Interval, 3> gradient) {
  if (!term.profiles.empty()) {
    const Interval field = integral_range(kernel, primitive, reach(term, primitive, local));
    const WeightBound weight = weight_bound(term, primitive, local);
    for (std::size_t i = 0; i < 3; ++i) {
      gradient[i] = weight.w * gradient[i] + field * weight.gradient[i];
    }
  }
  for (Interval& component : gradient) component = Interval(term.sign) * component;
  return to_world_gradient(term, gradient);
}

/// Of a term with profiles, in local coordinates: |D^2 (w f)| by the product rule.
template <class K, class P>
double second_bound(const Term& term, const K& kernel, const P& primitive, const LocalBox& local) {
  const WeightBends weight = weight_bends(term, primitive, local);
  const double near = gap(term, primitive, local.center, local.half, local.radius).near(1.0);
  double bound = 0.0;
  const double factor[3] = {weight.bend, 2 * weight.slope, weight.w};
  for (int order = 0; order <= 2; ++order) {
    bound += product_bound(factor[order], near_bound(kernel, primitive, order, near));
  }
  return bound;
}

}  // namespace

std::array<Interval, 3> GradientSum::bound(const BatchBox& box) const {
  const Symmetric3& h = hessian;
  const auto along = [&](double x, double y, double z) {
    return std::abs(x) * box.half.x + std::abs(y) * box.half.y + std::abs(z) * box.half.z;
  };
  const Vec3d turn{along(h.xx, h.xy, h.xz), along(h.xy, h.yy, h.yz), along(h.xz, h.yz, h.zz)};
  std::array<Interval, 3> all;
  for (std::size_t i = 0; i < 3; ++i) {
    const double margin = (turn[i] + remainder) * (1 + 1e-12) + 1e-13 * std::abs(center[i]);
    all[i] = intersection(plain[i], widened(range[i] + Interval(center[i]), margin));
  }
  return all;
}

void GradientSum::add_polynomial(std::span<const Jet> jets, double first, double second,
                                 const BatchBox& box) {
  const Vec3d& g = jets[0].gradient;
  for (std::size_t i = 0; i < 3; ++i) plain[i] = plain[i] + widened(g[i], first);
  center += g;
  remainder += std::min(first, second);
  if (second < first) hessian += difference_quotient(jets, box);
}

void add_gradient_bound(const Term& term, const BatchBox& box, GradientSum& sum) {
  const LocalBox local = local_box(term, box.box);
  visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    const Gap g = gap(term, primitive, local.center, local.half, local.radius);
    const auto at = [&](int order, double t) {
      return near_bound(kernel, primitive, order, g.near(t));
    };
    const double slope = at(1, 1.0);
    const double inner_turn = at(2, 0.5);
    const double turn = local.radius * 0.5 * (inner_turn + at(2, 1.0));
    std::array<Interval, 3> plain = ball({}, slope);
    if (!(turn < slope)) {
      plain = weighted(term, kernel, primitive, local, plain);
      for (std::size_t i = 0; i < 3; ++i) {
        sum.plain[i] = sum.plain[i] + plain[i];
        sum.range[i] = sum.range[i] + plain[i];
      }
      return;
    }
    std::array<Vec3d, 4> points = box.points();
    std::array<Jet, 4> jets;
    local_jets(term, kernel, primitive, points, jets);
    const double error = gradient_error(condition_number(primitive), norm(jets[0].gradient),
                                        inner_turn, reach(term, primitive, local).scale);
    const std::array<Interval, 3> near = ball(jets[0].gradient, turn + error);
    for (std::size_t i = 0; i < 3; ++i) plain[i] = intersection(plain[i], near[i]);
    plain = weighted(term, kernel, primitive, local, plain);
    for (std::size_t i = 0; i < 3; ++i) sum.plain[i] = sum.plain[i] + plain[i];
    if (!term.profiles.empty()) {
      for (std::size_t i = 0; i < 3; ++i) sum.range[i] = sum.range[i] + plain[i];
      return;
    }
    for (Jet& jet : jets) jet.gradient = to_world_gradient(term, jet.gradient);
    sum.center += term.sign * jets[0].gradient;
    const double cubed = local.stretch * local.stretch * local.stretch;
    const double second = second_gradient_remainder(box, cubed * at(3, 0.5), cubed * at(3, 1.0),
                                                    error * local.stretch);
    const double first = (turn + error) * local.stretch;
    sum.remainder += std::min(first, second);
    if (second < first) sum.hessian += term.sign * difference_quotient(jets, box);
  });
}

double derivative_bound(const Term& term, int order, const Aabb& box) {
  const LocalBox local = local_box(term, box);
  return visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    double factor = std::pow(local.stretch, order) * (1 + 1e-14);
    if (!term.profiles.empty() && order == 2)
      return factor * second_bound(term, kernel, primitive, local);
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
