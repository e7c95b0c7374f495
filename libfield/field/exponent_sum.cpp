#include "libfield/field/exponent_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/field/quadratic_range.h"
#include "libfield/simd/vmath.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Of what is computed here.
constexpr double kRounding = 1e-13;

/// What phi may rise above its tangent.
double rise(const Exponent& term, double squared_radius) {
  return 0.5 * std::max(0.0, -term.least) * squared_radius;
}

/// e^t - 1 - s for 0 <= s <= t, without cancellation where both are small.
double above_tangent(double t, double s) {
  return t < 1e-3 ? (t - s) + 0.5 * t * t * (1 + 0.4 * t) : std::expm1(t) - s;
}

double highest_phi(std::span<const Exponent> terms) {
  double top = -kInfinity;
  for (const Exponent& term : terms) top = std::max(top, term.phi);
  return top;
}

}  // namespace

Interval Exponent::range(const BatchBox& box) const {
  const double squared = box.radius * box.radius;
  const double slack = rounding + kRounding * std::abs(phi);
  const double up = highest(gradient, std::max(0.0, least), box.half) + rise(*this, squared);
  const double down = extent_along(gradient, box.half) + 0.5 * std::max(0.0, most) * squared;
  return {phi - down * (1 + kRounding) - slack, phi + up * (1 + kRounding) + slack};
}

double Exponent::least_slope(const BatchBox& box, const Vec3d& direction) const {
  const double length = norm(direction);
  const double turn = 0.5 * std::abs(most + least) * extent_along(direction, box.half) +
                      0.5 * (most - least) * length * box.radius;
  return dot(gradient, direction) - turn - 1e-12 * (norm(gradient) * length + turn);
}

Interval log_range(std::span<const Exponent> terms, const BatchBox& box) {
  if (terms.empty()) return {-kInfinity, -kInfinity};
  const double top = highest_phi(terms), squared = box.radius * box.radius;
  double sum = 0.0, bend = 0.0, rounding = 0.0, concave = kInfinity;
  Vec3d mean{};
  thread_local std::vector<double> weights;
  weights.resize(terms.size());
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Exponent& term = terms[i];
    const double w = weights[i] = vmath::exp(term.phi - top);
    sum += w;
    mean += w * term.gradient;
    bend += w * std::max(0.0, term.most);
    rounding = std::max(rounding, term.rounding);
    concave = std::min(concave, std::max(0.0, term.least));
  }
  mean = mean / sum;
  // Together, and each by itself, which is better for boxes larger than the terms.
  double excess = 0.0, each = 0.0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Exponent& term = terms[i];
    const double y = rise(term, squared);
    const double s = extent_along(term.gradient - mean, box.half);
    excess += weights[i] * above_tangent(s + y, s);
    each +=
        weights[i] * vmath::exp(highest(term.gradient, std::max(0.0, term.least), box.half) + y);
  }
  const double center = top + std::log(sum), spread = extent_along(mean, box.half);
  const double together = center + highest(mean, concave, box.half) + std::log1p(excess / sum);
  const double apart = top + std::log(each);
  const double most = together < apart ? together : apart;
  const double slack = rounding + kRounding * (std::abs(top) + std::abs(most - center) + spread);
  return {center - spread - 0.5 * (bend / sum) * squared - slack, most + slack};
}

double least_mean_slope(std::span<const Exponent> terms, std::span<const double> slopes,
                        const BatchBox& box) {
  if (terms.empty()) return kInfinity;
  const Exponent& first =
      *std::max_element(terms.begin(), terms.end(),
                        [](const Exponent& a, const Exponent& b) { return a.phi < b.phi; });
  const double squared = box.radius * box.radius;
  double sum = 0.0, least_total = 0.0, most_total = 0.0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Exponent& term = terms[i];
    // The ratio to the first term, which is 1 for itself.
    double low = 1.0, high = 1.0;
    if (&term != &first) {
      const double spread =
          extent_along(term.gradient - first.gradient, box.half) * (1 + kRounding) + term.rounding +
          first.rounding + kRounding * (std::abs(term.phi) + std::abs(first.phi));
      const double up = std::max(0.0, 0.5 * (first.most - term.least) * squared);
      const double down = std::max(0.0, 0.5 * (term.most - first.least) * squared);
      low = vmath::exp(term.phi - first.phi - spread - down);
      high = vmath::exp(term.phi - first.phi + spread + up);
    }
    sum += slopes[i] * (slopes[i] > 0 ? low : high);
    least_total += low;
    most_total += high;
  }
  // A positive sum is the least over the greatest total; a negative one is no less than itself over
  // the least.
  return sum > 0 ? sum / most_total : sum / least_total;
}

}  // namespace cs2mesh
