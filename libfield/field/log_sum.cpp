#include "libfield/field/log_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/field/box_view.h"
#include "libfield/field/quadratic_range.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// 2 a^2: minus the second derivative of the exponent of a point.
double bend_of(const Term& term) {
  const double a = std::get<Gaussian>(term.kernel).a;
  return 2 * a * a;
}

/// The distance from a box to the farthest point of another.
double farthest(const Aabb& box, const Aabb& other) {
  Aabb both = box;
  both.include(other);
  return both.diagonal();
}

/// The distance from a point to the farthest one of a box.
double farthest(const Aabb& box, const Vec3d& point) {
  return norm(max(point - box.min, box.max - point));
}

/// An upper bound of the exponent of a point over a box.
double greatest_exponent(const Term& term, const Vec3d& point, const Aabb& box) {
  constexpr double kRounding = 1e-13;
  const auto& kernel = std::get<Gaussian>(term.kernel);
  const double d = kernel.a * box.distance(point);
  const double lost = d * d;
  return kernel.log_amplitude - lost + kRounding * (std::abs(kernel.log_amplitude) + lost + 1);
}

/// A lower bound of the distance of a primitive from a box: of slanted ones their own boxes know
/// little.
double least_distance(const Term& term, const Aabb& box) {
  const double of_box = box.distance(skeleton_box(term));
  const double of_center =
      std::visit([&](const auto& p) { return distance(p, box.center()); }, term.primitive);
  return std::max(of_box, of_center * (1 - 1e-12) - 0.5 * box.diagonal() * (1 + 1e-12));
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

LogTerms::LogTerms(std::span<const Term> terms, std::span<const std::uint32_t> list,
                   const Aabb& box, double share)
    : terms_(terms) {
  const double least = share / static_cast<double>(std::max<std::size_t>(list.size(), 1));
  const double least_exponent = std::log(least);
  std::vector<std::uint32_t> points;
  for (const std::uint32_t index : list) {
    const Term& term = terms[index];
    if (const auto* point = std::get_if<Point>(&term.primitive)) {
      const double exponent = greatest_exponent(term, point->position, box);
      if (exponent > least_exponent) {
        points.push_back(index);
      } else {
        leave_out(std::exp(exponent), bend_of(term) * farthest(box, point->position));
      }
      continue;
    }
    const Aabb skeleton = skeleton_box(term);
    const double most = magnitude_bound(term, least_distance(term, box));
    if (most <= least) {
      // |grad phi| <= 2 a^2 times the distance of the farthest element.
      leave_out(most, bend_of(term) * farthest(box, skeleton));
    } else {
      others_.push_back(index);
    }
  }
  const std::size_t count = points.size();
  points_.resize(kPointRows * count);
  for (std::size_t i = 0; i < count; ++i) {
    const Term& term = terms[points[i]];
    const Vec3d& at = std::get<Point>(term.primitive).position;
    points_[x * count + i] = at.x;
    points_[y * count + i] = at.y;
    points_[z * count + i] = at.z;
    points_[curvature * count + i] = bend_of(term);
    points_[log_amplitude * count + i] = std::get<Gaussian>(term.kernel).log_amplitude;
  }
}

void LogTerms::leave_out(double value, double steepness) {
  left_out_ += value;
  left_out_slope_ += value * steepness;
}

LogSum::LogSum(const LogTerms& terms, const BatchBox& box) : box_{box.half, box.radius} {
  constexpr std::size_t kLanes = ExponentRows::kMostLanes;
  const std::size_t points = terms.points_.size() / LogTerms::kPointRows;
  const std::size_t all = points + terms.others_.size();
  rows_.count = (all + kLanes - 1) / kLanes * kLanes;
  numbers_.resize(ExponentRows::kRows * rows_.count, boost::container::default_init);
  rows_.numbers = numbers_.data();
  add_points(terms, box.center);
  add_others(terms, box);
}

void LogSum::add_points(const LogTerms& terms, const Vec3d& center) {
  const std::size_t count = terms.points_.size() / LogTerms::kPointRows;
  const auto row = [&](LogTerms::PointRow which) { return terms.points_.data() + which * count; };
  const double *x = row(LogTerms::x), *y = row(LogTerms::y), *z = row(LogTerms::z);
  const double *curvature = row(LogTerms::curvature), *top = row(LogTerms::log_amplitude);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d d{center.x - x[i], center.y - y[i], center.z - z[i]};
    rows_[ExponentRows::phi][i] = top[i] - 0.5 * curvature[i] * squared_norm(d);
    rows_[ExponentRows::gx][i] = -curvature[i] * d.x;
    rows_[ExponentRows::gy][i] = -curvature[i] * d.y;
    rows_[ExponentRows::gz][i] = -curvature[i] * d.z;
    rows_[ExponentRows::most][i] = rows_[ExponentRows::least][i] = curvature[i];
  }
}

void LogSum::add_others(const LogTerms& terms, const BatchBox& box) {
  constexpr double kSmallest = 1e-200;
  std::size_t place = terms.points_.size() / LogTerms::kPointRows;
  for (const std::uint32_t index : terms.others_) {
    const Term& term = terms.terms_[index];
    Jet jet;
    accumulate(term, {&box.center, 1}, std::span<Jet>(&jet, 1));
    if (!(jet.value > kSmallest)) {
      negligible_ += magnitude_bound(term, least_distance(term, box.box));
      continue;
    }
    rows_[ExponentRows::phi][place] = std::log(jet.value);
    rows_[ExponentRows::gx][place] = jet.gradient.x / jet.value;
    rows_[ExponentRows::gy][place] = jet.gradient.y / jet.value;
    rows_[ExponentRows::gz][place] = jet.gradient.z / jet.value;
    rows_[ExponentRows::most][place] = bend_of(term);
    rows_[ExponentRows::least][place] = 0.0;
    ++place;
  }
  find_first_and_fill_up(place);
}

/// The places from `used` on get the numbers of the greatest, far below it.
void LogSum::find_first_and_fill_up(std::size_t used) {
  constexpr double kFarBelow = 2000.0;
  if (used == 0) {
    rows_.count = 0;
    return;
  }
  const double* phi = rows_[ExponentRows::phi];
  rows_.first = static_cast<std::size_t>(std::max_element(phi, phi + used) - phi);
  for (std::size_t i = used; i < rows_.count; ++i) {
    for (int row = 0; row < ExponentRows::weight; ++row) {
      double* numbers = rows_[static_cast<ExponentRows::Row>(row)];
      numbers[i] = numbers[rows_.first] - (row == ExponentRows::phi ? kFarBelow : 0.0);
    }
  }
}

Interval LogSum::range() {
  if (rows_.count == 0) return {-kInfinity, negligible_ > 0 ? std::log(negligible_) : -kInfinity};
  const double* phi = rows_[ExponentRows::phi];
  const double* least = rows_[ExponentRows::least];
  double largest = 1.0, least_bend = kInfinity;
  for (std::size_t i = 0; i < rows_.count; ++i) {
    largest = std::max(largest, std::abs(phi[i]));
    least_bend = std::min(least_bend, least[i]);
  }
  const double top = phi[rows_.first];
  const WeightSums sums = exponent_table().weights(rows_);
  const Vec3d mean = sums.gradient / sums.weight;
  // Together, and each by itself, which is better for boxes larger than the terms.
  const RiseSums rises = exponent_table().rises(rows_, box_, mean);
  const double spread = extent_along(mean, box_.half);
  const double center = top + std::log(sums.weight);
  const double rounding = kExponentRounding * (largest + spread);
  const double together =
      center + highest(mean, least_bend, box_.half) + std::log1p(rises.excess / sums.weight);
  const double apart = top + std::log(rises.apart);
  double most = (together < apart ? together : apart) + rounding;
  if (negligible_ > 0) most = std::max(most, std::log(negligible_)) + std::log(2.0);
  const double bend = sums.most / sums.weight;
  return {center - spread - 0.5 * bend * box_.radius * box_.radius - rounding, most};
}

double LogSum::least_slope(const Vec3d& direction) const {
  constexpr double kSummation = 1e-13;
  if (rows_.count == 0 || negligible_ > 0) return -kInfinity;
  const SlopeSums sums = exponent_table().slopes(rows_, box_, direction);
  const double least = sums.slope - kSummation * sums.size;
  return least > 0 ? least / sums.weight : least;
}

/// A term grows along d all over the box if v . d > (extent of the box along d) with v = grad phi /
/// bend, the way to its skeleton. The d of which the least v . d is greatest points to the point of
/// the hull of all v that is nearest to 0 (Gilbert, "An iterative procedure for computing the
/// minimum of a quadratic form on a convex set", 1966).
Vec3d LogSum::common_direction() const {
  constexpr double kMatters = 1e-2;
  constexpr int kMostSteps = 12;
  constexpr double kNearEnough = 0.9;
  boost::container::small_vector<Vec3d, kFewTerms> ways;
  const auto gradient = [this](std::size_t i) {
    return Vec3d{rows_[ExponentRows::gx][i], rows_[ExponentRows::gy][i],
                 rows_[ExponentRows::gz][i]};
  };
  const Vec3d first = rows_.count > 0 ? gradient(rows_.first) : Vec3d{};
  for (std::size_t i = 0; i < rows_.count; ++i) {
    const Vec3d g = gradient(i);
    const double ratio = rows_[ExponentRows::phi][i] - rows_[ExponentRows::phi][rows_.first];
    const double share = ratio + extent_along(g - first, box_.half);
    if (i != rows_.first && share < std::log(kMatters)) continue;
    ways.push_back(g / rows_[ExponentRows::most][i]);
  }
  if (ways.empty()) return {};
  Vec3d nearest = first / rows_[ExponentRows::most][rows_.first];
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3d& least = *std::min_element(
        ways.begin(), ways.end(),
        [&](const Vec3d& a, const Vec3d& b) { return dot(a, nearest) < dot(b, nearest); });
    const double squared = squared_norm(nearest);
    if (dot(least, nearest) >= kNearEnough * squared) break;
    const Vec3d way = least - nearest;
    const double t = std::clamp(-dot(way, nearest) / squared_norm(way), 0.0, 1.0);
    nearest = nearest + t * way;
  }
  const double length = norm(nearest);
  return length > 0 ? nearest / length : normalized(first);
}

}  // namespace cs2mesh
