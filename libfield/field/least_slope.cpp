// How fast a sum of terms must grow along a direction d wherever it has a given value in a box.
//
// Of the integral: d . grad I(p) = int k(|p - s|^2) a ds, with k = -2 dh/du and a = d . (s - p),
// how far along d the element s lies. Over a range of distances k / h has bounds, so over a box d .
// grad I >= (least a) (least or greatest k / h) I: a rate times the value. Where rates are as steep
// as the kernels, values need not be: on the surface they add up to T, so the least slope is a
// linear program, solved by filling up the terms of the smallest rates first. Factors of a hundred
// in F within the box do no harm as long as every element pulls the same way. For kernels shorter
// than their primitive, a Taylor polynomial of the slope may do better.
#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/field/box_view.h"
#include "libfield/field/slope_program.h"
#include "libfield/field/weight_bounds.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// k / h = -2 h' / h at a squared distance, where h > 0.
template <class K>
double steepness(const K& kernel, double u) {
  const double h = kernel.profile(u);
  return h > 0 ? -2 * kernel.slope(u) / h : kInfinity;
}

/// Contains k / h over a range of squared distances. The ratio is monotone for all kernels but the
/// metaball, which is least steep in its outer part at R / 2.
template <class K>
Interval steepness(const K& kernel, double near, double far) {
  const double at_near = steepness(kernel, near), at_far = steepness(kernel, far);
  Interval range(std::min(at_near, at_far), std::max(at_near, at_far));
  if constexpr (std::is_same_v<K, Metaball>) {
    const double turn = 0.25 * kernel.radius * kernel.radius;
    if (near < turn && turn < far) range.lo = std::min(range.lo, steepness(kernel, turn));
  }
  return range;
}

/// What can be said of d . grad I by the places of the elements: at least `rate` I, and `slope`.
struct Pull {
  double rate = -kInfinity, slope = -kInfinity;
};

template <class K, class P>
Pull pull(const Term& term, const K& kernel, const P& primitive, const LocalBox& local,
          const Vec3d& direction, const Reach& reach) {
  if constexpr (std::is_same_v<P, Plane> || std::is_same_v<P, TaperedSegment> ||
                std::is_same_v<P, Arc>) {
    return {};
  } else {
    if constexpr (std::is_same_v<K, Inverse> || std::is_same_v<K, Squared>) {
      if (!(reach.near > kernel.clamp)) return {};
    }
    // How far ahead all elements are at least: min over s of d . (s - p).
    const double ahead = separation(primitive, local.center, -1.0 * direction) -
                         extent_along(term, direction, local.half) -
                         1e-12 * norm(direction) * reach.scale;
    const double near = reach.near * reach.near, far = reach.far * reach.far;
    const Interval ratio = steepness(kernel, near, far);
    if (ahead > 0) return {ahead * ratio.lo * (1 - 1e-12), 0.0};
    return {ahead * ratio.hi * (1 + 1e-12),
            2 * ahead * mass_bound(primitive) * -kernel.slope(near) * (1 + 1e-12)};
  }
}

/// By the gradient at the centre and a bound of the second derivative.
template <class K, class P>
double polynomial(const Term& term, const K& kernel, const P& primitive, const LocalBox& local,
                  const Vec3d& direction, double scale) {
  const Gap g = gap(term, primitive, local.center, local.half, local.radius);
  const double inner_turn = near_bound(kernel, primitive, 2, g.near(0.5));
  const double turn =
      0.5 * local.radius * (inner_turn + near_bound(kernel, primitive, 2, g.near(1.0)));
  const Vec3d gradient = integral_of(term, kernel, primitive, local.center).gradient;
  const double error =
      gradient_error(condition_number(primitive), norm(gradient), inner_turn, scale);
  return dot(direction, gradient) - norm(direction) * (turn + error) * (1 + 1e-12);
}

}  // namespace

void SlopeProgram::add(const Term& term, const BatchBox& box, const Vec3d& direction) {
  const LocalBox local = local_box(term, box.box);
  visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    const Reach r = reach(term, primitive, local);
    Interval value = integral_range(kernel, primitive, r);
    if (value.lo == 0 && value.hi == 0) return;  // beyond its support
    if (!term.profiles.empty()) {
      GradientSum sum;
      add_gradient_bound(term, box, sum);
      value = Interval(term.sign) * weight_range(term, primitive, local.box) * value;
      add(value, least_along(sum.bound(box), direction));
      return;
    }
    const Vec3d along = term.sign * (term.to_local ? term.to_local->linear * direction : direction);
    const Pull own = pull(term, kernel, primitive, local, along, r);
    const bool fillable = term.sign > 0 && value.lo >= 0;
    if (fillable && own.rate > 0) {
      fillable_.push_back({value, own.rate});
      return;
    }
    const double steepest = -norm(along) * near_bound(kernel, primitive, 1, r.near);
    const double fixed =
        std::max({steepest, own.slope, polynomial(term, kernel, primitive, local, along, r.scale)});
    if (fillable && own.rate * value.hi >= fixed) {
      fillable_.push_back({value, own.rate});
    } else {
      add(Interval(term.sign) * value, fixed);
    }
  });
}

double SlopeProgram::least(double total) {
  // What the terms with a rate have to add up to, at least and at most.
  double least_left = total - fixed_.hi;
  double most_left = total - fixed_.lo;
  double sum = slope_;
  for (const Fillable& term : fillable_) {
    sum += term.rate * term.value.lo;
    least_left -= term.value.lo;
    most_left -= term.value.lo;
  }
  const double rounding = 1e-12 * (std::abs(total) + std::abs(least_left) + std::abs(most_left));
  most_left += rounding;
  least_left -= rounding;
  if (most_left < 0) return kInfinity;
  std::sort(fillable_.begin(), fillable_.end(),
            [](const Fillable& a, const Fillable& b) { return a.rate < b.rate; });
  for (const Fillable& term : fillable_) {
    const double left = term.rate < 0 ? most_left : least_left;
    if (!(left > 0)) break;
    const double taken = std::min(term.value.width(), left);
    sum += term.rate * taken;
    least_left -= taken;
    most_left -= taken;
  }
  // Too little even with all at their greatest.
  if (least_left > 0) return kInfinity;
  return sum;
}

}  // namespace cs2mesh
