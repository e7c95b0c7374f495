// How fast a sum of terms must grow along a direction d wherever it has a given value in a box.
//
// By where their elements lie, terms have slopes of at least a rate times their value (pull.h).
// Where rates are as steep as the kernels, values need not be: on the surface they add up to T, so
// the least slope is a linear program, solved by filling up the terms of the smallest rates first.
// Factors of a hundred in F within the box do no harm as long as every element pulls the same way.
// For kernels shorter than their primitive, a Taylor polynomial of the slope may do better.
#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/field/box_view.h"
#include "libfield/field/pull.h"
#include "libfield/field/slope_program.h"
#include "libfield/field/weight_bounds.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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
      slope_ -= own.lost;
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
    if (term.value.lo > 0) sum += term.rate * term.value.lo;  // rates may be infinite
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
    if (taken > 0) sum += term.rate * taken;
    least_left -= taken;
    most_left -= taken;
  }
  // Too little even with all at their greatest.
  if (least_left > 0) return kInfinity;
  return sum;
}

}  // namespace cs2mesh
