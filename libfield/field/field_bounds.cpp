// What a field knows of its values, slopes and curvatures over boxes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "libfield/field/field_data.h"
#include "libfield/field/log_sum.h"
#include "libfield/field/near_sum.h"
#include "libfield/field/slope_program.h"
#include "libfield/field/term_bounds.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kManyTerms = 4096;
/// What the rounding of thousands of terms leaves open, relative to their sum: 64 ulp each.
constexpr double kBackwardErrors = 64 * std::numeric_limits<double>::epsilon();

}  // namespace

/// What is known of F over a box.
struct Field::Enclosure {
  Interval range;
  /// The part in half the width of Taylor's remainders and of terms that are known by their range
  /// alone: what smaller boxes and polynomials of higher order may take away.
  double remainder = 0.0;

  bool loose(double width) const { return 2 * remainder > kSmallPart * width; }
  bool very_loose(double width) const { return 2 * remainder > kLargePart * width; }

  static constexpr double kSmallPart = 0.3, kLargePart = 0.5;
  /// Whether the polynomial alone would tell the sign.
  bool hangs_on_remainder() const {
    return range.contains(0.0) && (range.lo + remainder > 0 || range.hi - remainder < 0);
  }
};

Interval Field::enclose(const Aabb& box) const {
  const BatchBox one(box);
  Enclosure whole;
  enclose_batch({&one, 1}, TaylorOrder::first, {&whole, 1});
  if (!whole.loose(whole.range.width())) return whole.range;
  Enclosure second;
  enclose_batch({&one, 1}, TaylorOrder::second, {&second, 1});
  whole = {intersection(whole.range, second.range), std::min(whole.remainder, second.remainder)};
  return whole.very_loose(whole.range.width()) ? enclose_in_parts(box, whole) : whole.range;
}

/// Halves the box along every axis, then those of its parts that decide how far the range extends.
Interval Field::enclose_in_parts(const Aabb& box, const Enclosure& whole) const {
  constexpr int kMostRounds = 2;
  Interval range = whole.range;
  std::vector<std::pair<Aabb, Enclosure>> loose{{box, whole}};
  std::optional<Interval> settled;
  const auto settle = [&settled](const Interval& part) {
    settled = settled ? hull(*settled, part) : part;
  };
  for (int round = 0; round < kMostRounds && !loose.empty(); ++round) {
    std::vector<BatchBox> parts;
    for (const auto& [parent, enclosure] : loose) {
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3d center = parent.center(), end = parent.corner(corner);
        parts.emplace_back(Aabb{min(center, end), max(center, end)});
      }
    }
    std::vector<Enclosure> enclosures(parts.size());
    enclose_batch(parts, TaylorOrder::second, enclosures);
    std::optional<Interval> all = settled;
    for (const Enclosure& part : enclosures) all = all ? hull(*all, part.range) : part.range;
    range = intersection(range, *all);
    loose.clear();
    const double width = range.width();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Enclosure& part = enclosures[i];
      const bool decides =
          part.range.lo < range.lo + 0.125 * width || part.range.hi > range.hi - 0.125 * width;
      if (decides && part.very_loose(width)) {
        loose.emplace_back(parts[i].box, part);
      } else {
        settle(part.range);
      }
    }
  }
  return range;
}

double Field::turn() const {
  double turn = turn_.load(std::memory_order_acquire);
  if (turn >= 0) return turn;
  std::vector<std::uint32_t> list;
  near_terms(box_, list);
  turn = 0.0;
  double subtracted = 0.0;
  for (const std::uint32_t i : list) {
    const Term& term = data_->terms[i];
    if (!term.profiles.empty()) continue;
    turn += cs2mesh::derivative_bound(term, 2, box_);
    if (term.sign < 0) subtracted += magnitude_bound(term, box_.distance(skeleton_box(term)));
  }
  for (const FarField& far : data_->far) turn += far.derivative_bound(2, box_);
  // Whoever comes first, the numbers are the same.
  subtracted_.store(subtracted, std::memory_order_relaxed);
  turn_.store(turn, std::memory_order_release);
  return turn;
}

/// Whether one bound of the second derivative serves all boxes in the restriction's, this among
/// them.
bool Field::knows_turn(const Aabb& box) const {
  return restricted_ && (data_->positive || data_->far.empty()) && box_.contains(box) &&
         std::isfinite(turn());
}

/// The jets of all terms without a profile; the others near the points go into `profiled`.
void Field::plain_jets(std::span<const Vec3d> points, std::vector<std::uint32_t>& profiled,
                       std::span<Jet> out) const {
  std::vector<std::uint32_t> list;
  near_terms(box_, list);
  const auto is_plain = [&](std::uint32_t i) { return data_->terms[i].profiles.empty(); };
  const auto middle = std::stable_partition(list.begin(), list.end(), is_plain);
  profiled.assign(middle, list.end());
  list.erase(middle, list.end());
  std::fill(out.begin(), out.end(), Jet{});
  for (const FarField& far : data_->far) far.add(points, out);
  add_terms(*data_, list, points, out);
}

/// As enclose_batch(), a jet a box but for terms with profiles.
void Field::enclose_by_turn(std::span<const BatchBox> boxes, std::span<Enclosure> out) const {
  const BoxBatch batch(boxes, TaylorOrder::first);
  std::vector<Vec3d> centers;
  for (const BatchBox& box : boxes) centers.push_back(box.center);
  std::vector<Jet> jets(boxes.size());
  std::vector<std::uint32_t> profiled;
  plain_jets(centers, profiled, jets);
  std::vector<SumBound> sums(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    sums[i].add_polynomial(1.0, {&jets[i], 1}, boxes[i]);
    sums[i].remainder = 0.5 * turn() * boxes[i].radius * boxes[i].radius * (1 + 1e-12);
  }
  const double negligible = 1e-2 * kThreshold / static_cast<double>(data_->terms.size());
  for (const std::uint32_t i : profiled) add_bounds(data_->terms[i], batch, negligible, sums);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    // How large the terms are the sum tells, but for those that are subtracted.
    const double size = std::abs(jets[i].value) + 2 * subtracted_.load(std::memory_order_relaxed);
    const double rounding = kBackwardErrors * (1 + data_->bounds.diagonal() / box_.diagonal()) *
                            (size + norm(jets[i].gradient) * box_.diagonal());
    const Interval range = range_of(sums[i], profiled.size() + 1, boxes[i]) - Interval(kThreshold);
    out[i] = {widened(range, data_->error_budget + rounding),
              sums[i].remainder + 0.5 * sums[i].range.width()};
  }
}

double Field::least_slope_by_turn(const BatchBox& box, const Vec3d& direction) const {
  Jet jet;
  std::vector<std::uint32_t> profiled;
  plain_jets({&box.center, 1}, profiled, {&jet, 1});
  const double open = turn() * box.radius + kBackwardErrors * norm(jet.gradient);
  const double least = dot(jet.gradient, direction) - norm(direction) * open * (1 + 1e-12);
  if (profiled.empty()) return least;
  GradientSum sum;
  for (const std::uint32_t i : profiled) add_gradient_bound(data_->terms[i], box, sum);
  return least + least_along(sum.bound(box), direction);
}

void Field::enclose_each(std::span<const Aabb> boxes, std::span<Interval> out) const {
  require(boxes.size() == out.size(), "one interval a box");
  std::vector<BatchBox> batch(boxes.begin(), boxes.end());
  if (data_->in_exponents) return enclose_in_exponents(batch, out);
  const BoxBatch all(batch, TaylorOrder::first);
  if (near_sum_ && !boxes.empty() && box_.contains(all.hull)) {
    return enclose_by_near_sum(batch, out);
  }
  std::vector<Enclosure> enclosures(boxes.size());
  if (!boxes.empty() && knows_turn(all.hull)) {
    enclose_by_turn(batch, enclosures);
    // Only what the remainder decides deserves bounds of its own.
    const bool good = std::none_of(enclosures.begin(), enclosures.end(),
                                   [](const Enclosure& e) { return e.hangs_on_remainder(); });
    if (good) {
      for (std::size_t i = 0; i < boxes.size(); ++i) out[i] = enclosures[i].range;
      return;
    }
  }
  enclose_batch(batch, TaylorOrder::first, enclosures);
  std::vector<BatchBox> open;
  std::vector<std::size_t> place;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    out[i] = enclosures[i].range;
    if (!enclosures[i].hangs_on_remainder()) continue;
    open.push_back(batch[i]);
    place.push_back(i);
  }
  if (open.empty()) return;
  enclosures.assign(open.size(), {});
  enclose_batch(open, TaylorOrder::second, enclosures);
  for (std::size_t k = 0; k < open.size(); ++k) {
    out[place[k]] = intersection(out[place[k]], enclosures[k].range);
  }
}

void Field::enclose_by_near_sum(std::span<const BatchBox> boxes, std::span<Interval> out) const {
  near_sum_->get()->enclose(boxes, out);
  for (Interval& range : out) range = widened(range - Interval(kThreshold), data_->error_budget);
}

/// Those that bounds in the exponent over this box are to take into account.
LogTerms Field::log_terms_in(const Aabb& box) const {
  constexpr double kLeftOut = 1e-3;
  std::vector<std::uint32_t> list;
  near_terms(box, list);
  return {data_->terms, list, box, kLeftOut * kThreshold};
}

/// Runs f(terms) with those over `box`: in a restriction, with those over its own box.
template <class F>
void Field::with_log_terms(const Aabb& box, const F& f) const {
  if (!restricted_ || !box_.contains(box)) return f(log_terms_in(box));
  f(log_terms_.get([this] { return log_terms_in(box_); }));
}

void Field::enclose_in_exponents(std::span<const BatchBox> boxes, std::span<Interval> out) const {
  const Aabb hull = BoxBatch(boxes, TaylorOrder::first).hull;
  require(boxes.empty() || hull.finite(), "enclosures need finite boxes");
  with_log_terms(hull, [&](const LogTerms& terms) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      LogSum sum(terms, boxes[i]);
      out[i] = range_in_exponents(terms, sum);
    }
  });
}

Interval Field::range_in_exponents(const LogTerms& terms, LogSum& sum) const {
  const Interval log_range = sum.range();
  // Where an exponent is cut off, F is no less than that.
  const double least = std::min(log_range.lo, Gaussian::kGreatestExponent);
  const Interval range(std::exp(least) * (1 - 1e-13),
                       std::exp(log_range.hi) * (1 + 1e-13) + terms.left_out());
  return widened(range - Interval(kThreshold), data_->error_budget);
}

/// On the surface the terms that matter are T less what was left out, at least.
double Field::slope_in_exponents(const LogTerms& terms, const LogSum& sum,
                                 const Vec3d& direction) const {
  const double relative = sum.least_slope(direction);
  const double value = relative > 0 ? kThreshold - terms.left_out() : kThreshold;
  return value * relative - terms.left_out_slope() * norm(direction);
}

/// Whether the range shows that F keeps its sign.
bool Field::keeps_sign_in_exponents(const LogTerms& terms, LogSum& sum) const {
  const Interval range = range_in_exponents(terms, sum);
  return range.lo > 0 || range.hi < 0;
}

Rise Field::rise(const Aabb& box, const Vec3d& gradient) const {
  if (!data_->in_exponents) return {gradient, least_slope(box, gradient)};
  require(box.finite(), "rise needs a finite box");
  Rise found;
  with_log_terms(box, [&](const LogTerms& terms) {
    LogSum sum(terms, BatchBox(box));
    found = {gradient, slope_in_exponents(terms, sum, gradient)};
    if (found.slope > 0) return;
    if (keeps_sign_in_exponents(terms, sum)) {
      found.slope = kInfinity;
      return;
    }
    const Vec3d common = norm(gradient) * sum.common_direction();
    const double slope = slope_in_exponents(terms, sum, common);
    if (slope > found.slope) found = {common, slope};
  });
  return found;
}

void Field::enclose_batch(std::span<const BatchBox> boxes, TaylorOrder order,
                          std::span<Enclosure> out) const {
  const BoxBatch batch(boxes, order);
  require(boxes.empty() || batch.hull.finite(), "enclosures need finite boxes");
  std::vector<std::uint32_t> list;
  near_terms(batch.hull, list);
  // What far terms leave open together is small against T, the less where more is asked for. Boxes
  // near very many terms are large beside the features of their sum: ranges will do.
  const double together = (order == TaylorOrder::first ? 1e-2 : 1e-4) * kThreshold;
  const double negligible =
      list.size() > kManyTerms ? kInfinity : together / static_cast<double>(data_->terms.size());
  std::vector<SumBound> sums(boxes.size());
  for (const std::uint32_t i : list) add_bounds(data_->terms[i], batch, negligible, sums);
  std::size_t terms = list.size();
  for (const FarField& far : data_->far) terms += far.add_bounds(batch, negligible, sums);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Interval range = range_of(sums[i], terms, boxes[i]) - Interval(kThreshold);
    out[i] = {widened(range, data_->error_budget), sums[i].remainder + 0.5 * sums[i].range.width()};
  }
}

std::array<Interval, 3> Field::enclose_gradient(const Aabb& box) const {
  require(box.finite(), "enclose_gradient needs a finite box");
  std::vector<std::uint32_t> list;
  near_terms(box, list);
  const BatchBox one(box);
  GradientSum sum;
  for (const std::uint32_t i : list) add_gradient_bound(data_->terms[i], one, sum);
  for (const FarField& far : data_->far) far.add_gradient_bound(one, sum);
  return sum.bound(one);
}

double Field::least_slope(const Aabb& box, const Vec3d& direction) const {
  require(box.finite(), "least_slope needs a finite box");
  const BatchBox one(box);
  if (data_->in_exponents) {
    double least = -kInfinity;
    with_log_terms(box, [&](const LogTerms& terms) {
      LogSum sum(terms, one);
      least = slope_in_exponents(terms, sum, direction);
      if (!(least > 0) && keeps_sign_in_exponents(terms, sum)) least = kInfinity;
    });
    return least;
  }
  if (near_sum_ && box_.contains(box)) {
    return near_sum_->get()->least_slope(one, direction, kThreshold, data_->error_budget);
  }
  if (knows_turn(box)) {
    const double least = least_slope_by_turn(one, direction);
    if (least > 0) return least;
    if (keeps_sign(box)) return kInfinity;
  }
  std::vector<std::uint32_t> list;
  near_terms(box, list);
  SlopeProgram program;
  for (const std::uint32_t i : list) program.add(data_->terms[i], one, direction);
  for (const FarField& far : data_->far) {
    GradientSum gradient;
    far.add_gradient_bound(one, gradient);
    SumBound value;
    far.add_bounds(BoxBatch({&one, 1}, TaylorOrder::first), 0.0, {&value, 1});
    program.add(range_of(value, 1, one), least_along(gradient.bound(one), direction));
  }
  program.add(Interval(-data_->error_budget, data_->error_budget), 0.0);
  const double least = program.least(kThreshold);
  if (least > 0 || data_->terms.size() == 1) return least;
  // Together the gradients may turn less than each by itself.
  return std::max(least, least_along(enclose_gradient(box), direction));
}

/// Whether the cheaper enclosure shows that F keeps its sign.
bool Field::keeps_sign(const Aabb& box) const {
  Interval range;
  enclose_each({&box, 1}, {&range, 1});
  return range.lo > 0 || range.hi < 0;
}

bool Field::has_cheap_bounds() const {
  return data_->cheap_bounds;
}

bool Field::has_cheap_hull_bounds() const {
  return data_->cheap_hulls;
}

double Field::derivative_bound(int order, const Aabb& box) const {
  require(1 <= order && order <= 4, "derivative bounds exist for orders 1 to 4");
  if (order == 1) {
    const std::array<Interval, 3> g = enclose_gradient(box);
    return norm(Vec3d{g[0].magnitude(), g[1].magnitude(), g[2].magnitude()});
  }
  std::vector<std::uint32_t> list;
  near_terms(box, list);
  double sum = 0;
  for (const std::uint32_t i : list) {
    sum += cs2mesh::derivative_bound(data_->terms[i], order, box);
    if (sum == kInfinity) return sum;
  }
  for (const FarField& far : data_->far) sum += far.derivative_bound(order, box);
  return sum;
}

}  // namespace cs2mesh
