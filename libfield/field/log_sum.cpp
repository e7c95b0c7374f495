#include "libfield/field/log_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/field/box_view.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Rounding of exponents, relative to the largest there are: those of points are known to some ulp
/// of log A and a^2 r^2, those of others to 64 ulp of f.
constexpr double kRounding = 1e-12;

double along(const Vec3d& g, const Vec3d& half) {
  return std::abs(g.x) * half.x + std::abs(g.y) * half.y + std::abs(g.z) * half.z;
}

/// The greatest g . d - bend / 2 |d|^2 over |d| <= half, axis by axis.
double highest(const Vec3d& g, double bend, const Vec3d& half) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double slope = std::abs(g[i]);
    const double t = slope < bend * half[i] ? slope / bend : half[i];
    sum += t * (slope - 0.5 * bend * t);
  }
  return sum;
}

/// e^s - 1 - s.
double second_order(double s) {
  return s < 1e-3 ? 0.5 * s * s * (1 + 0.4 * s) : std::expm1(s) - s;
}

}  // namespace

bool has_log_bounds(const Term& term) {
  // The exponent of a point is known however large; integrals must not overflow.
  constexpr double kMostOfPoint = 1e5, kMostOfIntegral = 500.0;
  const auto* kernel = std::get_if<Gaussian>(&term.kernel);
  if (kernel == nullptr || !(term.sign > 0) || !term.profiles.empty() || term.to_local) {
    return false;
  }
  if (std::holds_alternative<Point>(term.primitive)) return kernel->log_amplitude < kMostOfPoint;
  return kernel->log_amplitude < kMostOfIntegral &&
         (std::holds_alternative<Segment>(term.primitive) ||
          std::holds_alternative<Triangle>(term.primitive));
}

std::vector<LogSum> LogSum::at_centers(std::span<const Term> terms,
                                       std::span<const std::uint32_t> list,
                                       std::span<const BatchBox> boxes) {
  std::vector<LogSum> sums(boxes.size());
  for (LogSum& sum : sums) sum.terms_.reserve(list.size());
  std::vector<Vec3d> centers;
  std::vector<Jet> jets;
  for (const BatchBox& box : boxes) centers.push_back(box.center);
  for (const std::uint32_t index : list) {
    const Term& term = terms[index];
    const auto& kernel = std::get<Gaussian>(term.kernel);
    const double curvature = 2 * kernel.a * kernel.a;
    if (const auto* point = std::get_if<Point>(&term.primitive)) {
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        const Vec3d d = centers[i] - point->position;
        sums[i].terms_.push_back({kernel.log_amplitude - 0.5 * curvature * squared_norm(d),
                                  -curvature * d, curvature, curvature});
      }
      continue;
    }
    jets.assign(boxes.size(), Jet{});
    accumulate(term, centers, std::span(jets));
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      constexpr double kSmallest = 1e-200;
      if (jets[i].value > kSmallest) {
        sums[i].terms_.push_back(
            {std::log(jets[i].value), jets[i].gradient / jets[i].value, curvature, 0.0});
      } else {
        sums[i].negligible_ += magnitude_bound(term, boxes[i].box.distance(skeleton_box(term)));
      }
    }
  }
  return sums;
}

Interval LogSum::range(const BatchBox& box) const {
  if (terms_.empty()) return {-kInfinity, negligible_ > 0 ? std::log(negligible_) : -kInfinity};
  double top = -kInfinity, largest = 1.0;
  for (const Exponent& term : terms_) {
    top = std::max(top, term.phi);
    largest = std::max(largest, std::abs(term.phi));
  }
  double sum = 0.0, bend = 0.0, least_bend = kInfinity;
  Vec3d mean{};
  std::vector<double> weights(terms_.size());
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    weights[i] = vmath::exp(terms_[i].phi - top);
    sum += weights[i];
    mean += weights[i] * terms_[i].gradient;
    bend += weights[i] * terms_[i].most_bend;
    least_bend = std::min(least_bend, terms_[i].least_bend);
  }
  mean = mean / sum;
  const double spread = along(mean, box.half);
  // Together, and each by itself, which is better for boxes larger than the terms.
  double excess = 0.0, each = 0.0;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const double s = along(terms_[i].gradient - mean, box.half);
    excess += weights[i] * second_order(s);
    each += vmath::exp(terms_[i].phi - top +
                       highest(terms_[i].gradient, terms_[i].least_bend, box.half));
  }
  const double center = top + std::log(sum);
  const double rounding = kRounding * (largest + spread);
  const double together = center + highest(mean, least_bend, box.half) + std::log1p(excess / sum);
  const double apart = top + std::log(each);
  double most = (together < apart ? together : apart) + rounding;
  if (negligible_ > 0) most = std::max(most, std::log(negligible_)) + std::log(2.0);
  return {center - spread - 0.5 * (bend / sum) * box.radius * box.radius - rounding, most};
}

double LogSum::least_slope(const BatchBox& box, const Vec3d& direction) const {
  if (terms_.empty() || negligible_ > 0) return -kInfinity;
  const auto first =
      std::max_element(terms_.begin(), terms_.end(),
                       [](const Exponent& a, const Exponent& b) { return a.phi < b.phi; });
  const double squared = box.radius * box.radius;
  const double length = norm(direction);
  double sum = 0.0, most = 0.0;
  for (const Exponent& term : terms_) {
    const double turn =
        term.most_bend * (term.least_bend > 0 ? along(direction, box.half) : box.radius * length);
    const double slope =
        dot(term.gradient, direction) - turn - kRounding * (norm(term.gradient) + turn) * length;
    const double spread = along(term.gradient - first->gradient, box.half) +
                          kRounding * (std::abs(term.phi) + std::abs(first->phi));
    const double ratio = term.phi - first->phi;
    // What the ratio to the first term is at most and at least.
    const double rise = 0.5 * (first->most_bend - term.least_bend) * squared;
    const double fall = 0.5 * (term.most_bend - first->least_bend) * squared;
    const double high = vmath::exp(ratio + spread + std::max(rise, 0.0));
    sum += slope > 0 ? slope * vmath::exp(ratio - spread - std::max(fall, 0.0)) : slope * high;
    most += high;
  }
  return sum > 0 ? sum / most : sum;
}

}  // namespace cs2mesh
