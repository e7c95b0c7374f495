#include "libfield/field/far_sorter.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

/// |d_x| + |d_y| + |d_z|.
double sum_of_sizes(const Vec3d& d) {
  return std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
}

}  // namespace

double FarField::Sorter::sort(const std::vector<std::uint32_t>& nodes,
                              const std::vector<std::uint32_t>& elements, double budget,
                              double guess) {
  // What each may leave open is guessed; where the sum is too much, each has to do better.
  double each = budget * std::min(guess, kGreatestShare);
  if (nodes.size() >= kManyNodes) {
    sort_every(kSampleStep, nodes, elements, each);
    const double expected = static_cast<double>(kSampleStep) * error_;
    each = std::min(each * std::min(2.0, 0.8 * budget / expected), budget * kGreatestShare);
  }
  for (;;) {
    sort_every(1, nodes, elements, each);
    if (error_ <= budget) break;
    each *= std::min(0.9, 0.85 * budget / error_);
  }
  cell_.share = each / budget;
  sum_up();
  cell_.listed = 0;
  for (const std::uint32_t element : cell_.elements) {
    cell_.listed += field_.tree_.elements()[element].is_triangle() ? kTriangleWork : 1;
  }
  for (const std::uint32_t node : cell_.nodes) cell_.listed += field_.tree_.node(node).work();
  return error_;
}

/// Sorts the first of every so many nodes and elements.
void FarField::Sorter::sort_every(std::size_t step, const std::vector<std::uint32_t>& nodes,
                                  const std::vector<std::uint32_t>& elements, double each) {
  clear();
  for (std::size_t i = 0; i < nodes.size(); i += step) sort_node(nodes[i], each);
  for (std::size_t i = 0; i < elements.size(); i += step) sort_element(elements[i], each);
}

void FarField::Sorter::clear() {
  for (ByOrder& by_order : clusters_) {
    for (auto& sources : by_order) sources.clear();
  }
  taken_.clear(), taken_chords_.clear(), chords_.clear();
  cell_.nodes.clear(), cell_.elements.clear();
  error_ = 0.0;
}

void FarField::Sorter::sum_up() {
  const BulkTable& table = bulk_table();
  for (std::size_t i = 0; i < kFarOrders.size(); ++i) {
    for (std::size_t j = 0; j < clusters_.size(); ++j) {
      if (clusters_[j][i].empty()) continue;
      table.add_sources(field_.two_nu_ + 2.0 * static_cast<double>(j), kFarOrders[i],
                        clusters_[j][i].data(), clusters_[j][i].size(), cell_.series.data());
    }
  }
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
  constexpr std::size_t orders = kFarOrders.size();
  const auto place = [&](const Taken& taken) {
    return orders * taken.rule + (orders - 1 - taken.order);
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
    degrees[to] = static_cast<std::uint8_t>(kFarOrders[taken.order]);
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
  std::vector<std::uint32_t> all;
  field_.visit_unresolved(cell_, [&](std::uint32_t element) { all.push_back(element); });
  std::sort(all.begin(), all.end());
  double each = budget * kLeafShare / static_cast<double>(std::max<std::size_t>(all.size(), 1));
  for (;;) {
    cell_.near.clear(), cell_.points.clear(), cell_.triangles.clear();
    for (auto& segments : cell_.segments) segments.clear();
    for (auto& chords : cell_.chords) chords.clear();
    error_ = 0.0;
    for (const std::uint32_t element : all) {
      const FarElement& shape = field_.tree_.elements()[element];
      if (!(shape.length > 0)) {
        cell_.points.push_back(element);
        continue;
      }
      const double s = nearest2(squared_distance(shape, cell_.center), shape.tau);
      if (shape.is_triangle()) {
        list_triangle(element, s, each);
        continue;
      }
      const auto nodes = nodes_for(shape.length, shape.mass(), s, field_.sum_counts_, each);
      (nodes ? cell_.segments[nodes->entry] : cell_.near).push_back(element);
      error_ += nodes ? nodes->error : 0.0;
    }
    if (error_ <= budget) return;
    each *= std::min(0.9, 0.85 * budget / error_);
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
    for (std::uint32_t i = 0; i < node.count; ++i) sort_element(node.first + i, each);
  }
}

/// Takes all elements of a node, if they look alike from the cell and the error of each can be had
/// under `each`. `near` if they are few and that of none can.
FarField::Sorter::Reach FarField::Sorter::take_elements(std::uint32_t index, double each) {
  const SourceNode& node = field_.tree_.node(index);
  const Vec3d d = cell_.center - node.center;
  const double apart = norm(d), r = cell_.radius();
  const double l1 = sum_of_sizes(d);
  const FarRemainders& remainders = field_.remainders_[0];
  const double most = 0.5 * each;
  if (node.count <= kFewElements) {
    const double farthest = apart + node.radius;
    const double over = 1 / (farthest * farthest + node.tau + node.tau_spread);
    const double lightest = node.mass / node.count * half_power(field_.two_nu_, over);
    const double c2 = corner_share2(l1, over);
    if (lightest * remainders.lowest_order(r * r * over, c2, most / lightest).error > most) {
      return Reach::near;
    }
  }
  // Chords differ from triangle to triangle.
  if (node.radius > kAlike * apart || node.triangles > 0) return Reach::mixed;
  const double nearest = apart - node.radius;
  const double over = 1 / (nearest * nearest + node.least_tau);
  const double heaviest = node.heaviest * half_power(field_.two_nu_, over);
  const double c2 = corner_share2(l1 + 1.7320508075688774 * node.radius, over);
  const Truncation cut = remainders.lowest_order(r * r * over, c2, most / heaviest);
  if (!(heaviest * cut.error <= most)) return Reach::mixed;
  const auto nodes =
      nodes_for(node.longest, node.heaviest, nearest2(nearest * nearest, node.least_tau),
                field_.rule_counts_, most);
  if (!nodes) return Reach::mixed;
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
    take_element(i, cut.order, nodes->entry);
  }
  error_ += node.mass / node.heaviest * (heaviest * cut.error + nodes->error);
  return Reach::far;
}

/// The square of corner_share() where nothing is moved, from 1 / S.
double FarField::Sorter::corner_share2(double l1, double over) {
  return l1 * l1 * over * (1.0 / 3 * (1 + 1e-12));
}

/// c of far_remainders.h: for x in the cell, moved by up to `radius`, |d.x| / sqrt(S) relative to
/// the greatest |x|, where the components of d add up to l1 in absolute value.
double FarField::Sorter::corner_share(double l1, double s, double radius) const {
  return (cell_.half * l1 / std::sqrt(s) + radius) / (cell_.radius() + radius) * (1 + 1e-12);
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
  double error = sets > 1 ? spread_remainder(q, spread) : 0.0;
  if (!(error <= share)) return false;

  const double c = corner_share(sum_of_sizes(d), s, node.radius);
  std::array<Truncation, kTauOrders> truncation;
  double weight = 1.0;  // |binomial(-nu, j)| spread^j
  for (int j = 0; j < sets; ++j) {
    auto& cut = truncation[static_cast<std::size_t>(j)];
    cut =
        field_.remainders_[static_cast<std::size_t>(j)].lowest_order(q * q, c * c, share / weight);
    if (!(weight * cut.error <= share)) return false;
    // Those of every other order, so that fewer stand alone.
    cut.order += static_cast<std::size_t>(kFarOrders[cut.order] % 2);
    error += weight * cut.error;
    weight *= spread * (nu + j) / (j + 1);
  }

  error_ += size * error;
  double factor = power;
  for (int j = 0; j < sets; ++j) {
    const auto k = static_cast<std::size_t>(j);
    add_source(clusters_[k][truncation[k].order], d, s, factor, field_.tree_.moments(index, j),
               node.radius);
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
  return weight / (std::pow(nearest, nu + kTauOrders) * (1 - ratio)) * (1 + 1e-12);
}

void FarField::Sorter::sort_element(std::uint32_t index, double each) {
  const FarElement& element = field_.tree_.elements()[index];
  const double d2 = squared_distance(element, cell_.center);
  const double over = 1 / (d2 + element.tau);
  const double size = element.mass() * half_power(field_.two_nu_, over);
  // Of all places on the element, as it is convex.
  const double l1 =
      std::max({sum_of_sizes(cell_.center - element.a), sum_of_sizes(cell_.center - element.b),
                element.is_triangle() ? sum_of_sizes(cell_.center - element.apex) : 0.0});
  const double q2 = cell_.radius() * cell_.radius() * over, most = 0.5 * each;
  const Truncation cut =
      field_.remainders_[0].lowest_order(q2, corner_share2(l1, over), most / size);
  const double error = size * cut.error;
  if (element.is_triangle()) {
    std::optional<ChordChoice> chords;
    if (error <= most) {
      chords = chords_for(element, nearest2(d2, element.tau), field_.rule_counts_, most);
    }
    if (!chords) {
      cell_.elements.push_back(index);
    } else {
      error_ += error + chords->error;
      take_triangle(index, cut.order, *chords);
    }
    return;
  }
  std::optional<Choice> nodes;
  if (error <= most) {
    nodes = nodes_for(element.length, element.mass(), nearest2(d2, element.tau),
                      field_.rule_counts_, most);
  }
  if (!nodes) {
    cell_.elements.push_back(index);
    return;
  }
  error_ += error + nodes->error;
  take_element(index, cut.order, nodes->entry);
}

/// By an entry of FarField::rule_counts_, if it is a segment.
void FarField::Sorter::take_element(std::uint32_t index, std::size_t order, std::size_t nodes) {
  const bool segment = field_.tree_.elements()[index].length > 0;
  taken_.push_back({index, static_cast<std::uint8_t>(order),
                    static_cast<std::uint8_t>(segment ? nodes + 1 : 0)});
}

void FarField::Sorter::take_triangle(std::uint32_t index, std::size_t order,
                                     const ChordChoice& choice) {
  const int count = kChordCounts[choice.rule];
  for (int j = 0; j < count; ++j) {
    taken_chords_.push_back(
        {static_cast<std::uint32_t>(chords_.size()), static_cast<std::uint8_t>(order),
         static_cast<std::uint8_t>(choice.nodes[static_cast<std::size_t>(j)] + 1)});
    chords_.push_back(
        {index, static_cast<std::uint16_t>(choice.rule), static_cast<std::uint16_t>(j)});
  }
}

/// Lists a triangle to be summed from squared distance s on as what takes least time of what has an
/// error of at most `each`.
void FarField::Sorter::list_triangle(std::uint32_t index, double s, double each) {
  const auto choice = chords_for(field_.tree_.elements()[index], s, field_.sum_counts_, each);
  const double rounding = field_.rounding_of(index);
  if (rounding <= each && (!choice || choice->total > kMostNodes)) {
    cell_.triangles.push_back(*field_.triangle_number_[index]);
    error_ += rounding;
  } else if (choice) {
    const int count = kChordCounts[choice->rule];
    for (int j = 0; j < count; ++j) {
      cell_.chords[choice->nodes[static_cast<std::size_t>(j)]].push_back(
          {index, static_cast<std::uint16_t>(choice->rule), static_cast<std::uint16_t>(j)});
    }
    error_ += choice->error;
  } else {
    cell_.near.push_back(index);
  }
}

/// <= |x - q|^2 + tau for x in the cell and q at squared distance d2 or more from its centre.
double FarField::Sorter::nearest2(double d2, double tau) const {
  const double nearest = std::max(0.0, std::sqrt(d2) - cell_.radius());
  return nearest * nearest + tau;
}

/// As how few nodes (one of the counts) a segment of that length and mass may be summed from
/// squared distance s on; none if the error of no number is at most `most`.
std::optional<FarField::Sorter::Choice> FarField::Sorter::nodes_for(
    double length, double mass, double s, std::span<const NodeCount> counts, double most) const {
  if (!(length > 0)) return Choice{};
  const double length2 = length * length;
  if (length2 > kLongest2 * s) return std::nullopt;
  const double over = 1 / s, ratio = length2 * over;
  const double size = mass * half_power(field_.two_nu_, over);
  double power = 1.0;
  int power_of = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    for (; power_of < counts[i].nodes; ++power_of) power *= ratio;
    const double error = size * counts[i].factor * power;
    if (error <= most) return Choice{i, error};
  }
  return std::nullopt;
}

/// As how few chords, each of as few nodes (one of the counts), a triangle may be summed from
/// squared distance s on; none if the error of no number is at most `most`.
std::optional<FarField::Sorter::ChordChoice> FarField::Sorter::chords_for(
    const FarElement& triangle, double s, std::span<const NodeCount> counts, double most) const {
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

void FarField::Sorter::add_source(std::vector<SeriesSource>& sources, const Vec3d& d, double s,
                                  double weight, const double* moments, double size) const {
  const double unit = 1 / cell_.half;
  sources.push_back({unit * d, s * unit * unit, weight, moments, size * unit});
}

}  // namespace cs2mesh
