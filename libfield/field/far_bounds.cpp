// What a far field knows of its sum over boxes.
#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/field/far_cell.h"
#include "libfield/field/far_field.h"
#include "libfield/field/far_sorter.h"
#include "libfield/integral/bulk.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// What a series over boxes may leave open, at most, in units of T: little beside what boxes that
/// F changes its sign in leave open.
constexpr double kCoarseError = 0.01;
/// And where F changes slowly, as a part of its change over a box.
constexpr double kErrorShare = 0.02;
/// Boxes near so many elements are large beside the features of the sum: each element and cluster
/// is known by its range alone.
constexpr std::size_t kManyNear = 1024;

}  // namespace

/// Contains the sum of a cluster over the box.
Interval FarField::cluster_range(std::uint32_t index, const Aabb& box) const {
  const SourceNode& node = tree_.node(index);
  const double near = node.box.distance(box) * (1 - 1e-12);
  const double nearest = near * near + node.least_tau;
  Aabb both = node.box;
  both.include(box);
  const double farthest = squared_norm(both.extent()) + node.tau + node.tau_spread;
  // Where a kernel is clamped, its field is that of another place.
  const double least = nearest > 0 ? inverse_power(two_nu_, farthest) * (1 - 1e-12) : 0.0;
  const double most = inverse_power(two_nu_, nearest) * (1 + 1e-12);
  const Interval unit(std::min(least, most), most);
  return Interval(node.mass - node.negative_mass) * unit - Interval(node.negative_mass) * unit;
}

/// What the series of the boxes may leave open.
double FarField::open_error(const Cell* around, const BoxBatch& batch) const {
  if (around == nullptr || !around->leaf) return kCoarseError;
  const Vec3d middle = batch.hull.center();
  Jet jet;
  add_cell<Jet>(around, {&middle, 1}, {&jet, 1});
  return std::clamp(kErrorShare * norm(jet.gradient) * batch.radius, error_budget_, kCoarseError);
}

std::size_t FarField::add_bounds(const BoxBatch& batch, double negligible,
                                 std::span<SumBound> sums) const {
  // A cell of its own for the boxes: all that is far from them in one series.
  const Cell* around = root_->holds(batch.hull) ? &smallest_around(batch.hull) : nullptr;
  Cell cell;
  const Vec3d extent = batch.hull.extent();
  cell.center = batch.hull.center();
  cell.half = 0.5 * std::max({extent.x, extent.y, extent.z}) * (1 + 1e-12);
  if (!(cell.half > 0)) cell.half = error_budget_;
  Sorter sorter(*this, cell);
  double error = open_error(around, batch);
  if (around != nullptr) {
    cell.series = recentered(around->series, (cell.center - around->center) / around->half,
                             cell.half / around->half);
    error = sorter.sort(around->nodes, around->elements, error);
  } else {
    error = sorter.sort({0}, {}, error);
  }

  std::vector<Jet> jets(sums.size());
  bulk_table().add_series<Jet>()(cell.series.data(), cell.center, cell.half, batch.centers.data(),
                                 jets.data(), jets.size());
  double size = 0.0;
  for (const double c : cell.series) size += std::abs(c);
  const double hessian = second_derivative_bound(cell.series) / (cell.half * cell.half);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i].center += jets[i];
    sums[i].hessian += hessian;
    sums[i].deviation += error;
    sums[i].rounding += 1e-13 * size;
  }
  return 1 + add_near_bounds(cell, batch, negligible, sums);
}

/// Adds what the series of the boxes does not hold.
std::size_t FarField::add_near_bounds(const Cell& cell, const BoxBatch& batch, double negligible,
                                      std::span<SumBound> sums) const {
  const bool many = cell.listed > kManyNear;
  const double open = many ? kInfinity : negligible;
  const auto add_element = [&](std::uint32_t element) {
    cs2mesh::add_bounds((*terms_)[tree_.elements()[element].term], batch, open, sums);
  };
  if (!many) {
    visit_unresolved(cell, add_element);
    return cell.listed;
  }
  for (const std::uint32_t node : cell.nodes) {
    const Interval range = cluster_range(node, batch.hull);
    for (SumBound& sum : sums) sum.range = sum.range + range;
  }
  for (const std::uint32_t element : cell.elements) add_element(element);
  return cell.nodes.size() + cell.elements.size();
}

std::array<Interval, 3> FarField::gradient_bound(const Aabb& box) const {
  std::array<Interval, 3> sum{};
  const auto add = [&](const std::array<Interval, 3>& g) {
    for (std::size_t i = 0; i < 3; ++i) sum[i] = sum[i] + g[i];
  };
  const auto add_element = [&](std::uint32_t element) {
    add(cs2mesh::gradient_bound((*terms_)[tree_.elements()[element].term], box));
  };
  if (!root_->holds(box)) {
    for (std::uint32_t i = 0; i < tree_.elements().size(); ++i) add_element(i);
    return sum;
  }
  const Cell& cell = smallest_around(box);
  const Vec3d center = box.center();
  Jet jet;
  bulk_table().add_series<Jet>()(cell.series.data(), cell.center, cell.half, &center, &jet, 1);
  const double turn =
      0.5 * box.diagonal() * cell.hessian * (1 + 1e-12) + 1e-13 * cell.size / cell.half;
  add({widened(Interval(jet.gradient.x), turn), widened(Interval(jet.gradient.y), turn),
       widened(Interval(jet.gradient.z), turn)});
  visit_unresolved(cell, add_element);
  return sum;
}

double FarField::hessian_bound(const Aabb& box) const {
  double sum = 0.0;
  const auto add_element = [&](std::uint32_t element) {
    sum += cs2mesh::hessian_bound((*terms_)[tree_.elements()[element].term], box);
  };
  if (!root_->holds(box)) {
    for (std::uint32_t i = 0; i < tree_.elements().size(); ++i) add_element(i);
    return sum;
  }
  const Cell& cell = smallest_around(box);
  sum += cell.hessian;
  visit_unresolved(cell, add_element);
  return sum;
}

void FarField::collect(const Aabb& box, double least, std::vector<std::uint32_t>& terms) const {
  const auto may_exceed = [&](const Aabb& from, double mass, double tau) {
    const double near = from.distance(box);
    return mass * inverse_power(two_nu_, near * near + tau) > least;
  };
  const auto visit = [&](const auto& self, std::uint32_t index) -> void {
    const SourceNode& node = tree_.node(index);
    if (!may_exceed(node.box, node.mass, node.least_tau)) return;
    if (node.right != 0) {
      self(self, index + 1);
      self(self, node.right);
      return;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const FarElement& element = tree_.elements()[i];
      if (may_exceed(element.box(), element.mass(), element.tau)) terms.push_back(element.term);
    }
  };
  visit(visit, 0);
}

}  // namespace cs2mesh
