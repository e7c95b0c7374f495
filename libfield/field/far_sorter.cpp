#include "libfield/field/far_sorter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>

#include "libfield/integral/bulk.h"
#include "libfield/integral/harmonics.h"

namespace cs2mesh {
namespace {

/// Of the budget of a cell, for one source.
constexpr double kGreatestShare = 1.0 / 32;
/// So many nodes are sorted several times sooner than the guess is put right by a part of them.
constexpr std::size_t kManyNodes = 64, kSampleStep = 8;
/// What an element of a leaf may leave open at first, as a multiple of its part of the budget.
constexpr double kLeafShare = 4.0;
/// No number of nodes will do for segments whose squared length, relative to their distance, is
/// greater.
constexpr double kLongest2 = 4.0;
/// The closed form of a triangle takes as long as so many nodes.
constexpr int kMostNodes = 30;
/// Elements of a node look alike where its radius is at most this part of the distance.
constexpr double kAlike = 1.0 / 10;
/// So few elements that none of them reaches the cell are looked at again by its children.
constexpr std::uint32_t kFewElements = 16;
/// So many elements are sorted one by one at once.
constexpr std::size_t kManyElements = 2048;

/// What rounding the middle of a near segment may change, as a part of the error budget: few are
/// steep in one place.
constexpr double kMovedPart = 1.0 / 32;

/// What that changes of the field of a Cauchy segment, anywhere: 4 x (1 + x^2)^-3 < 1.04.
double moved_middle(const SegmentSource& segment) {
  const double root = std::sqrt(segment.tau);
  const double steepest = 1.04 * std::abs(segment.weight) / (segment.tau * segment.tau * root) *
                          std::min(1.0, 0.5 * std::numbers::pi * root / norm(segment.half));
  return std::numeric_limits<double>::epsilon() * norm(segment.middle) * steepest;
}

/// c^2 of far_reach.h where nothing is moved, from 1 / S.
double corner_share2(double reach, double over) {
  return reach * reach * over * (1.0 / 3 * (1 + 1e-12));
}

}  // namespace

OctantErrors FarField::Sorter::sort(const std::vector<std::uint32_t>& nodes,
                                    const std::vector<std::uint32_t>& elements, double budget,
                                    double guess) {
  // What each may leave open is guessed; where the sum is too much, each has to do better.
  double each = budget * std::min(guess, kGreatestShare);
  if (nodes.size() >= kManyNodes) {
    sort_every(kSampleStep, nodes, elements, each);
    const double expected = static_cast<double>(kSampleStep) * greatest(errors_);
    each = std::min(each * std::min(2.0, 0.8 * budget / expected), budget * kGreatestShare);
  }
  for (;;) {
    sort_every(1, nodes, elements, each);
    const double error = greatest(errors_);
    if (error <= budget) break;
    each *= std::min(0.9, 0.85 * budget / error);
  }
  cell_.share = each / budget;
  sum_up();
  cell_.listed = 0;
  for (const std::uint32_t element : cell_.elements) {
    cell_.listed += field_.tree_.shape(element) == FarShape::triangle ? kTriangleWork : 1;
  }
  for (const std::uint32_t node : cell_.nodes) cell_.listed += field_.tree_.node(node).work();
  return errors_;
}

/// Sorts the first of every so many nodes and elements.
void FarField::Sorter::sort_every(std::size_t step, const std::vector<std::uint32_t>& nodes,
                                  const std::vector<std::uint32_t>& elements, double each) {
  clear();
  for (std::size_t i = 0; i < nodes.size(); i += step) sort_node(nodes[i], each);
  for (std::size_t i = 0; i < elements.size(); i += step) add_single(elements[i], each);
  sort_single(each);
}

void FarField::Sorter::clear() {
  for (auto& sources : clusters_) sources.clear();
  single_.clear(), taken_.clear(), taken_chords_.clear(), chords_.clear();
  cell_.nodes.clear(), cell_.elements.clear();
  errors_ = {};
}

void FarField::Sorter::sum_up() {
  std::array<SourceList, kTauOrders> lists;
  for (std::size_t j = 0; j < lists.size(); ++j) {
    std::stable_sort(clusters_[j].begin(), clusters_[j].end(),
                     [](const auto& a, const auto& b) { return a.order > b.order; });
    lists[j] = {field_.two_nu_ + 2.0 * static_cast<double>(j), clusters_[j]};
  }
  if (!clusters_[0].empty()) bulk_table().add_sources(lists, cell_.series.data());
  if (!taken_.empty() || !chords_.empty()) sum_up_elements();
}

void FarField::Sorter::sum_up_elements() {
  HarmonicSums sums{};
  if (!taken_.empty()) add_taken(taken_, field_.segments_.data(), sums);
  if (!chords_.empty()) {
    thread_local ChordSources sources;
    sources.set(chords_, field_.tree_.elements());
    add_taken(taken_chords_, sources.sources().data(), sums);
  }
  add_harmonics(sums, cell_.series);
}

/// By rule, then by falling order, then in the order in which they were taken.
void FarField::Sorter::add_taken(std::span<const Taken> all, const SegmentSource* sources,
                                 HarmonicSums& sums) const {
  constexpr std::size_t orders = kTaylorOrder + 1;
  const auto place = [&](const Taken& taken) {
    return orders * taken.choice.rule + (orders - 1 - taken.choice.order);
  };
  std::array<std::uint32_t, orders * kNodeRules.size() + 1> begin{};
  for (const Taken& taken : all) ++begin[place(taken) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> elements(all.size());
  std::vector<std::uint8_t> degrees(all.size());
  auto next = begin;
  for (const Taken& taken : all) {
    const std::uint32_t to = next[place(taken)]++;
    elements[to] = taken.element;
    degrees[to] = taken.choice.order;
  }

  NodeLists lists;
  for (std::size_t rule = 0; rule < lists.size(); ++rule) {
    const std::uint32_t first = begin[orders * rule];
    const std::uint32_t count = begin[orders * (rule + 1)] - first;
    lists[rule] = {std::span(elements).subspan(first, count),
                   std::span(degrees).subspan(first, count)};
  }
  bulk_table().add_nodes(field_.two_nu_, {cell_.center, cell_.half}, sources, lists, sums.data());
}

void FarField::Sorter::finish(double budget) {
  std::vector<std::uint32_t> all, segments, triangles;
  field_.visit_unresolved(cell_, [&](std::uint32_t element) { all.push_back(element); });
  std::sort(all.begin(), all.end());
  cell_.points.clear(), cell_.near.clear(), cell_.lines.clear();
  for (const std::uint32_t element : all) {
    const FarShape shape = field_.tree_.shape(element);
    (shape == FarShape::triangle  ? triangles
     : shape == FarShape::segment ? segments
                                  : cell_.points)
        .push_back(element);
  }
  const double each =
      budget / static_cast<double>(std::max<std::size_t>(segments.size() + triangles.size(), 1));
  finish_segments(segments, each * static_cast<double>(segments.size()));
  finish_triangles(triangles, each * static_cast<double>(triangles.size()));
}

void FarField::Sorter::finish_segments(const std::vector<std::uint32_t>& segments, double budget) {
  if (segments.empty()) return;
  std::vector<std::uint8_t> choices(segments.size());
  double most = budget * kLeafShare / static_cast<double>(segments.size());
  for (;;) {
    double error = bulk_table().choose_nodes(field_.law_, {cell_.center, cell_.half, most},
                                             field_.segments_.data(), segments.data(),
                                             segments.size(), choices.data());
    cell_.lines.clear(), cell_.near.clear();
    for (std::size_t i = 0; i < segments.size(); ++i) {
      if (choices[i] == 0) error += list_near(segments[i], most);
    }
    if (error <= budget) break;
    most *= std::min(0.9, 0.85 * budget / error);
  }
  for (auto& some : cell_.segments) some.clear();
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (choices[i] > 0) cell_.segments[choices[i] - 1U].push_back(segments[i]);
  }
}

/// Lists a segment to be summed by its closed form in packs, if what rounding leaves open of that
/// is at most `each`, else exactly, as far from the origin. Returns the error.
double FarField::Sorter::list_near(std::uint32_t segment, double each) {
  if (field_.two_nu_ == 4.0) {
    const SegmentSource& source = field_.segments_[segment];
    const double rounding = line_rounding(source, field_.reach_);
    if (rounding <= each && moved_middle(source) <= kMovedPart * field_.error_budget_) {
      cell_.lines.push_back(segment);
      return rounding;
    }
  }
  cell_.near.push_back(segment);
  return 0.0;
}

void FarField::Sorter::finish_triangles(const std::vector<std::uint32_t>& triangles,
                                        double budget) {
  if (triangles.empty()) return;
  const std::size_t segments = cell_.near.size();
  double most = budget * kLeafShare / static_cast<double>(triangles.size());
  for (;;) {
    cell_.near.resize(segments), cell_.triangles.clear();
    for (auto& chords : cell_.chords) chords.clear();
    double error = 0.0;
    for (const std::uint32_t index : triangles) {
      const FarElement& triangle = field_.tree_.elements()[index];
      const double d2 = squared_distance(triangle, cell_.center);
      error += list_triangle(index, nearest2(d2, triangle.tau), most);
    }
    if (error <= budget) return;
    most *= std::min(0.9, 0.85 * budget / error);
  }
}

void FarField::Sorter::sort_node(std::uint32_t index, double each) {
  const SourceNode& node = field_.tree_.node(index);
  if (field_.tree_.has_moments(index)) {
    const Vec3d d = cell_.center - node.center;
    const double s = squared_norm(d) + node.tau;
    const double q = (node.radius + cell_.radius()) / std::sqrt(s);
    if (q < 1.0 && take_cluster(index, d, s, q, each)) return;
    if (node.radius < 0.5 * cell_.radius()) {
      cell_.nodes.push_back(index);  // a child may find it far
      return;
    }
  }
  const bool few = node.right == 0 || !field_.tree_.has_moments(node.right);
  const Reach reach = few ? take_elements(index, each) : Reach::mixed;
  if (reach == Reach::far) return;
  if (reach == Reach::near && node.count <= kFewElements) {
    cell_.nodes.push_back(index);
  } else if (node.right != 0) {
    sort_node(index + 1, each);
    sort_node(node.right, each);
  } else {
    for (std::uint32_t i = 0; i < node.count; ++i) add_single(node.first + i, each);
  }
}

/// Takes all elements of a node, if they look alike from the cell and the error of each can be had
/// under `each`. `near` if they are few and that of none can.
FarField::Sorter::Reach FarField::Sorter::take_elements(std::uint32_t index, double each) {
  const SourceNode& node = field_.tree_.node(index);
  const Vec3d d = cell_.center - node.center;
  const double apart = norm(d), r = cell_.radius();
  // Chords differ from triangle to triangle.
  const bool alike = node.radius <= kAlike * apart && node.triangles == 0;
  const bool few = node.count <= kFewElements;
  if (!alike && !few) return Reach::mixed;
  const std::array<double, kOctantPairs> reach = octant_reach(d);
  const double farthest_reach = greatest(reach);
  const FarRemainders& remainders = field_.remainders_[0];
  const double most = 0.5 * each;
  if (few) {
    const double farthest = apart + node.radius;
    const double over = 1 / (farthest * farthest + node.tau + node.tau_spread);
    const double lightest = node.mass / node.count * half_power(field_.two_nu_, over);
    const double c2 = corner_share2(farthest_reach, over);
    if (lightest * remainders.least(r * r * over, c2) > most) return Reach::near;
    if (!alike) return Reach::mixed;
  }
  const double nearest = apart - node.radius;
  const double over = 1 / (nearest * nearest + node.least_tau);
  const double heaviest = node.heaviest * half_power(field_.two_nu_, over);
  const auto share2 = [&](double some) {
    return corner_share2(some + 1.7320508075688774 * node.radius, over);
  };
  const Truncation cut =
      remainders.lowest_order(r * r * over, share2(farthest_reach), most / heaviest);
  if (!(heaviest * cut.error <= most)) return Reach::mixed;
  const double near = std::max(0.0, nearest - r);
  const auto rule = rule_for(node.longest, node.heaviest, near * near + node.least_tau, most);
  if (!rule) return Reach::mixed;
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
    const bool segment = field_.tree_.shape(i) == FarShape::segment;
    taken_.push_back({i,
                      {static_cast<std::uint8_t>(kFarOrders[cut.order]),
                       static_cast<std::uint8_t>(segment ? rule->entry : 0)}});
  }
  for (std::size_t k = 0; k < kOctantPairs; ++k) {
    const double error = remainders.error(cut.order, r * r * over, share2(reach[k]));
    errors_[k] += node.mass / node.heaviest * (heaviest * error + rule->error);
  }
  return Reach::far;
}

/// c of far_remainders.h: for x in the cell, moved by up to `radius`, |d.x| / sqrt(S) relative to
/// the greatest |x|; `reach` as octant_reach().
double FarField::Sorter::corner_share(double reach, double s, double radius) const {
  return (cell_.half * reach / std::sqrt(s) + radius) / (cell_.radius() + radius) * (1 + 1e-12);
}

/// Adds a cluster to the sources, if its error can be had under `each`. Where the tau of its
/// elements differ, (S + t)^-nu = sum binomial(-nu, j) t^j S^(-nu - j): a series in space for each
/// of kTauOrders powers of t, and the rest of that sum.
bool FarField::Sorter::take_cluster(std::uint32_t index, const Vec3d& d, double s, double q,
                                    double each) {
  const SourceNode& node = field_.tree_.node(index);
  const double power = inverse_power(field_.two_nu_, s);
  const double size = node.mass * power;
  const double spread = node.tau_spread / s, nu = 0.5 * field_.two_nu_;
  const int sets = spread > 0 ? kTauOrders : 1;
  const double share = each / (size * (sets > 1 ? sets + 1 : 1));
  const double rest = sets > 1 ? spread_remainder(q, spread) : 0.0;
  if (!(rest <= share)) return false;

  const std::array<double, kOctantPairs> reach = octant_reach(d);
  const double c = corner_share(greatest(reach), s, node.radius);
  std::array<Truncation, kTauOrders> truncation;
  double weight = 1.0;  // |binomial(-nu, j)| spread^j
  for (int j = 0; j < sets; ++j) {
    auto& cut = truncation[static_cast<std::size_t>(j)];
    cut =
        field_.remainders_[static_cast<std::size_t>(j)].lowest_order(q * q, c * c, share / weight);
    if (!(weight * cut.error <= share)) return false;
    weight *= spread * (nu + j) / (j + 1);
  }

  for (std::size_t k = 0; k < kOctantPairs; ++k) {
    const double side = corner_share(reach[k], s, node.radius);
    double error = rest;
    weight = 1.0;
    for (int j = 0; j < sets; ++j) {
      const auto i = static_cast<std::size_t>(j);
      error += weight * field_.remainders_[i].error(truncation[i].order, q * q, side * side);
      weight *= spread * (nu + j) / (j + 1);
    }
    errors_[k] += size * error;
  }
  double factor = power;
  const double unit = 1 / cell_.half;
  for (int j = 0; j < sets; ++j) {
    const auto k = static_cast<std::size_t>(j);
    clusters_[k].push_back({unit * d, s * unit * unit, factor, field_.tree_.moments(index, j),
                            unit * node.radius, kFarOrders[truncation[k].order]});
    factor *= -(nu + j) / (j + 1) * spread;
  }
  return true;
}

/// What the powers of t from kTauOrders on add up to at most, relative to a cluster's mass S^-nu.
double FarField::Sorter::spread_remainder(double q, double spread) const {
  const double nu = 0.5 * field_.two_nu_;
  double weight = 1.0;
  for (int j = 0; j < kTauOrders; ++j) weight *= spread * (nu + j) / (j + 1);
  const double nearest = (1 - q) * (1 - q);  // of |d + x|^2 + tau, relative to S
  const double ratio = spread / nearest * std::max(1.0, (nu + kTauOrders) / (kTauOrders + 1));
  if (!(ratio < 1)) return std::numeric_limits<double>::infinity();
  double power = half_power(field_.two_nu_, nearest);
  for (int j = 0; j < kTauOrders; ++j) power *= nearest;
  return weight / (power * (1 - ratio)) * (1 + 1e-12);
}

/// Many are sorted at once, but no more than stay at hand.
void FarField::Sorter::add_single(std::uint32_t element, double each) {
  single_.push_back(element);
  if (single_.size() == kManyElements) sort_single(each);
}

/// Sorts the elements that wait to be sorted one by one.
void FarField::Sorter::sort_single(double each) {
  if (field_.tree_.node(0).triangles > 0) {
    const auto is_triangle = [&](std::uint32_t index) {
      return field_.tree_.shape(index) == FarShape::triangle;
    };
    const auto first =
        std::stable_partition(single_.begin(), single_.end(), std::not_fn(is_triangle));
    for (auto triangle = first; triangle != single_.end(); ++triangle) {
      sort_triangle(*triangle, each);
    }
    single_.erase(first, single_.end());
  }
  choices_.resize(single_.size());
  bulk_table().choose_far(field_.law_, {cell_.center, cell_.half, 0.5 * each},
                          field_.segments_.data(), single_.data(), single_.size(), choices_.data(),
                          errors_);
  for (std::size_t i = 0; i < single_.size(); ++i) {
    if (choices_[i].order == 0) {
      cell_.elements.push_back(single_[i]);
    } else {
      taken_.push_back({single_[i], choices_[i]});
    }
  }
  single_.clear();
}

void FarField::Sorter::sort_triangle(std::uint32_t index, double each) {
  const FarElement& element = field_.tree_.elements()[index];
  const double d2 = squared_distance(element, cell_.center);
  const double over = 1 / (d2 + element.tau);
  const double size = element.mass() * half_power(field_.two_nu_, over);
  // Of all places on the triangle, as it is convex.
  std::array<double, kOctantPairs> reach{};
  for (const Vec3d& vertex : {element.a, element.b, element.apex}) {
    const std::array<double, kOctantPairs> own = octant_reach(cell_.center - vertex);
    for (std::size_t k = 0; k < kOctantPairs; ++k) reach[k] = std::max(reach[k], own[k]);
  }
  const double q2 = cell_.radius() * cell_.radius() * over, most = 0.5 * each;
  const FarRemainders& remainders = field_.remainders_[0];
  const Truncation cut =
      remainders.lowest_order(q2, corner_share2(greatest(reach), over), most / size);
  std::optional<ChordChoice> chords;
  if (size * cut.error <= most) {
    chords = chords_for(element, nearest2(d2, element.tau), field_.law_.rules, most);
  }
  if (!chords) {
    cell_.elements.push_back(index);
    return;
  }
  for (std::size_t k = 0; k < kOctantPairs; ++k) {
    errors_[k] +=
        size * remainders.error(cut.order, q2, corner_share2(reach[k], over)) + chords->error;
  }
  take_triangle(index, cut.order, *chords);
}

void FarField::Sorter::take_triangle(std::uint32_t index, std::size_t order,
                                     const ChordChoice& choice) {
  const int count = kChordCounts[choice.rule];
  for (int j = 0; j < count; ++j) {
    taken_chords_.push_back(
        {static_cast<std::uint32_t>(chords_.size()),
         {static_cast<std::uint8_t>(kFarOrders[order]),
          static_cast<std::uint8_t>(choice.nodes[static_cast<std::size_t>(j)] + 1)}});
    chords_.push_back(
        {index, static_cast<std::uint16_t>(choice.rule), static_cast<std::uint16_t>(j)});
  }
}

/// Lists a triangle to be summed from squared distance s on as what takes least time of what has an
/// error of at most `each`; returns that error.
double FarField::Sorter::list_triangle(std::uint32_t index, double s, double each) {
  const auto choice = chords_for(field_.tree_.elements()[index], s, field_.law_.sums, each);
  const double rounding = field_.rounding_of(index);
  if (rounding <= each && (!choice || choice->total > kMostNodes)) {
    cell_.triangles.push_back(*field_.triangle_number_[index]);
    return rounding;
  }
  if (choice) {
    const int count = kChordCounts[choice->rule];
    for (int j = 0; j < count; ++j) {
      cell_.chords[choice->nodes[static_cast<std::size_t>(j)]].push_back(
          {index, static_cast<std::uint16_t>(choice->rule), static_cast<std::uint16_t>(j)});
    }
    return choice->error;
  }
  cell_.near.push_back(index);
  return 0.0;
}

/// <= |x - q|^2 + tau for x in the cell and q at squared distance d2 or more from its centre.
double FarField::Sorter::nearest2(double d2, double tau) const {
  const double nearest = std::max(0.0, std::sqrt(d2) - cell_.radius());
  return nearest * nearest + tau;
}

/// By which rule segments up to that length and mass may be taken from squared distance s on; none
/// if the error of no number of nodes is at most `most`.
std::optional<FarField::Sorter::Rule> FarField::Sorter::rule_for(double length, double mass,
                                                                 double s, double most) const {
  if (!(length > 0)) return Rule{};
  const std::optional<Rule> found = nodes_for(length, mass, s, field_.law_.rules, most);
  if (!found) return std::nullopt;
  return Rule{found->entry + 1, found->error};
}

/// By which entry of a list of rules segments up to that length and mass may be taken likewise.
std::optional<FarField::Sorter::Rule> FarField::Sorter::nodes_for(double length, double mass,
                                                                  double s,
                                                                  std::span<const NodeBound> counts,
                                                                  double most) const {
  if (!(length * length <= kLongest2 * s)) return std::nullopt;
  const double two_nu = field_.two_nu_, y = node_ellipse(0.5 * length, std::sqrt(s));
  const double size = mass * inverse_power(two_nu, s);  // rho H >= 2 sqrt(s)
  double power = 1.0;
  int power_of = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const NodeBound& bound = counts[i];
    for (; power_of < bound.nodes; ++power_of) power *= y;
    const NodeError<double> here(two_nu, bound, y, power);
    const double error = size * here.over / here.under * (1 + 1e-12);
    if (here.under > 0 && error <= most) return Rule{i, error};
  }
  return std::nullopt;
}

/// As how few chords, each of as few nodes (one of the counts), a triangle may be summed from
/// squared distance s on; none if the error of no number is at most `most`.
std::optional<FarField::Sorter::ChordChoice> FarField::Sorter::chords_for(
    const FarElement& triangle, double s, std::span<const NodeBound> counts, double most) const {
  const double length2 = triangle.length * triangle.length;
  if (length2 > kLongest2 * s) return std::nullopt;
  const double mass = triangle.mass(), ratio = length2 / s;
  const double size = mass * half_power(field_.two_nu_, 1 / s);
  ChordChoice choice;
  double power = 1.0;
  int power_of = 0;
  for (;; ++choice.rule) {
    if (choice.rule == kChordCounts.size()) return std::nullopt;
    for (; power_of < kChordCounts[choice.rule]; ++power_of) power *= ratio;
    choice.error = size * field_.chord_factors_[choice.rule] * power;
    if (choice.error <= 0.5 * most) break;
  }
  const double base = norm(triangle.b - triangle.a);
  std::size_t j = 0;
  for (const Chord& chord : chord_rule(choice.rule)) {
    const auto nodes =
        nodes_for(chord.at * base, chord.part * mass, s, counts, 0.5 * most * chord.part);
    if (!nodes) return std::nullopt;
    choice.nodes[j++] = static_cast<std::uint8_t>(nodes->entry);
    choice.total += counts[nodes->entry].nodes;
    choice.error += nodes->error;
  }
  return choice;
}

}  // namespace cs2mesh
