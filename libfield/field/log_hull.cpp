#include "libfield/field/log_hull.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libfield/field/box_view.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Rounding of exponents, in parts of the terms they are the difference of.
constexpr double kRounding = 1e-12;

/// D^2 log h lies between -bend and rise at all distances from r on. Across the ray it is
/// (log h)' / r, along it (log h)''.
struct LogBend {
  double bend = 0.0, rise = 0.0;
  double steepest = 0.0;  ///< >= |(log h)'|
};
LogBend log_bend(const Gaussian& kernel, double /*r*/) {
  const double c = 2 * kernel.a * kernel.a;
  return {c, -c, kInfinity};
}
/// log h = -2 log(1 + s^2 r^2): its slope is greatest at s r = 1, its second derivative along the
/// ray at s r = sqrt(3).
LogBend log_bend(const Cauchy& kernel, double r) {
  const double squared = kernel.s * kernel.s;
  return {4 * squared / (1 + squared * r * r), 0.5 * squared, 2 * kernel.s};
}
LogBend log_bend(const Inverse& kernel, double r) {
  if (!(r > kernel.clamp)) return {kInfinity, kInfinity, kInfinity};
  return {1 / (r * r), 1 / (r * r), 1 / r};
}
LogBend log_bend(const Squared& kernel, double r) {
  if (!(r > kernel.clamp)) return {kInfinity, kInfinity, kInfinity};
  return {2 / (r * r), 2 / (r * r), 2 / r};
}

template <class K>
constexpr bool kHasLogBend = std::is_same_v<K, Gaussian> || std::is_same_v<K, Cauchy> ||
                             std::is_same_v<K, Inverse> || std::is_same_v<K, Squared>;

/// Of the integral: the covariance of the gradients of its elements adds to what bends up, but not
/// for Gaussians over convex skeletons, which stay log-concave (Prekopa 1973).
template <class P>
LogBend integrated(const Gaussian& kernel, const P& /*primitive*/, const Reach& r) {
  LogBend bend = log_bend(kernel, r.near);
  bend.steepest = bend.bend * r.far;
  if constexpr (std::is_same_v<P, Point>) return bend;
  bend.rise = std::is_same_v<P, Arc> ? bend.steepest * bend.steepest : 0.0;
  return bend;
}
template <class K, class P>
LogBend integrated(const K& kernel, const P& /*primitive*/, const Reach& r) {
  LogBend bend = log_bend(kernel, r.near);
  if constexpr (!std::is_same_v<P, Point>) bend.rise += bend.steepest * bend.steepest;
  return bend;
}

/// `squared` is the least squared distance of the point, if it is one, that counts.
bool has_log_hull_from(const Term& term, double squared) {
  constexpr double kMostExponent = 500.0;  // far below where exponents are cut off
  if (!(term.sign > 0) || !term.profiles.empty() || std::holds_alternative<Plane>(term.primitive) ||
      std::holds_alternative<TaperedSegment>(term.primitive)) {
    return false;
  }
  return std::visit(
      [&](const auto& kernel) {
        using K = std::decay_t<decltype(kernel)>;
        if constexpr (std::is_same_v<K, Gaussian>)
          return kernel.log_amplitude - kernel.a * kernel.a * squared < kMostExponent;
        return kHasLogBend<K>;
      },
      term.kernel);
}

}  // namespace

bool has_log_hull(const Term& term) {
  return has_log_hull_from(term, 0.0);
}

bool has_log_hull(const Term& term, const Aabb& box) {
  const auto* point = std::get_if<Point>(&term.primitive);
  if (point == nullptr || term.to_local) return has_log_hull(term);
  const double distance = box.distance(point->position);
  return has_log_hull_from(term, distance * distance * (1 - 1e-12));
}

bool has_cheap_log_hull(const Term& term) {
  return has_log_hull(term) && std::holds_alternative<Gaussian>(term.kernel) &&
         std::holds_alternative<Point>(term.primitive) && !term.to_local;
}

LogHull::LogHull(std::span<const Vec3d> points, std::span<const Vec3d> directions)
    : points_(points), directions_(directions) {
  require(!points.empty() && points.size() <= kMostPoints, "LogHull: one to eight points");
  for (const Vec3d& p : points) {
    box_.include(p);
    center_ += p;
  }
  center_ = center_ / static_cast<double>(points.size());
  for (const Vec3d& p : points) radius_ = std::max(radius_, norm(p - center_));
  radius_ *= 1 + 1e-12;
  for (const Vec3d& u : directions) {
    double reach = -kInfinity;
    for (const Vec3d& p : points) reach = std::max(reach, dot(p - center_, u));
    support_.push_back(reach);
    longest_ = std::max(longest_, norm(u));
  }
}

void LogHull::add(const Term& term) {
  Exponent& exponent = terms_.emplace_back();
  exponent.slope = kInfinity;
  const auto* gaussian = std::get_if<Gaussian>(&term.kernel);
  const auto* point = std::get_if<Point>(&term.primitive);
  if (gaussian == nullptr || point == nullptr || term.to_local) return add_by_jets(term, exponent);
  // phi is quadratic, its gradient linear.
  const double a2 = gaussian->a * gaussian->a;
  exponent.bend = 2 * a2;
  exponent.rise = -2 * a2;
  double farthest = 0.0;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const double squared = a2 * squared_norm(points_[k] - point->position);
    farthest = std::max(farthest, squared);
    exponent.at[k] = gaussian->log_amplitude - squared;
  }
  exponent.known = kRounding * (std::abs(gaussian->log_amplitude) + farthest);
  const Vec3d way = point->position - center_;
  const double slack = kRounding * (norm(way) + radius_) * longest_;
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    exponent.slope =
        std::min(exponent.slope, 2 * a2 * (dot(way, directions_[i]) - support_[i] - slack));
  }
}

void LogHull::add_by_jets(const Term& term, Exponent& exponent) const {
  constexpr double kSmallest = 1e-280;  // values below are too small for their logarithm
  const std::size_t count = points_.size();
  std::array<Jet, kMostPoints> jets{};
  accumulate(term, points_, std::span(jets).first(count));
  const LocalBox local = local_box(term, box_);
  double steepest = kInfinity, highest = 0.0;
  visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    if constexpr (kHasLogBend<std::decay_t<decltype(kernel)>>) {
      const Reach r = reach(term, primitive, local);
      const LogBend bend = integrated(kernel, primitive, r);
      const double squared = local.stretch * local.stretch;
      exponent.bend = bend.bend * squared;
      exponent.rise = std::max(bend.rise, 0.0) * squared;
      steepest = bend.steepest * local.stretch;
      highest = integral_range(kernel, primitive, r).hi;
    }
  });
  exponent.known = kRounding * 1e3;
  exponent.upper_only = std::any_of(jets.begin(), jets.begin() + count,
                                    [](const Jet& jet) { return !(jet.value > kSmallest); });
  if (exponent.upper_only) {
    exponent.at.fill(std::log(std::max(highest, kSmallest)));
    exponent.slope = -steepest * longest_;
    return;
  }
  const double turn = std::max(exponent.bend, exponent.rise) * radius_ * longest_;
  for (std::size_t k = 0; k < count; ++k) {
    exponent.at[k] = std::log(jets[k].value);
    for (const Vec3d& u : directions_) {
      exponent.slope = std::min(exponent.slope, dot(jets[k].gradient, u) / jets[k].value - turn);
    }
  }
}

std::size_t LogHull::strongest() const {
  std::size_t best = 0;
  double most = -kInfinity;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    if (terms_[i].upper_only) continue;
    const double least =
        *std::min_element(terms_[i].at.begin(), terms_[i].at.begin() + points_.size());
    if (least > most) {
      most = least;
      best = i;
    }
  }
  return best;
}

/// The most that phi_a - phi_b is over the hull.
double LogHull::most_over(const Exponent& a, const Exponent& b) const {
  double most = -kInfinity;
  for (std::size_t k = 0; k < points_.size(); ++k) most = std::max(most, a.at[k] - b.at[k]);
  const double bend = std::max(a.bend + b.rise, 0.0);
  return most + 0.5 * bend * radius_ * radius_ + a.known + b.known;
}

/// Of w = f / sum f, given the most by which phi exceeds that of the strongest.
double LogHull::greatest_weight(const Exponent& term, double over_strongest) const {
  constexpr double kLittle = 1e-6;
  const double by_strongest = 1 / (1 + std::exp(-over_strongest));
  if (by_strongest < kLittle) return by_strongest;
  double sum = 1.0;
  for (const Exponent& other : terms_) {
    if (&other != &term && !other.upper_only) sum += std::exp(-most_over(term, other));
  }
  return std::min(by_strongest, 1 / sum);
}

void LogHull::bound(HullBound& bound) const {
  if (terms_.empty()) return;
  const Exponent& first = terms_[strongest()];
  std::vector<double> over(terms_.size());
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    over[i] = &terms_[i] == &first && !first.upper_only ? kInfinity : most_over(terms_[i], first);
  }
  // The greatest mean of some numbers that the weights allow for: the greatest come first, each
  // with as much weight as it can have.
  std::vector<std::uint32_t> order(terms_.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto greatest_mean = [&](const auto& number) {
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return number(terms_[a]) > number(terms_[b]);
    });
    double mean = 0.0, left = 1.0;
    for (const std::uint32_t i : order) {
      const double weight = std::min(left, greatest_weight(terms_[i], over[i]));
      if (weight > 0) mean += weight * number(terms_[i]);
      left -= weight;
      if (!(left > 0)) break;
    }
    return mean;
  };
  bound.bend = greatest_mean([](const Exponent& term) { return term.bend; }) * (1 + 1e-12);
  if (terms_.front().slope == kInfinity) return;  // no direction was asked for
  bound.slope = -greatest_mean([](const Exponent& term) { return -term.slope; });
}

}  // namespace cs2mesh
