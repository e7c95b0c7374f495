#include "libfield/field/field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

#include "libfield/field/far_field.h"
#include "libfield/field/log_sum.h"
#include "libfield/field/slope_program.h"
#include "libfield/field/term_bounds.h"
#include "libfield/integral/bulk.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kThreshold = 1.0;
/// Terms of a far field below this do not colour a point.
constexpr double kLeastShare = 1e-4;
constexpr std::size_t kManyTerms = 4096;
/// A restriction looks through so few terms one by one; more are found in the tree of all.
constexpr std::size_t kFewCandidates = 64;

/// The block lattice spans the bounds of the surface; beyond it, every term counts.
struct BlockLattice {
  Aabb domain;
  double edge = 1.0;

  bool covers(const Vec3d& p) const { return domain.contains(p); }
  /// ceil - 1: a point on a shared face belongs to the lower block.
  long index(double x, double origin) const {
    return static_cast<long>(std::ceil((x - origin) / edge)) - 1;
  }
  Aabb block(const Vec3d& p) const {
    Aabb box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<double>(index(p[axis], domain.min[axis]));
      // A hair larger than the block, so that rounding of a face never loses a term.
      box.min[axis] = domain.min[axis] + (i - 1e-9) * edge;
      box.max[axis] = domain.min[axis] + (i + 1 + 1e-9) * edge;
    }
    return box;
  }
  /// The union of the blocks that meet `box`.
  Aabb snapped(const Aabb& box) const {
    Aabb all = block(domain.clamp(box.min));
    all.include(block(domain.clamp(box.max)));
    return all;
  }
};

/// The number of blocks along the diagonal of the bounds: enough that a block holds few terms.
double blocks_along_diagonal(std::size_t terms) {
  return std::clamp(8 * std::cbrt(static_cast<double>(terms)), 16.0, 512.0);
}

}  // namespace

struct FieldData {
  /// Those of far fields come last.
  std::vector<Term> terms;
  std::size_t plain_count = 0;  ///< of the others
  std::vector<FarField> far;    ///< at most one an exponent
  /// The first of the terms: points as they are, kernel by kernel.
  std::vector<PointSource> points;
  /// Where the points of each kernel begin, and where the last ones end.
  std::array<std::uint32_t, kAllKernels.size() + 1> point_begin{};
  double error_budget = 0.0;
  Aabb bounds;
  bool in_exponents = false;  ///< all terms have has_log_bounds()
  BoxTree reach;              ///< where each plain term's influence exceeds its share of the budget
  BlockLattice lattice;
};

namespace {

bool is_plain_point(const Term& term) {
  return std::holds_alternative<Point>(term.primitive) && !term.to_local && term.profiles.empty();
}

/// From so many terms on whose kernel reaches everywhere, they go into a far field.
constexpr std::size_t kFewestFar = 256;

/// Whether a term with that far exponent is to go into a far field.
class FarKinds {
 public:
  explicit FarKinds(const std::vector<Term>& terms) {
    for (const Term& term : terms) {
      if (far_element(term, 0)) ++count_[*far_exponent(term.kernel)];
    }
  }
  bool holds(const Term& term) const {
    if (!far_element(term, 0)) return false;
    return count_.at(*far_exponent(term.kernel)) >= kFewestFar;
  }

 private:
  std::map<double, std::size_t> count_;
};

/// Plain points first, those of far fields last; equal kinds together: one dispatch serves a run of
/// points, and its branches stay predicted. Returns the number that are not of far fields.
std::size_t sort_by_kind(std::vector<Term>& terms) {
  const FarKinds far(terms);
  using Kind = std::tuple<bool, bool, std::size_t, std::size_t>;
  std::vector<std::pair<Kind, std::size_t>> order;
  order.reserve(terms.size());
  for (const Term& term : terms) {
    order.push_back(
        {{far.holds(term), !is_plain_point(term), term.kernel.index(), term.primitive.index()},
         order.size()});
  }
  if (!std::is_sorted(order.begin(), order.end())) {
    std::sort(order.begin(), order.end());
    std::vector<Term> sorted;
    sorted.reserve(terms.size());
    for (const auto& [kind, i] : order) sorted.push_back(std::move(terms[i]));
    terms = std::move(sorted);
  }
  const auto first_far =
      std::find_if(order.begin(), order.end(), [](const auto& o) { return std::get<0>(o.first); });
  return static_cast<std::size_t>(first_far - order.begin());
}

void collect_points(FieldData& data) {
  for (const Term& term : std::span(data.terms).first(data.plain_count)) {
    if (!is_plain_point(term)) break;
    data.points.push_back(point_source(term.kernel, std::get<Point>(term.primitive), term.sign));
    ++data.point_begin[term.kernel.index() + 1];
  }
  std::partial_sum(data.point_begin.begin(), data.point_begin.end(), data.point_begin.begin());
}

template <class Out>
void add_values_or_jets(const FieldData& data, std::span<const std::uint32_t> list,
                        std::span<const Vec3d> points, std::span<Out> sums) {
  auto first = list.begin();
  for (std::size_t kernel = 0; kernel < kAllKernels.size(); ++kernel) {
    const auto last = std::lower_bound(first, list.end(), data.point_begin[kernel + 1]);
    if (first == last) continue;
    bulk_table().point_row<Out>()[kernel](data.points.data(), &*first,
                                          static_cast<std::size_t>(last - first), points.data(),
                                          sums.data(), points.size());
    first = last;
  }
  for (; first != list.end(); ++first) accumulate(data.terms[*first], points, sums);
}

/// Adds the terms of `list`, in ascending order, at each of the points.
template <class Out>
void add_terms(const FieldData& data, std::span<const std::uint32_t> list,
               std::span<const Vec3d> points, std::span<Out> sums) {
  if constexpr (std::is_same_v<Out, Symmetric3>) {
    for (const std::uint32_t i : list) accumulate(data.terms[i], points, sums);
  } else {
    add_values_or_jets(data, list, points, sums);
  }
}

Aabb surface_bounds(const FieldData& data) {
  // Outside the union of the boxes, each positive term stays under its share of T, and those of the
  // far fields together under theirs.
  const std::span terms(data.terms);
  const auto is_positive = [](const Term& term) { return term.sign > 0; };
  const auto positive = static_cast<double>(std::count_if(terms.begin(), terms.end(), is_positive));
  const double share = kThreshold / positive * (1 - 1e-9);
  Aabb box;
  for (const Term& term : terms.first(data.plain_count)) {
    if (term.sign < 0) continue;
    box.include(skeleton_box(term).grown(influence_distance(term, share)));
  }
  std::map<double, std::pair<double, double>> mass_and_count;  // by exponent
  Aabb far;
  for (const Term& term : terms.subspan(data.plain_count)) {
    if (term.sign < 0) continue;
    auto& [mass, count] = mass_and_count[*far_exponent(term.kernel)];
    mass += far_element(term, 0)->mass();
    ++count;
    far.include(skeleton_box(term));
  }
  for (const auto& [two_nu, sum] : mass_and_count) {
    // mass d^(-2 nu) <= count share.
    const double d = std::pow(sum.first / (sum.second * share), 1 / two_nu) * (1 + 1e-9);
    box.include(far.grown(d));
  }
  return box;
}

/// Where the far fields are fast: with some room around the surface.
void collect_far_fields(FieldData& data) {
  std::map<double, std::vector<FarElement>> elements;
  for (std::size_t i = data.plain_count; i < data.terms.size(); ++i) {
    const Term& term = data.terms[i];
    elements[*far_exponent(term.kernel)].push_back(
        *far_element(term, static_cast<std::uint32_t>(i)));
  }
  // Terms that are left out and approximations share the budget.
  const double budget =
      0.5 * data.error_budget / std::max<double>(1.0, static_cast<double>(elements.size()));
  for (auto& [two_nu, list] : elements) {
    Aabb domain = data.bounds;
    if (!domain.finite()) {  // as with a plane
      domain = {};
      for (const FarElement& element : list) domain.include(element.box());
      domain = domain.grown(0.5 * domain.diagonal());
    }
    domain = domain.grown(0.1 * domain.diagonal());
    data.far.emplace_back(two_nu, std::move(list), data.terms, domain, budget);
  }
}

}  // namespace

Field::Field(std::vector<Term> terms, double error_budget) {
  require(!terms.empty(), "a field needs terms");
  require(error_budget > 0, "the error budget must be positive");
  auto data = std::make_shared<FieldData>();
  data->plain_count = sort_by_kind(terms);
  data->terms = std::move(terms);
  collect_points(*data);
  data->error_budget = error_budget;
  data->bounds = surface_bounds(*data);

  const double share = (data->plain_count < data->terms.size() ? 0.5 : 1.0) * error_budget /
                       std::max<double>(1.0, static_cast<double>(data->plain_count));
  std::vector<Aabb> reach;
  reach.reserve(data->plain_count);
  for (const Term& term : std::span(data->terms).first(data->plain_count)) {
    reach.push_back(skeleton_box(term).grown(influence_distance(term, share)));
  }
  data->reach = BoxTree(std::move(reach));
  if (data->bounds.finite()) {
    data->lattice.edge = data->bounds.diagonal() / blocks_along_diagonal(data->plain_count);
    data->lattice.domain = data->bounds.grown(data->lattice.edge);
  }
  data->in_exponents = std::all_of(data->terms.begin(), data->terms.end(), has_log_bounds);
  collect_far_fields(*data);
  data_ = std::move(data);
}

std::size_t Field::term_count() const {
  return data_->terms.size();
}
Aabb Field::bounds() const {
  return data_->bounds;
}

void Field::near_terms(const Aabb& box, std::vector<std::uint32_t>& found) const {
  found.clear();
  // Within its box, the tree finds a restriction nothing that is not a candidate.
  if (!restricted_ || candidates_.size() > kFewCandidates) {
    data_->reach.overlapping(box, found);
    std::sort(found.begin(), found.end());
    return;
  }
  for (const std::uint32_t i : candidates_) {
    if (data_->reach.box(i).overlaps(box)) found.push_back(i);
  }
}

template <class Out>
void Field::evaluate(std::span<const Vec3d> points, std::span<Out> out) const {
  const BlockLattice& lattice = data_->lattice;
  const auto add = [&](const std::vector<std::uint32_t>& list, std::size_t first, std::size_t n) {
    add_terms<Out>(*data_, list, points.subspan(first, n), out.subspan(first, n));
  };
  for (const FarField& far : data_->far) far.add(points, out);
  if (data_->plain_count == 0) return;
  if (uniform_) return add(candidates_, 0, points.size());

  // Each run of points in one block shares that block's list.
  std::vector<std::uint32_t> list;
  for (std::size_t first = 0; first < points.size();) {
    const bool covered = lattice.covers(points[first]);
    const Aabb block =
        covered ? lattice.block(points[first])
                : Aabb{{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
    std::size_t last = first + 1;
    while (last < points.size() && lattice.covers(points[last]) == covered &&
           (!covered || lattice.block(points[last]) == block)) {
      ++last;
    }
    near_terms(block, list);
    add(list, first, last - first);
    first = last;
  }
}

void Field::jets(std::span<const Vec3d> points, std::span<Jet> out) const {
  require(points.size() == out.size(), "one jet a point");
  std::fill(out.begin(), out.end(), Jet{-kThreshold, {}});
  evaluate(points, out);
}

void Field::values(std::span<const Vec3d> points, std::span<double> out) const {
  require(points.size() == out.size(), "one value a point");
  std::fill(out.begin(), out.end(), -kThreshold);
  evaluate(points, out);
}

void Field::second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const {
  require(points.size() == out.size(), "one jet a point");
  std::vector<Jet> first(points.size());
  jets(points, first);
  std::vector<Symmetric3> second(points.size());
  evaluate<Symmetric3>(points, second);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = {first[i].value, first[i].gradient, second[i]};
  }
}

void Field::full_jets(std::span<const Vec3d> points, std::span<Jet> out) const {
  require(points.size() == out.size(), "one jet a point");
  std::fill(out.begin(), out.end(), Jet{});
  std::vector<std::uint32_t> all(data_->terms.size());
  std::iota(all.begin(), all.end(), 0U);
  add_terms<Jet>(*data_, all, points, out);
}

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

void Field::enclose_each(std::span<const Aabb> boxes, std::span<Interval> out) const {
  require(boxes.size() == out.size(), "one interval a box");
  std::vector<BatchBox> batch(boxes.begin(), boxes.end());
  if (data_->in_exponents) return enclose_in_exponents(batch, out);
  std::vector<Enclosure> enclosures(boxes.size());
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

void Field::enclose_in_exponents(std::span<const BatchBox> boxes, std::span<Interval> out) const {
  const BoxBatch batch(boxes, TaylorOrder::first);
  require(boxes.empty() || batch.hull.finite(), "enclosures need finite boxes");
  std::vector<std::uint32_t> list;
  near_terms(batch.hull, list);
  const std::vector<LogSum> sums = LogSum::at_centers(data_->terms, list, boxes);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Interval log_range = sums[i].range(boxes[i]);
    const Interval range(std::exp(log_range.lo) * (1 - 1e-13),
                         std::exp(log_range.hi) * (1 + 1e-13));
    out[i] = widened(range - Interval(kThreshold), data_->error_budget);
  }
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
  std::vector<std::uint32_t> list;
  near_terms(box, list);
  const BatchBox one(box);
  if (data_->in_exponents) {
    return LogSum::at_centers(data_->terms, list, {&one, 1})[0].least_slope(one, direction);
  }
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

std::unique_ptr<ImplicitSurface> Field::restrict_to(const Aabb& box) const {
  std::unique_ptr<Field> part(new Field());
  part->data_ = data_;
  part->restricted_ = true;
  const BlockLattice& lattice = data_->lattice;
  if (!lattice.covers(box.min) || !lattice.covers(box.max)) {
    near_terms({{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}},
               part->candidates_);
    return part;
  }
  const Aabb blocks = lattice.snapped(box);
  near_terms(blocks, part->candidates_);
  part->uniform_ =
      lattice.block(box.min) == lattice.block(box.max) ||
      std::all_of(part->candidates_.begin(), part->candidates_.end(),
                  [&](std::uint32_t i) { return data_->reach.box(i).contains(blocks); });
  return part;
}

void Field::blend(std::span<const Vec3d> points, std::span<const Vec3d> property,
                  std::span<Vec3d> out) const {
  require(points.size() == out.size(), "one result a point");
  Aabb around;
  for (const Vec3d& p : points) around.include(p);
  std::vector<std::uint32_t> list;
  near_terms(around, list);
  for (const FarField& far : data_->far) far.collect(around, kLeastShare, list);
  std::fill(out.begin(), out.end(), Vec3d{});
  std::vector<double> total(points.size(), 0.0);
  std::vector<double> values(points.size());
  const auto property_of = [&](const Term& term) {
    const auto material = static_cast<std::size_t>(term.material);
    require(material < property.size(), "a term is of a material without the property");
    return property[material];
  };
  for (const std::uint32_t i : list) {
    const Term& term = data_->terms[i];
    std::fill(values.begin(), values.end(), 0.0);
    accumulate(term, points, std::span(values));
    const Vec3d own = property_of(term);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double share = std::max(values[k], 0.0);
      out[k] += share * own;
      total[k] += share;
    }
  }
  const Vec3d fallback = property_of(data_->terms.front());
  for (std::size_t k = 0; k < points.size(); ++k) {
    out[k] = total[k] > 0 ? out[k] / total[k] : fallback;
  }
}

void Field::shares(const Vec3d& point, std::vector<MaterialShare>& shares) const {
  shares.clear();
  std::vector<std::uint32_t> list;
  near_terms({point, point}, list);
  for (const FarField& far : data_->far) far.collect({point, point}, kLeastShare, list);
  double total = 0;
  const auto add = [&shares](int material, double weight) {
    for (MaterialShare& share : shares) {
      if (share.material == material) {
        share.share += weight;
        return;
      }
    }
    shares.push_back({material, weight});
  };
  for (const std::uint32_t i : list) {
    const Term& term = data_->terms[i];
    Jet jet;
    accumulate(term, {&point, 1}, {&jet, 1});
    if (!(jet.value > 0)) continue;
    add(term.material, jet.value);
    total += jet.value;
  }
  if (!(total > 0)) {
    shares.assign(1, {data_->terms.front().material, 1.0});
    return;
  }
  for (MaterialShare& share : shares) share.share /= total;
}

}  // namespace cs2mesh
