#include "libfield/field/far_sorter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/field/far_nodes.h"
#include "libfield/integral/bulk.h"

namespace cs2mesh {
namespace {

/// Of the budget of a cell, for one source.
constexpr double kGreatestShare = 1.0 / 32;

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
  for (;;) {
    for (ByOrder& by_order : clusters_) {
      for (auto& sources : by_order) sources.clear();
    }
    for (auto& sources : single_) sources.clear();
    cell_.nodes.clear(), cell_.elements.clear();
    error_ = 0.0;
    for (const std::uint32_t node : nodes) sort_node(node, each);
    for (const std::uint32_t element : elements) sort_element(element, each);
    if (error_ <= budget) break;
    each *= std::min(0.7, 0.9 * budget / error_);
  }
  cell_.share = each / budget;
  sum_up();
  cell_.listed = cell_.elements.size();
  for (const std::uint32_t node : cell_.nodes) cell_.listed += field_.tree_.node(node).count;
  return error_;
}

void FarField::Sorter::sum_up() {
  const auto add = bulk_table().add_sources;
  for (std::size_t i = 0; i < kFarOrders.size(); ++i) {
    for (std::size_t j = 0; j < clusters_.size(); ++j) {
      add(field_.two_nu_ + 2.0 * static_cast<double>(j), kFarOrders[i], clusters_[j][i].data(),
          clusters_[j][i].size(), cell_.series.data());
    }
    add(field_.two_nu_, kFarOrders[i], single_[i].data(), single_[i].size(), cell_.series.data());
  }
}

void FarField::Sorter::finish(double budget) {
  std::vector<std::uint32_t> all;
  field_.visit_unresolved(cell_, [&](std::uint32_t element) { all.push_back(element); });
  std::sort(all.begin(), all.end());
  double each = budget / 16;
  for (;;) {
    cell_.near.clear(), cell_.distant.clear();
    error_ = 0.0;
    for (const std::uint32_t element : all) {
      const FarElement& shape = field_.tree_.elements()[element];
      const int nodes = nodes_for(shape, distance(shape, cell_.center), each);
      if (nodes > 0) {
        cell_.distant.push_back({element, nodes});
      } else {
        cell_.near.push_back(element);
      }
    }
    if (error_ <= budget) return;
    each *= std::min(0.7, 0.9 * budget / error_);
  }
}

void FarField::Sorter::sort_node(std::uint32_t index, double each) {
  const SourceNode& node = field_.tree_.node(index);
  const Vec3d d = cell_.center - node.center;
  const double s = squared_norm(d) + node.tau;
  const double q = (node.radius + cell_.radius()) / std::sqrt(s);
  if (q < 1.0 && take_cluster(index, d, s, q, each)) return;
  if (node.radius < 0.5 * cell_.radius()) {
    cell_.nodes.push_back(index);  // a child may find it far
  } else if (node.right != 0) {
    sort_node(index + 1, each);
    sort_node(node.right, each);
  } else {
    for (std::uint32_t i = 0; i < node.count; ++i) sort_element(node.first + i, each);
  }
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
    cut = field_.remainders_[static_cast<std::size_t>(j)].lowest_order(q * q, c, share / weight);
    if (!(weight * cut.error <= share)) return false;
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
  const double d = distance(element, cell_.center);
  const double s = d * d + element.tau;
  const double q2 = cell_.radius() * cell_.radius() / s;
  const double size = element.mass() * inverse_power(field_.two_nu_, s);
  // Of all places on the element, as it is convex.
  const double l1 =
      std::max(sum_of_sizes(cell_.center - element.a), sum_of_sizes(cell_.center - element.b));
  const double c = corner_share(l1, s, 0.0);
  const Truncation cut = field_.remainders_[0].lowest_order(q2, c, 0.5 * each / size);
  const double error = size * cut.error;
  const int nodes = error <= 0.5 * each ? nodes_for(element, d, 0.5 * each) : 0;
  if (nodes == 0) {
    cell_.elements.push_back(index);
    return;
  }
  error_ += error;
  places_.clear();
  PointSource unit;
  unit.position = element.a;
  unit.gain = 1.0;
  append_nodes(element, unit, nodes, places_);
  for (const PointSource& place : places_) {
    const Vec3d from = cell_.center - place.position;
    const double at = squared_norm(from) + element.tau;
    add_source(single_[cut.order], from, at,
               element.weight * place.gain * inverse_power(field_.two_nu_, at), nullptr, 1.0);
  }
}

/// As how many points an element at distance d from the centre may be summed in this cell; 0 if
/// only itself will do.
int FarField::Sorter::nodes_for(const FarElement& element, double d, double each) {
  if (!(element.length > 0)) return 1;
  const double nearest = std::max(0.0, d - cell_.radius());
  const double s = nearest * nearest + element.tau;
  const double length2 = element.length * element.length;
  if (length2 > s) return 0;
  const double size = element.mass() * inverse_power(field_.two_nu_, s);
  double power = 1.0;
  int power_of = 0;
  for (std::size_t i = 0; i < kFarNodes.size(); ++i) {
    for (; power_of < kFarNodes[i]; ++power_of) power *= length2 / s;
    const double error = size * field_.node_factor_[i] * power;
    if (error > each) continue;
    error_ += error;
    return kFarNodes[i];
  }
  return 0;
}

void FarField::Sorter::add_source(std::vector<SeriesSource>& sources, const Vec3d& d, double s,
                                  double weight, const double* moments, double size) const {
  const double unit = 1 / cell_.half;
  sources.push_back({unit * d, s * unit * unit, weight, moments, size * unit});
}

}  // namespace cs2mesh
