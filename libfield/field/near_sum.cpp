#include "libfield/field/near_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "libfield/base/check.h"
#include "libfield/field/log_bends.h"
#include "libfield/field/pieces.h"
#include "libfield/field/pull.h"
#include "libfield/field/quadratic_range.h"
#include "libfield/field/slope_program.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// What a piece may leave open once it is far, in units of T, or of its own size at most.
constexpr double kFarError = 2e-3, kFarShare = 0.1;
/// Pieces are no larger than that part of their distance.
constexpr double kPieceSize = 0.75;
/// What a piece may leave open of its tangent over a box, in units of T, to be known by it.
constexpr double kLinear = 6e-3;
/// What terms that are bounded one by one may leave open, in units of T, without a closer look.
constexpr double kNegligible = 1e-4;
/// Values below this have no exponent.
constexpr double kSmallest = 1e-200;
/// The part of a finite support beyond which a kernel's logarithm bends too much.
constexpr double kEdge = 0.97;

/// Whether the term is small and smooth where it is far.
bool is_tame(const Term& term) {
  constexpr double kMostAmplitude = 500.0, kMostCondition = 1e4;
  if (!term.profiles.empty() || std::holds_alternative<Plane>(term.primitive)) return false;
  if (const auto* gaussian = std::get_if<Gaussian>(&term.kernel)) {
    if (!(gaussian->log_amplitude < kMostAmplitude)) return false;
  }
  const auto* triangle = std::get_if<Triangle>(&term.primitive);
  return triangle == nullptr || condition_number(*triangle) < kMostCondition;
}

bool is_tapered(const Term& term) {
  return std::holds_alternative<TaperedSegment>(term.primitive);
}

/// Whether the term can be known in the exponent where it is not near an edge.
bool may_have_exponent(const Term& term) {
  return is_tame(term) && !is_tapered(term);
}

/// Whether it can be known by a polynomial where it is far. (Where weights are of both signs, its
/// rounding is not that of its value.)
bool may_be_far(const Term& term) {
  const auto* tapered = std::get_if<TaperedSegment>(&term.primitive);
  if (tapered != nullptr) {
    const SegmentWeight& w = tapered->weight;
    return is_tame(term) && std::min({w.b0, w.b1, w.b2}) >= 0;
  }
  return is_tame(term);
}

}  // namespace

bool has_near_bounds(const Term& term) {
  const bool reaches_everywhere =
      std::visit([](const auto& kernel) { return std::isinf(kernel.support()); }, term.kernel);
  return is_tame(term) && (reaches_everywhere || std::holds_alternative<Point>(term.primitive));
}

bool has_cheap_near_bounds(const Term& term) {
  return has_near_bounds(term) && !is_tapered(term) &&
         !std::holds_alternative<Triangle>(term.primitive);
}

namespace {

/// Bends of the logarithm of the integral over a piece at those distances. Of paths from element to
/// element, those within the piece are near enough.
template <class K, class P>
LogBends piece_bends(const K& kernel, const P& primitive, double near, double far) {
  LogBends bends = log_bends(kernel, near, far);
  if constexpr (!std::is_same_v<P, Point>) {
    const double way = std::is_same_v<P, Arc> ? measure(primitive) : size(primitive);
    const double difference =
        std::min(way * std::max(bends.most, std::abs(bends.least)), 2 * bends.steepest);
    bends.least -= 0.25 * difference * difference * (1 + 1e-12);
    if constexpr (kLogConcave<K> && !std::is_same_v<P, Arc>)
      bends.least = std::max(0.0, bends.least);
  }
  return bends;
}

/// What an integral over elements at those distances is at most, times what its logarithm bends
/// down at most: no more than those of the elements do, as the covariance of their gradients only
/// bends it up.
template <class K, class P>
double weighted_bend(const K& kernel, const P& primitive, const LocalBox& local, const Reach& r) {
  if constexpr (std::is_same_v<K, Inverse> || std::is_same_v<K, Squared>) {
    if (!(r.near > kernel.clamp)) return kInfinity;
  }
  if (!(r.far < kEdge * kernel.support())) return kInfinity;
  return integral_range(kernel, primitive, r).hi * log_bends(kernel, r.near, r.far).most *
         local.stretch * local.stretch;
}

}  // namespace

/// A piece as seen from a box.
struct NearSum::View {
  enum class Kind { nothing, linear, exponent, other } kind = Kind::nothing;
  Exponent exponent;
  double turn = 0.0;         ///< where it is linear: a bound of |D^2 f|
  double error = 0.0;        ///< and of rounding
  double rate = -kInfinity;  ///< lower bound of slope over value by the places of its elements
};

namespace {

/// The exponent of |f| over the box, whose jet at the centre is given; false where it has none.
template <class K, class P>
bool find_exponent(const Term& term, const K& kernel, const P& primitive, const LocalBox& local,
                   const Reach& r, const Jet& jet, Exponent& out) {
  const double value = std::abs(jet.value);
  if (!(value > kSmallest)) return false;
  if constexpr (std::is_same_v<K, Inverse> || std::is_same_v<K, Squared>) {
    if (!(r.near > kernel.clamp)) return false;
  }
  if (!(r.far < kEdge * kernel.support())) return false;
  const LogBends bends = piece_bends(kernel, primitive, r.near, r.far);
  out.phi = std::log(value);
  out.gradient = jet.gradient / jet.value;
  const double squared = local.stretch * local.stretch;
  out.most = bends.most * squared;
  out.least = term.to_local ? std::min(0.0, bends.least) * squared : bends.least;
  out.rounding = 4 * kBackwardError * (condition_number(primitive) + bends.steepest * r.scale);
  return true;
}

}  // namespace

/// A box as terms without a transformation see it, computed once.
struct NearSum::Sight {
  explicit Sight(const BatchBox& box_) : box(box_), plain(local_box(Term{}, box_.box)) {}
  LocalBox local(const Term& term) const {
    return term.to_local ? local_box(term, box.box) : plain;
  }
  const BatchBox& box;
  LocalBox plain;
};

namespace {

/// An upper bound of |D^2 f| over the box, cheaper than the tightest.
template <class K, class P>
double turn_bound(const K& kernel, const P& primitive, const LocalBox& local, const Reach& r) {
  return mass_bound(primitive) * kernel.derivative_envelope(2, r.near) * local.stretch *
         local.stretch * (1 + 1e-12);
}

/// What a term's tangent leaves open: a bound of |D^2 f|, and what rounding is relative to the
/// value and the gradient.
struct Linear {
  double turn = 0.0, value_rounding = 0.0, slope_rounding = 0.0;
};

/// Whether over all the boxes of the hull, none with a greater radius, the term is linear enough.
template <class Sight>
std::optional<Linear> linear_over(const Term& term, const Sight& hull, double radius) {
  const LocalBox local = hull.local(term);
  return visit_pair(term, [&](const auto& kernel, const auto& primitive) -> std::optional<Linear> {
    const Reach r = reach(term, primitive, local);
    if (r.near > kernel.support()) return Linear{};
    const double turn = turn_bound(kernel, primitive, local, r);
    if (!(turn * radius * std::max(radius, r.near) <= kLinear)) return std::nullopt;
    const double rounding = kBackwardError * condition_number(primitive);
    return Linear{turn, rounding, rounding * r.scale};
  });
}

template <class View>
View view_of_tangent(const Linear& linear, const Jet& jet) {
  View view;
  view.kind = View::Kind::linear;
  view.turn = linear.turn;
  view.error =
      linear.value_rounding * std::abs(jet.value) + linear.slope_rounding * norm(jet.gradient);
  return view;
}

/// A piece as seen from a box; with a direction, its slope along it, too.
template <class View, class Sight>
View view_of(const Term& term, const Sight& sight, const Jet& jet, const Vec3d* direction) {
  const LocalBox local = sight.local(term);
  return visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    View view;
    const Reach r = reach(term, primitive, local);
    if (r.near > kernel.support()) return view;
    const double radius = sight.box.radius;
    const double turn = turn_bound(kernel, primitive, local, r);
    if (turn * radius * std::max(radius, r.near) <= kLinear) {
      const double rounding = kBackwardError * condition_number(primitive);
      return view_of_tangent<View>({turn, rounding, rounding * r.scale}, jet);
    }
    const Vec3d way = direction == nullptr ? Vec3d{}
                      : term.to_local      ? term.to_local->linear * *direction
                                           : *direction;
    if (find_exponent(term, kernel, primitive, local, r, jet, view.exponent)) {
      view.kind = View::Kind::exponent;
    } else {
      view.kind = View::Kind::other;
      return view;
    }
    if (direction == nullptr) return view;
    const Pull own = pull(term, kernel, primitive, local, way, r);
    // The program here has no room for what is out of sight.
    if (own.lost == 0.0) view.rate = own.rate;
    return view;
  });
}

}  // namespace

// ---- Building ----

/// Sorts terms for a box.
struct NearSum::Builder {
  NearSum& sum;

  void sort(const Term& term) {
    const BatchBox& box = sum.box_;
    const LocalBox local = local_box(term, box.box);
    enum class Place { nowhere, far, near, other, cut };
    const Place place = visit_pair(term, [&](const auto& kernel, const auto& primitive) {
      const Reach r = reach(term, primitive, local);
      if (r.near > kernel.support()) return Place::nowhere;
      if (may_be_far(term) && is_far(kernel, primitive, local, r)) {
        add_far(term, kernel, primitive, local, r);
        return Place::far;
      }
      if (!may_have_exponent(term)) return Place::other;
      const double from = std::max(r.near + local.radius, 0.5 * kernel.length_scale());
      const bool large = size(primitive) > kPieceSize * from;
      return large && can_be_halved(term) && from > 0 ? Place::cut : Place::near;
    });
    if (place == Place::near) sum.near_.push_back(&term);
    if (place == Place::other) sum.others_.push_back(&term);
    if (place == Place::cut) cut(term);
  }

 private:
  template <class K, class P>
  static bool is_far(const K& kernel, const P& primitive, const LocalBox& local, const Reach& r) {
    if (!(r.near > 2 * local.radius)) return false;
    const double mass = mass_bound(primitive), radius = local.radius;
    const double least = mass * kernel.profile(r.far * r.far);
    const double second = 0.5 * mass * kernel.derivative_envelope(2, r.near) * radius * radius;
    const double third =
        mass * kernel.derivative_envelope(3, r.near) * radius * radius * radius / 6;
    return std::min(second, third) <= (radius / r.near) * std::max(kFarError, kFarShare * least);
  }

  template <class K, class P>
  void add_far(const Term& term, const K& kernel, const P& primitive, const LocalBox& local,
               const Reach& r) {
    const BatchBox& box = sum.box_;
    std::array<Vec3d, 4> points = box.points();
    std::array<Jet, 4> jets;
    local_jets(term, kernel, primitive, points, jets);
    const double turn = near_bound(kernel, primitive, 2, r.near);
    const double third = near_bound(kernel, primitive, 3, r.near);
    const double cubed = local.stretch * local.stretch * local.stretch;
    const double error =
        gradient_error(condition_number(primitive), norm(jets[0].gradient), turn, r.scale) *
        local.stretch;
    for (Jet& jet : jets) jet.gradient = to_world_gradient(term, jet.gradient);
    const double radius = box.radius, squared = local.stretch * local.stretch;
    const double first_slope = turn * squared * radius;
    const double second_slope = second_gradient_remainder(box, cubed * third, cubed * third, error);
    Far& far = sum.far_;
    far.bend += term.sign > 0 ? weighted_bend(kernel, primitive, local, r) : kInfinity;
    far.center.value += term.sign * jets[0].value;
    far.center.gradient += term.sign * jets[0].gradient;
    const double rounding =
        kBackwardError * condition_number(primitive) * std::abs(jets[0].value) + error * r.scale;
    if (second_slope < first_slope) {
      far.center.hessian += term.sign * difference_quotient(jets, box);
      far.value_error += second_remainder(box, cubed * third, cubed * third, error);
      far.slope_error += second_slope;
    } else {
      far.value_error += 0.5 * turn * squared * radius * radius;
      far.slope_error += first_slope;
    }
    far.value_error += rounding;
    far.slope_error += error;
  }

  void cut(const Term& term) {
    std::pair<Term, Term> parts = halves(term);
    for (Term* part : {&parts.first, &parts.second}) {
      sum.made_.push_back(std::make_unique<const Term>(std::move(*part)));
      sort(*sum.made_.back());
    }
  }
};

NearSum::NearSum(std::span<const Term> terms, std::span<const std::uint32_t> list, const Aabb& box)
    : box_(box) {
  Builder builder{*this};
  for (const std::uint32_t i : list) builder.sort(terms[i]);
}

NearSum::NearSum(std::shared_ptr<const NearSum> around, const Aabb& box)
    : box_(box), around_(std::move(around)) {
  require(around_->box_.box.contains(box), "NearSum: a box within another");
  const Far& far = around_->far_;
  const Vec3d offset = box_.center - around_->box_.center;
  const Vec3d turned = far.center.hessian * offset;
  far_ = far;
  far_.center.value += dot(far.center.gradient, offset) + 0.5 * dot(turned, offset);
  far_.center.gradient += turned;
  Builder builder{*this};
  for (const Term* term : around_->near_) builder.sort(*term);
  for (const Term* term : around_->others_) builder.sort(*term);
}

NearSum::~NearSum() = default;

const std::shared_ptr<const NearSum>& LazyNearSum::get() const {
  std::call_once(once_, [this] {
    sum_ = around_ ? std::make_shared<const NearSum>(around_->get(), box_)
                   : std::make_shared<const NearSum>(terms_, list_, box_);
  });
  return sum_;
}

// ---- Bounds ----

/// The near pieces as seen from a box: those that add and those that subtract.
struct NearSum::Parts {
  std::array<std::vector<Exponent>, 2> exponents;
  std::array<std::vector<double>, 2> slopes;  ///< of these, lower bounds along a direction
  /// What has no exponent here; what is known by its tangent, its curvature and rounding.
  std::vector<const Term*> others;
  Jet tangent;
  double turn = 0.0, error = 0.0;

  void clear() {
    for (auto& list : exponents) list.clear();
    for (auto& list : slopes) list.clear();
    others.clear();
    tangent = {};
    turn = error = 0.0;
  }
  void add(const Term& term, const View& view, const Jet& jet) {
    if (view.kind == View::Kind::exponent)
      exponents[term.sign > 0 ? 0 : 1].push_back(view.exponent);
    if (view.kind == View::Kind::other) others.push_back(&term);
    if (view.kind != View::Kind::linear) return;
    tangent.value += jet.value;
    tangent.gradient += jet.gradient;
    turn += view.turn;
    error += view.error;
  }
};

/// The polynomial that is far about the centre of a box.
Jet2 NearSum::far_about(const BatchBox& box) const {
  const Vec3d offset = box.center - box_.center;
  const Vec3d turned = far_.center.hessian * offset;
  return {far_.center.value + dot(far_.center.gradient, offset) + 0.5 * dot(turned, offset),
          far_.center.gradient + turned, far_.center.hessian};
}

/// Of the polynomial and all tangents.
Interval NearSum::smooth_range(const Jet2& far, const Parts& parts, const BatchBox& box) const {
  const double value = far.value + parts.tangent.value;
  const double open = far_.value_error + 0.5 * parts.turn * box.radius * box.radius + parts.error +
                      1e-13 * (std::abs(value) + norm(far.gradient) * box_.radius);
  return widened(quadratic_range(far.gradient + parts.tangent.gradient, far.hessian, box.half) +
                     Interval(value),
                 open * (1 + 1e-12));
}

/// A lower bound of their derivative along a direction.
double NearSum::smooth_slope(const Jet2& far, const Parts& parts, const BatchBox& box,
                             const Vec3d& direction) const {
  const double length = norm(direction);
  const Vec3d gradient = far.gradient + parts.tangent.gradient;
  return dot(gradient, direction) - extent_along(far.hessian * direction, box.half) -
         length * (far_.slope_error + parts.turn * box.radius) * (1 + 1e-12) -
         1e-12 * length * norm(gradient);
}

/// What is collected for hull_bound().
struct NearSum::Hull {
  Parts parts;
  std::vector<double> bends;                ///< of the exponents, with their sign turned
  std::vector<std::vector<double>> slopes;  ///< of the exponents, by direction
  double bend = 0.0;                        ///< of what is far and of tangents, weighted

  void clear(std::size_t directions, double far_bend) {
    parts.clear();
    bends.clear();
    slopes.resize(directions);
    for (auto& list : slopes) list.clear();
    bend = far_bend;
  }
};

namespace {

Interval exponential(const Interval& log_range) {
  return {vmath::exp(log_range.lo) * (1 - 1e-13), vmath::exp(log_range.hi) * (1 + 1e-13)};
}

}  // namespace

void NearSum::enclose(std::span<const BatchBox> boxes, std::span<Interval> out) const {
  const BoxBatch batch(boxes, TaylorOrder::second);
  thread_local std::vector<Vec3d> centers;
  thread_local std::vector<Parts> parts;
  thread_local std::vector<Jet> jets;
  std::vector<Sight> sights;
  sights.reserve(boxes.size());
  centers.clear();
  for (const BatchBox& box : boxes) {
    centers.push_back(box.center);
    sights.emplace_back(box);
  }
  const BatchBox hull(batch.hull);
  const Sight all(hull);
  parts.resize(std::max(parts.size(), boxes.size()));
  for (Parts& part : parts) part.clear();
  jets.resize(boxes.size());
  for (const Term* term : near_) {
    std::fill(jets.begin(), jets.end(), Jet{});
    accumulate(*term, centers, std::span(jets));
    const std::optional<Linear> linear = linear_over(*term, all, batch.radius);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const View view = linear ? view_of_tangent<View>(*linear, jets[i])
                               : view_of<View>(*term, sights[i], jets[i], nullptr);
      parts[i].add(*term, view, jets[i]);
    }
  }
  std::vector<SumBound> others(boxes.size());
  for (const Term* term : others_) add_bounds(*term, batch, kNegligible, others);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const BoxBatch one(boxes.subspan(i, 1), TaylorOrder::second);
    for (const Term* term : parts[i].others) add_bounds(*term, one, kNegligible, {&others[i], 1});
    const auto& [added, subtracted] = parts[i].exponents;
    out[i] = smooth_range(far_about(boxes[i]), parts[i], boxes[i]) +
             exponential(log_range(added, boxes[i])) - exponential(log_range(subtracted, boxes[i]));
    const std::size_t count = others_.size() + parts[i].others.size();
    if (count > 0) out[i] = out[i] + range_of(others[i], count, boxes[i]);
  }
}

double NearSum::least_slope(const BatchBox& box, const Vec3d& direction, double total,
                            double error) const {
  thread_local Parts parts;
  parts.clear();
  const Sight sight(box);
  for (const Term* term : near_) {
    Jet jet;
    accumulate(*term, {&box.center, 1}, std::span(&jet, 1));
    // Of what is subtracted, the greatest slope is wanted.
    const Vec3d way = term->sign * direction;
    const View view = view_of<View>(*term, sight, jet, &way);
    parts.add(*term, view, jet);
    if (view.kind == View::Kind::exponent) {
      parts.slopes[term->sign > 0 ? 0 : 1].push_back(
          std::max(view.rate, view.exponent.least_slope(box, way)));
    }
  }
  const Jet2 far = far_about(box);
  const double slope = smooth_slope(far, parts, box, direction);
  SlopeProgram program;
  program.add(widened(smooth_range(far, parts, box), error), slope);
  for (const Term* term : others_) program.add(*term, box, direction);
  for (const Term* term : parts.others) program.add(*term, box, direction);
  const auto& [added, subtracted] = parts.exponents;
  if (!subtracted.empty()) {
    // d . grad (-N) is at least the mean slope of N along -d, times N.
    const Interval lost = exponential(log_range(subtracted, box));
    const double rate = least_mean_slope(subtracted, parts.slopes[1], box);
    program.add(-lost, rate * (rate > 0 ? lost.lo : lost.hi));
  }
  SlopeProgram one_by_one = program;
  // Together they are what is left of the total.
  if (!added.empty()) {
    program.add_rate({0.0, kInfinity}, least_mean_slope(added, parts.slopes[0], box));
  }
  const double together = program.least(total);
  if (together > 0) return together;
  for (std::size_t i = 0; i < added.size(); ++i) {
    one_by_one.add_rate(exponential(added[i].range(box)), parts.slopes[0][i]);
  }
  return std::max(together, one_by_one.least(total));
}

/// Adds what is known of a near term, its weighted bend, and its slopes; false if that is nothing.
bool NearSum::add_to_hull(const Term& term, const Sight& sight, std::span<const Vec3d> directions,
                          Hull& hull) const {
  if (term.sign < 0) return false;
  Jet jet;
  accumulate(term, {&sight.box.center, 1}, std::span(&jet, 1));
  const LocalBox local = sight.local(term);
  return visit_pair(term, [&](const auto& kernel, const auto& primitive) {
    const Reach r = reach(term, primitive, local);
    if (r.near > kernel.support()) return true;
    const double turn = turn_bound(kernel, primitive, local, r), radius = sight.box.radius;
    const bool little = turn * radius * std::max(radius, r.near) <= kLinear;
    Exponent exponent;
    if (!little && find_exponent(term, kernel, primitive, local, r, jet, exponent)) {
      hull.parts.exponents[0].push_back(exponent);
      hull.bends.push_back(-std::max(0.0, exponent.most));
      for (std::size_t i = 0; i < directions.size(); ++i) {
        const Vec3d& direction = directions[i];
        const Vec3d way = term.to_local ? term.to_local->linear * direction : direction;
        const Pull own = pull(term, kernel, primitive, local, way, r);
        const double rate = own.lost == 0.0 ? own.rate : -kInfinity;
        hull.slopes[i].push_back(std::max(rate, exponent.least_slope(sight.box, direction)));
      }
      return true;
    }
    hull.bend += weighted_bend(kernel, primitive, local, r);
    const double rounding = kBackwardError * condition_number(primitive);
    hull.parts.add(term, view_of_tangent<View>({turn, rounding, rounding * r.scale}, jet), jet);
    return hull.bend < kInfinity;
  });
}

bool NearSum::hull_bound(const BatchBox& box, std::span<const Vec3d> directions,
                         HullBound& bound) const {
  if (!others_.empty() || far_.bend == kInfinity) return false;
  // S = A + N, of which N is known in the exponent, and A, what is far or little, by its polynomial
  // and by what its terms bend at most.
  thread_local Hull hull;
  hull.clear(directions.size(), far_.bend);
  const Sight sight(box);
  for (const Term* term : near_) {
    if (!add_to_hull(*term, sight, directions, hull)) return false;
  }
  const Parts& parts = hull.parts;
  const std::vector<Exponent>& exponents = parts.exponents[0];
  const Jet2 far = far_about(box);
  const Interval smooth = smooth_range(far, parts, box),
                 near = exponential(log_range(exponents, box));
  const double least = near.lo + std::max(0.0, smooth.lo), most = near.hi + smooth.hi;
  if (!(least > 0)) return false;
  // The weighted mean of numbers of N, with the share of N in S.
  const auto mean = [&](std::span<const double> numbers) {
    if (numbers.empty()) return 0.0;
    // Where weights say nothing, the mean is not below all.
    const double n = std::max(*std::min_element(numbers.begin(), numbers.end()),
                              least_mean_slope(exponents, numbers, box));
    return n * (n > 0 ? near.lo / most * (1 - 1e-12) : std::min(1.0, near.hi / least));
  };
  bound.in_exponent = true;
  bound.bend = (hull.bend / least - mean(hull.bends)) * (1 + 1e-12);
  if (directions.empty()) return true;
  bound.slope = kInfinity;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double slope = smooth_slope(far, parts, box, directions[i]);
    bound.slope = std::min(bound.slope, mean(hull.slopes[i]) + slope / (slope > 0 ? most : least));
  }
  return true;
}

}  // namespace cs2mesh
