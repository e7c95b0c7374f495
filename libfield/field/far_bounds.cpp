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
/// The part of both where bounds of second order are asked for.
constexpr double kSecondOrder = 0.1;
/// Boxes near so many elements are large beside the features of the sum: each element and cluster
/// is known by its range alone.
constexpr std::size_t kManyNear = 1024;

}  // namespace

const FarField::Cell::SeriesBounds& FarField::Cell::series_bounds() const {
  std::call_once(measured_, [&] {
    for (const double c : series) series_bounds_.size += std::abs(c);
    series_bounds_.hessian = cs2mesh::derivative_bound(series, 2) / (half * half);
    series_bounds_.third = cs2mesh::derivative_bound(series, 3) / (half * half * half);
  });
  return series_bounds_;
}

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
  const double part = batch.order == TaylorOrder::first ? 1.0 : kSecondOrder;
  if (around == nullptr || !around->leaf) return part * kCoarseError;
  const Vec3d middle = batch.hull.center();
  Jet jet;
  add_cell<Jet>(around, {&middle, 1}, {&jet, 1});
  return part *
         std::clamp(kErrorShare * norm(jet.gradient) * batch.radius, error_budget_, kCoarseError);
}

/// A cell of its own for the boxes, with all that is far from them in its series.
std::unique_ptr<FarField::Cell> FarField::cell_of(const BoxBatch& batch, double& error) const {
  const Cell* around = root_->holds(batch.hull) ? &smallest_around(batch.hull) : nullptr;
  auto cell = std::make_unique<Cell>();
  const Vec3d extent = batch.hull.extent();
  cell->center = batch.hull.center();
  cell->half = 0.5 * std::max({extent.x, extent.y, extent.z}) * (1 + 1e-12);
  if (!(cell->half > 0)) cell->half = root_->half;
  Sorter sorter(*this, *cell);
  error = open_error(around, batch);
  if (around != nullptr) {
    cell->series = recentered(around->series, (cell->center - around->center) / around->half,
                              cell->half / around->half);
    error = greatest(sorter.sort(around->nodes, around->elements, error, 1.0));
  } else {
    error = greatest(sorter.sort({0}, {}, error, 1.0));
  }
  return cell;
}

void FarField::add_series(const Cell& cell, const BoxBatch& batch, std::span<SumBound> sums) const {
  std::vector<Vec3d> points;
  batch.append_points(0, sums.size(), points);
  std::vector<Jet> jets(points.size());
  bulk_table().add_series<Jet>()(cell.series.data(), cell.center, cell.half, points.data(),
                                 jets.data(), jets.size());
  const std::size_t stride = batch.stride();
  const auto& [size, hessian, third] = cell.series_bounds();
  const double rounding = 1e-13 * size;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const BatchBox& box = batch.boxes[i];
    const double first = 0.5 * hessian * box.radius * box.radius;
    const double second = second_remainder(box, third, third, rounding / cell.half);
    sums[i].add_polynomial(std::span(jets).subspan(stride * i, stride), first, second, box);
    sums[i].rounding += rounding * (1 + box.radius / cell.half);
  }
}

std::size_t FarField::add_bounds(const BoxBatch& batch, double negligible,
                                 std::span<SumBound> sums) const {
  double error = 0.0;
  const std::unique_ptr<Cell> cell = cell_of(batch, error);
  add_series(*cell, batch, sums);
  for (SumBound& sum : sums) sum.deviation += error;
  return 1 + add_near_bounds(*cell, batch, negligible, sums);
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

template <class Visit>
const FarField::Cell* FarField::visit_around(const Aabb& box, const Visit& visit) const {
  const Cell* cell = root_->holds(box) ? &smallest_around(box) : nullptr;
  if (cell != nullptr) visit_unresolved(*cell, visit);
  for (std::uint32_t i = 0; cell == nullptr && i < tree_.elements().size(); ++i) visit(i);
  return cell;
}

void FarField::add_gradient_bound(const BatchBox& box, GradientSum& sum) const {
  const Cell* cell = visit_around(box.box, [&](std::uint32_t element) {
    cs2mesh::add_gradient_bound((*terms_)[tree_.elements()[element].term], box, sum);
  });
  if (cell == nullptr) return;
  const std::array<Vec3d, 4> points = box.points();
  std::array<Jet, 4> jets;
  bulk_table().add_series<Jet>()(cell->series.data(), cell->center, cell->half, points.data(),
                                 jets.data(), jets.size());
  const auto& [size, hessian, third] = cell->series_bounds();
  const double error = 1e-13 * size / cell->half;
  const double first = box.radius * hessian * (1 + 1e-12) + error;
  const double second = second_gradient_remainder(box, third, third, error);
  sum.add_polynomial(jets, first, second, box);
}

double FarField::derivative_bound(int order, const Aabb& box) const {
  double sum = 0.0;
  const Cell* cell = visit_around(box, [&](std::uint32_t element) {
    sum += cs2mesh::derivative_bound((*terms_)[tree_.elements()[element].term], order, box);
  });
  if (cell == nullptr) return sum;
  const double unit = std::pow(cell->half, order) * (1 - 1e-14);
  return sum + cs2mesh::derivative_bound(cell->series, order) / unit;
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
