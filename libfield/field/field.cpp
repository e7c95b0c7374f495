#include "libfield/field/field.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

#include "libfield/field/far_field.h"
#include "libfield/field/field_data.h"
#include "libfield/field/log_hull.h"
#include "libfield/field/log_sum.h"
#include "libfield/field/near_sum.h"
#include "libfield/field/term_bounds.h"
#include "libfield/integral/bulk.h"

namespace cs2mesh {
namespace {

/// Terms of a far field below this do not colour a point.
constexpr double kLeastShare = 1e-4;
/// A restriction looks through so few terms one by one; more are found in the tree of all.
constexpr std::size_t kFewCandidates = 1024;

/// The number of blocks along the diagonal of the bounds: enough that a block holds few terms.
double blocks_along_diagonal(std::size_t terms) {
  return std::clamp(8 * std::cbrt(static_cast<double>(terms)), 16.0, 512.0);
}

bool is_plain_point(const Term& term) {
  return std::holds_alternative<Point>(term.primitive) && !term.to_local && term.profiles.empty();
}

/// From so many terms on whose kernel reaches everywhere, they go into a far field; triangles,
/// which take longer, count as more.
constexpr std::size_t kFewestFar = 256, kTriangleCount = 8;

/// Whether a term with that far exponent is to go into a far field.
class FarKinds {
 public:
  explicit FarKinds(const std::vector<Term>& terms) {
    for (const Term& term : terms) {
      const std::optional<FarElement> element = far_element(term, 0);
      if (!element) continue;
      count_[*far_exponent(term.kernel)] += element->is_triangle() ? kTriangleCount : 1;
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

}  // namespace

void add_terms(const FieldData& data, std::span<const std::uint32_t> list,
               std::span<const Vec3d> points, std::span<Jet> sums) {
  add_values_or_jets(data, list, points, sums);
}

namespace {

/// The box of each term beyond which it is at most `share`.
std::vector<Aabb> influence_boxes(std::span<const Term> terms, double share) {
  constexpr std::size_t kGrain = 512;
  std::vector<Aabb> boxes(terms.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, terms.size(), kGrain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i) {
                        boxes[i] =
                            skeleton_box(terms[i]).grown(influence_distance(terms[i], share));
                      }
                    });
  return boxes;
}

Aabb surface_bounds(const FieldData& data) {
  // Outside the union of the boxes, each positive term stays under its share of T, and those of the
  // far fields together under theirs.
  const std::span terms(data.terms);
  const auto is_positive = [](const Term& term) { return term.sign > 0; };
  const auto positive = static_cast<double>(std::count_if(terms.begin(), terms.end(), is_positive));
  const double share = kThreshold / positive * (1 - 1e-9);
  Aabb box;
  const std::vector<Aabb> boxes = influence_boxes(terms.first(data.plain_count), share);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (terms[i].sign > 0) box.include(boxes[i]);
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
  // Terms that are left out, where there are such, and approximations share the budget.
  const double budget = (data.plain_count > 0 ? 0.5 : 1.0) * data.error_budget /
                        std::max<double>(1.0, static_cast<double>(elements.size()));
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

/// Which way of bounding suits the terms.
void choose_bounds(FieldData& data) {
  constexpr std::size_t kFewTerms = 24, kMostNear = 5000;
  const std::size_t count = data.terms.size();
  const auto all = [&](const auto& has) {
    return std::all_of(data.terms.begin(), data.terms.end(), has);
  };
  // Tapered segments alone are bounded sooner as they are, than each as the rest of a sum.
  const auto tapered = static_cast<std::size_t>(std::count_if(
      data.terms.begin(), data.terms.end(),
      [](const Term& term) { return std::holds_alternative<TaperedSegment>(term.primitive); }));
  const bool few = count <= kFewTerms && 2 * tapered <= count;
  data.near_sums = !data.in_exponents && count <= kMostNear &&
                   (all(has_cheap_near_bounds) || (few && all(has_near_bounds)));
  data.cheap_bounds =
      data.in_exponents || data.near_sums ||
      (count <= kFewTerms && all([](const Term& term) { return term.profiles.empty(); }));
  data.cheap_hulls = data.plain_count == count && all(has_cheap_log_hull);
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
  data->reach = BoxTree(influence_boxes(std::span(data->terms).first(data->plain_count), share));
  if (data->bounds.finite()) {
    data->lattice.edge = data->bounds.diagonal() / blocks_along_diagonal(data->plain_count);
    data->lattice.domain = data->bounds.grown(data->lattice.edge);
  }
  data->positive = std::all_of(data->terms.begin(), data->terms.end(),
                               [](const Term& term) { return term.sign > 0; });
  data->in_exponents = std::all_of(data->terms.begin(), data->terms.end(), has_log_bounds);
  choose_bounds(*data);
  collect_far_fields(*data);
  data_ = std::move(data);
}

Field::Field() = default;
Field::~Field() = default;

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
  const auto add = [&](const std::vector<std::uint32_t>& list, std::size_t first, std::size_t n) {
    add_terms<Out>(*data_, list, points.subspan(first, n), out.subspan(first, n));
  };
  for (const FarField& far : data_->far) far.add(points, out);
  if (data_->plain_count == 0) return;
  if (uniform_) return add(candidates_, 0, points.size());

  // Each run of points in one block shares that block's list.
  std::vector<std::uint32_t> list;
  for (std::size_t first = 0; first < points.size();) {
    const Aabb block = data_->block_around(points[first]);
    std::size_t last = first + 1;
    while (last < points.size() && data_->block_around(points[last]) == block) ++last;
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

std::unique_ptr<ImplicitSurface> Field::restrict_to(const Aabb& box) const {
  std::unique_ptr<Field> part(new Field());
  part->data_ = data_;
  part->restricted_ = true;
  part->box_ = box;
  const BlockLattice& lattice = data_->lattice;
  if (!lattice.covers(box.min) || !lattice.covers(box.max)) {
    Aabb around = data_->block_around(box.min);
    around.include(data_->block_around(box.max));
    if (around.finite()) around.include(lattice.snapped(box));
    near_terms(around, part->candidates_);
    return part;
  }
  const Aabb blocks = lattice.snapped(box);
  near_terms(blocks, part->candidates_);
  if (data_->near_sums) {
    if (near_sum_ && near_sum_->box().contains(box)) {
      part->near_sum_ = std::make_shared<const LazyNearSum>(near_sum_, box);
    } else {
      std::vector<std::uint32_t> list = part->candidates_;
      for (std::size_t i = data_->plain_count; i < data_->terms.size(); ++i) {
        list.push_back(static_cast<std::uint32_t>(i));
      }
      part->near_sum_ = std::make_shared<const LazyNearSum>(data_->terms, std::move(list), box);
    }
  }
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
