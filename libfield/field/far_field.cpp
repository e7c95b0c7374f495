#include "libfield/field/far_field.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "libfield/base/check.h"
#include "libfield/integral/bulk.h"
#include "libfield/integral/gauss_legendre.h"

namespace cs2mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// A cell whose list is no longer is a leaf: about as many as are summed in the time that finer
/// cells would take to set up.
constexpr std::size_t kShortList = 512;
/// A cell that so few elements reach into is a leaf, unless its list is longer than that.
constexpr std::size_t kFewElements = 3, kLongestList = 2048;
constexpr int kMostLevels = 20;
/// The half diagonal of a cube in units of half its edge, rounded up.
constexpr double kDiagonal = 1.7320508075688774 * (1 + 1e-12);

/// x^-nu.
double inverse_power(double two_nu, double x) {
  if (two_nu == 4.0) return 1 / (x * x);
  if (two_nu == 2.0) return 1 / x;
  return 1 / std::sqrt(x);
}

/// The numbers of nodes that an element may be replaced by.
constexpr std::array<int, 4> kNodes = {2, 4, 6, 8};

/// The error of n nodes on a segment of length L and weight 1 at squared distance s, relative to
/// L s^-nu (L^2 / s)^n: (n!)^4 / ((2n + 1) (2n)!^2) binomial(2n + 2 nu - 1, 2n).
double node_factor(double two_nu, int n) {
  double factor = 1.0;
  for (int m = 1; m <= 2 * n; ++m) factor *= (m + two_nu - 1) / m;
  for (int m = 1; m <= n; ++m) {
    const double ratio = static_cast<double>(m) / (n + m);  // (n!)^2 / (2n)!, squared
    factor *= ratio * ratio;
  }
  return factor / (2 * n + 1) * (1 + 1e-12);
}

template <std::size_t N>
void append_nodes(const FarElement& element, const PointSource& law,
                  std::vector<PointSource>& points) {
  constexpr const UnitRule<N>& rule = kUnitRule<static_cast<int>(N)>;
  for (std::size_t i = 0; i < N; ++i) {
    PointSource point = law;
    const double weight = element.length * rule.weight[i];
    point.position = element.a + rule.node[i] * (element.b - element.a);
    point.gain *= weight;
    point.slope *= weight;
    points.push_back(point);
  }
}

/// The element as that many weighted points; 1 for a point itself.
void append_points(const FarElement& element, const PointSource& law, int nodes,
                   std::vector<PointSource>& points) {
  switch (nodes) {
    case 1:
      points.push_back(law);
      return;
    case 2:
      return append_nodes<2>(element, law, points);
    case 4:
      return append_nodes<4>(element, law, points);
    case 6:
      return append_nodes<6>(element, law, points);
    default:
      return append_nodes<8>(element, law, points);
  }
}

}  // namespace

/// A cube lo < p <= hi of the target octree.
struct FarField::Cell {
  /// An element to be summed as so many points.
  struct Distant {
    std::uint32_t element;
    int nodes;
  };

  Vec3d lo, hi, center;
  double half = 0.0;
  int level = 0;
  bool leaf = false;
  Series series{};       ///< of (p - center) / half
  double size = 0.0;     ///< sum of the absolute values of its coefficients
  double hessian = 0.0;  ///< >= the norm of its second derivative
  double third = 0.0;    ///< and of its third
  /// What is not in the series: nodes of the source tree, and elements.
  std::vector<std::uint32_t> nodes, elements;
  std::size_t listed = 0;           ///< elements in all of them
  std::vector<Distant> distant;     ///< of a leaf
  std::vector<std::uint32_t> near;  ///< of a leaf
  mutable std::array<std::atomic<Cell*>, 8> children{};

  Cell() = default;
  Cell(const Cell&) = delete;
  Cell& operator=(const Cell&) = delete;
  ~Cell() {
    for (auto& child : children) delete child.load(std::memory_order_relaxed);
  }

  bool holds(const Vec3d& p) const {
    return lo.x < p.x && p.x <= hi.x && lo.y < p.y && p.y <= hi.y && lo.z < p.z && p.z <= hi.z;
  }
  bool holds(const Aabb& box) const { return holds(box.min) && holds(box.max); }
  int octant_of(const Vec3d& p) const {
    return (p.x > center.x ? 1 : 0) + (p.y > center.y ? 2 : 0) + (p.z > center.z ? 4 : 0);
  }
  double radius() const { return kDiagonal * half; }
};

/// Sorts what a cell has to sum by how far it is.
class FarField::Sorter {
 public:
  Sorter(const FarField& field, Cell& cell) : field_(field), cell_(cell) {}

  /// Moves what is far enough from the parent's lists into the cell's series.
  void sort(const std::vector<std::uint32_t>& nodes, const std::vector<std::uint32_t>& elements) {
    const double budget = 0.5 * field_.error_budget_ / kMostLevels;
    double each = budget / 32;
    for (;;) {
      for (auto& sources : clusters_) sources.clear();
      for (auto& sources : single_) sources.clear();
      cell_.nodes.clear(), cell_.elements.clear();
      error_ = 0.0;
      for (const std::uint32_t node : nodes) sort_node(node, each);
      for (const std::uint32_t element : elements) sort_element(element, each);
      if (error_ <= budget) break;
      each *= std::min(0.7, 0.9 * budget / error_);
    }
    const auto add = bulk_table().add_sources;
    for (std::size_t j = 0; j < clusters_.size(); ++j) {
      add(field_.two_nu_ + 2.0 * static_cast<double>(j), kTaylorOrder, clusters_[j].data(),
          clusters_[j].size(), cell_.series.data());
    }
    for (std::size_t i = 0; i < kOrders.size(); ++i) {
      add(field_.two_nu_, kOrders[i], single_[i].data(), single_[i].size(), cell_.series.data());
    }
    cell_.listed = cell_.elements.size();
    for (const std::uint32_t node : cell_.nodes) cell_.listed += field_.tree_.node(node).count;
  }

  /// Divides what a leaf still lists into what is near and what a few points stand for.
  void finish() {
    std::vector<std::uint32_t> all;
    field_.visit_unresolved(cell_, [&](std::uint32_t element) { all.push_back(element); });
    std::sort(all.begin(), all.end());
    const double budget = 0.5 * field_.error_budget_;
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

 private:
  void sort_node(std::uint32_t index, double each) {
    const SourceNode& node = field_.tree_.node(index);
    const Vec3d d = cell_.center - node.center;
    const double s = squared_norm(d) + node.tau;
    const double q = (node.radius + cell_.radius()) / std::sqrt(s);
    if (q < 1.0) {
      const double power = inverse_power(field_.two_nu_, s);
      const double error = node.mass * power * cluster_error(q, node.tau_spread / s);
      if (error <= each) {
        error_ += error;
        add_cluster(index, d, s, power);
        return;
      }
    }
    if (node.radius < 0.5 * cell_.radius()) {
      cell_.nodes.push_back(index);  // a child may find it far
    } else if (node.right != 0) {
      sort_node(index + 1, each);
      sort_node(node.right, each);
    } else {
      for (std::uint32_t i = 0; i < node.count; ++i) sort_element(node.first + i, each);
    }
  }

  /// The error of a cluster's series, relative to its mass S^-nu, where the tau of its elements
  /// differ by up to `spread` times S: those of kTauOrders series in space, weighted by
  /// binomial(nu + j - 1, j) spread^j, and the rest of that series.
  double cluster_error(double q, double spread) const {
    const double nu = 0.5 * field_.two_nu_;
    double error = 0.0, weight = 1.0;
    for (int j = 0; j < kTauOrders; ++j) {
      error += weight * series_remainder(field_.two_nu_ + 2 * j, q);
      weight *= spread * (nu + j) / (j + 1);
    }
    if (!(spread > 0)) return series_remainder(field_.two_nu_, q);
    const double nearest = (1 - q) * (1 - q);  // of |d + x|^2 + tau, relative to S
    const double ratio = spread / nearest * std::max(1.0, (nu + kTauOrders) / (kTauOrders + 1));
    if (!(ratio < 1)) return kInfinity;
    return error + weight / (std::pow(nearest, nu + kTauOrders) * (1 - ratio)) * (1 + 1e-12);
  }

  void add_cluster(std::uint32_t index, const Vec3d& d, double s, double power) {
    const SourceNode& node = field_.tree_.node(index);
    add_source(clusters_[0], d, s, power, field_.tree_.moments(index, 0), node.radius);
    if (!(node.tau_spread > 0)) return;
    // (S + t)^-nu = sum binomial(-nu, j) t^j S^(-nu - j), in the unit of the series.
    const double nu = 0.5 * field_.two_nu_;
    double factor = power;
    for (int j = 1; j < kTauOrders; ++j) {
      factor *= -(nu + j - 1) / j * node.tau_spread / s;
      add_source(clusters_[static_cast<std::size_t>(j)], d, s, factor,
                 field_.tree_.moments(index, j), node.radius);
    }
  }

  void sort_element(std::uint32_t index, double each) {
    const FarElement& element = field_.tree_.elements()[index];
    const double d = distance(element, cell_.center);
    const double s = d * d + element.tau;
    const double q = cell_.radius() / std::sqrt(s);
    const double size = element.mass() * inverse_power(field_.two_nu_, s);
    const auto error_of = [&](std::size_t order) {
      return size * series_remainder(field_.two_nu_, q, kOrders[order]);
    };
    // The lowest order that will do.
    std::size_t order = kOrders.size() - 1;
    double error = error_of(order);
    const int nodes = error <= 0.5 * each ? nodes_for(element, d, 0.5 * each) : 0;
    if (nodes == 0) {
      cell_.elements.push_back(index);
      return;
    }
    while (order > 0) {
      const double with_less = error_of(order - 1);
      if (with_less > 0.5 * each) break;
      error = with_less;
      --order;
    }
    error_ += error;
    places_.clear();
    PointSource unit;
    unit.position = element.a;
    unit.gain = 1.0;
    append_points(element, unit, nodes, places_);
    for (const PointSource& place : places_) {
      const Vec3d from = cell_.center - place.position;
      const double at = squared_norm(from) + element.tau;
      add_source(single_[order], from, at,
                 element.weight * place.gain * inverse_power(field_.two_nu_, at), nullptr, 1.0);
    }
  }

  /// As how many points an element at distance d from the centre may be summed in this cell; 0 if
  /// only itself will do.
  int nodes_for(const FarElement& element, double d, double each) {
    if (!(element.length > 0)) return 1;
    const double nearest = std::max(0.0, d - cell_.radius());
    const double s = nearest * nearest + element.tau;
    const double length2 = element.length * element.length;
    if (length2 > s) return 0;
    const double size = element.mass() * inverse_power(field_.two_nu_, s);
    double power = 1.0;
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      power *= length2 / s * (length2 / s);
      const double error = size * field_.node_factor_[i] * power;
      if (error > each) continue;
      error_ += error;
      return kNodes[i];
    }
    return 0;
  }

  void add_source(std::vector<SeriesSource>& sources, const Vec3d& d, double s, double power,
                  const double* moments, double size) const {
    const double unit = 1 / cell_.half;
    sources.push_back({unit * d, s * unit * unit, power, moments, size * unit});
  }

  const FarField& field_;
  Cell& cell_;
  double error_ = 0.0;
  static constexpr std::array<int, 4> kOrders = {4, 6, 8, kTaylorOrder};
  std::array<std::vector<SeriesSource>, kTauOrders> clusters_;    ///< by the power of tau
  std::array<std::vector<SeriesSource>, kOrders.size()> single_;  ///< by the order they need
  std::vector<PointSource> places_;
};

FarField::FarField(double two_nu, std::vector<FarElement> elements, const std::vector<Term>& terms,
                   const Aabb& domain, double error_budget)
    : two_nu_(two_nu), tree_(std::move(elements)), terms_(&terms), error_budget_(error_budget) {
  require(!tree_.elements().empty(), "a far field needs elements");
  require(error_budget > 0, "the error budget must be positive");
  kernel_ = terms[tree_.elements().front().term].kernel.index();
  points_.reserve(tree_.elements().size());
  for (const FarElement& element : tree_.elements()) {
    const Term& term = terms[element.term];
    points_.push_back(point_source(term.kernel, Point{element.a}, term.sign));
  }
  for (std::size_t i = 0; i < kNodes.size(); ++i) node_factor_[i] = node_factor(two_nu, kNodes[i]);
  root_ = make_root(domain);
}

FarField::~FarField() = default;
FarField::FarField(FarField&&) noexcept = default;

// ---- Cells ----

template <class Visit>
void FarField::visit_unresolved(const Cell& cell, const Visit& visit) const {
  for (const std::uint32_t index : cell.nodes) {
    const SourceNode& node = tree_.node(index);
    for (std::uint32_t i = 0; i < node.count; ++i) visit(node.first + i);
  }
  for (const std::uint32_t element : cell.elements) visit(element);
}

std::unique_ptr<FarField::Cell> FarField::make_root(const Aabb& domain) const {
  auto root = std::make_unique<Cell>();
  const Vec3d extent = domain.extent();
  root->center = domain.center();
  root->half = 0.5 * std::max({extent.x, extent.y, extent.z}) * (1 + 1e-9);
  const Vec3d half{root->half, root->half, root->half};
  root->lo = root->center - half;
  root->hi = root->center + half;
  fill(*root, {0}, {}, tree_.elements().size());
  return root;
}

void FarField::fill(Cell& cell, const std::vector<std::uint32_t>& nodes,
                    const std::vector<std::uint32_t>& elements, std::size_t listed) const {
  Sorter sorter(*this, cell);
  sorter.sort(nodes, elements);
  for (const double c : cell.series) cell.size += std::abs(c);
  cell.hessian = cs2mesh::derivative_bound(cell.series, 2) / (cell.half * cell.half);
  cell.third = cs2mesh::derivative_bound(cell.series, 3) / (cell.half * cell.half * cell.half);
  // Where all is close together, smaller cells do not help; nor where a cell holds so little of
  // the surface that its points are summed before finer cells are set up.
  const bool stuck = cell.level > 4 && 5 * cell.listed > 4 * listed;
  cell.leaf = cell.listed <= kShortList || cell.level == kMostLevels - 1 || stuck ||
              (cell.listed <= kLongestList && holds_few(cell));
  if (cell.leaf) sorter.finish();
}

bool FarField::holds_few(const Cell& cell) const {
  std::size_t inside = 0;
  visit_unresolved(cell, [&](std::uint32_t index) {
    inside += Aabb{cell.lo, cell.hi}.overlaps(tree_.elements()[index].box()) ? 1 : 0;
  });
  return inside <= kFewElements;
}

std::unique_ptr<FarField::Cell> FarField::make_child(const Cell& parent, int octant) const {
  auto cell = std::make_unique<Cell>();
  const auto side = [&](int bit, double lo, double middle, double hi, double& low, double& high) {
    const bool upper = (octant & bit) != 0;
    low = upper ? middle : lo;
    high = upper ? hi : middle;
    return upper ? 0.5 : -0.5;
  };
  Vec3d offset;
  offset.x = side(1, parent.lo.x, parent.center.x, parent.hi.x, cell->lo.x, cell->hi.x);
  offset.y = side(2, parent.lo.y, parent.center.y, parent.hi.y, cell->lo.y, cell->hi.y);
  offset.z = side(4, parent.lo.z, parent.center.z, parent.hi.z, cell->lo.z, cell->hi.z);
  cell->half = 0.5 * parent.half;
  cell->center = parent.center + parent.half * offset;
  cell->level = parent.level + 1;
  cell->series = recentered(parent.series, offset, 0.5);
  fill(*cell, parent.nodes, parent.elements, parent.listed);
  return cell;
}

const FarField::Cell& FarField::child(const Cell& parent, int octant) const {
  std::atomic<Cell*>& place = parent.children[static_cast<std::size_t>(octant)];
  Cell* found = place.load(std::memory_order_acquire);
  if (found != nullptr) return *found;
  // Whoever comes first; the others have made the same.
  std::unique_ptr<Cell> made = make_child(parent, octant);
  if (place.compare_exchange_strong(found, made.get(), std::memory_order_acq_rel)) {
    return *made.release();
  }
  return *found;
}

const FarField::Cell& FarField::leaf_of(const Vec3d& p) const {
  const Cell* cell = root_.get();
  while (!cell->leaf) cell = &child(*cell, cell->octant_of(p));
  return *cell;
}

const FarField::Cell& FarField::smallest_around(const Aabb& box) const {
  const Cell* cell = root_.get();
  while (!cell->leaf && cell->octant_of(box.min) == cell->octant_of(box.max)) {
    cell = &child(*cell, cell->octant_of(box.min));
  }
  return *cell;
}

// ---- Evaluation ----

template <class Out>
void FarField::add_cell(const Cell* leaf, std::span<const Vec3d> points,
                        std::span<Out> sums) const {
  if (leaf == nullptr) {
    for (const FarElement& element : tree_.elements()) {
      accumulate((*terms_)[element.term], points, sums);
    }
    return;
  }
  const Cell& cell = *leaf;
  const BulkTable& table = bulk_table();
  table.add_series<Out>()(cell.series.data(), cell.center, cell.half, points.data(), sums.data(),
                          points.size());
  if (!cell.distant.empty()) {
    std::vector<PointSource> places;
    places.reserve(4 * cell.distant.size());
    for (const Cell::Distant& distant : cell.distant) {
      append_points(tree_.elements()[distant.element], points_[distant.element], distant.nodes,
                    places);
    }
    std::vector<std::uint32_t> index(places.size());
    std::iota(index.begin(), index.end(), 0U);
    table.point_row<Out>()[kernel_](places.data(), index.data(), places.size(), points.data(),
                                    sums.data(), points.size());
  }
  for (const std::uint32_t element : cell.near) {
    accumulate((*terms_)[tree_.elements()[element].term], points, sums);
  }
}

template <class Out>
void FarField::add_grouped(std::span<const Vec3d> points, std::span<Out> sums) const {
  // Cell by cell, in the order in which they are met.
  std::vector<const Cell*> cells;
  std::unordered_map<const Cell*, std::uint32_t> number_of;
  std::vector<std::uint32_t> number(points.size());
  const Cell* cell = nullptr;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == 0 || (cell != nullptr ? !cell->holds(points[i]) : root_->holds(points[i]))) {
      cell = root_->holds(points[i]) ? &leaf_of(points[i]) : nullptr;
    }
    const auto [place, is_new] =
        number_of.try_emplace(cell, static_cast<std::uint32_t>(cells.size()));
    if (is_new) cells.push_back(cell);
    number[i] = place->second;
  }
  if (cells.size() == 1) return add_cell(cells[0], points, sums);

  std::vector<std::uint32_t> begin(cells.size() + 1, 0);
  for (const std::uint32_t n : number) ++begin[n + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> order(points.size()), next(begin.begin(), begin.end() - 1);
  for (std::uint32_t i = 0; i < points.size(); ++i) order[next[number[i]]++] = i;
  std::vector<Vec3d> gathered(points.size());
  std::vector<Out> results(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    gathered[i] = points[order[i]];
    results[i] = sums[order[i]];
  }
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::size_t first = begin[c], count = begin[c + 1] - first;
    add_cell(cells[c], std::span<const Vec3d>(gathered).subspan(first, count),
             std::span(results).subspan(first, count));
  }
  for (std::size_t i = 0; i < order.size(); ++i) sums[order[i]] = results[i];
}

void FarField::add(std::span<const Vec3d> points, std::span<Jet> sums) const {
  add_grouped(points, sums);
}
void FarField::add(std::span<const Vec3d> points, std::span<double> sums) const {
  add_grouped(points, sums);
}

// ---- Bounds ----

void FarField::add_series(const Cell& cell, const BoxBatch& batch, std::span<SumBound> sums) const {
  std::vector<Vec3d> points;
  batch.append_points(0, sums.size(), points);
  std::vector<Jet> jets(points.size());
  bulk_table().add_series<Jet>()(cell.series.data(), cell.center, cell.half, points.data(),
                                 jets.data(), jets.size());
  const std::size_t stride = batch.stride();
  const double rounding = 1e-13 * cell.size;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const BatchBox& box = batch.boxes[i];
    const double first = 0.5 * cell.hessian * box.radius * box.radius;
    const double second = second_remainder(box, cell.third, cell.third, rounding / cell.half);
    sums[i].add_polynomial(std::span(jets).subspan(stride * i, stride), first, second, box);
    sums[i].rounding += rounding * (1 + box.radius / cell.half);
  }
}

std::size_t FarField::add_bounds(const BoxBatch& batch, double negligible,
                                 std::span<SumBound> sums) const {
  std::size_t looked_at = 0;
  const auto add_element = [&](std::uint32_t element) {
    cs2mesh::add_bounds((*terms_)[tree_.elements()[element].term], batch, negligible, sums);
    ++looked_at;
  };
  const auto add_node = [&](const auto& self, std::uint32_t index) -> void {
    const SourceNode& node = tree_.node(index);
    const double near = node.box.distance(batch.hull) * (1 - 1e-12);
    const double most =
        node.mass * inverse_power(two_nu_, near * near + node.least_tau) * (1 + 1e-12);
    if (2 * most <= negligible) {
      for (SumBound& sum : sums) sum.range = sum.range + Interval(-most, most);
      ++looked_at;
    } else if (node.right != 0) {
      self(self, index + 1);
      self(self, node.right);
    } else {
      for (std::uint32_t i = 0; i < node.count; ++i) add_element(node.first + i);
    }
  };
  if (!root_->holds(batch.hull)) {
    add_node(add_node, 0);
    return looked_at;
  }
  const Cell& cell = smallest_around(batch.hull);
  add_series(cell, batch, sums);
  for (const std::uint32_t node : cell.nodes) add_node(add_node, node);
  for (const std::uint32_t element : cell.elements) add_element(element);
  return looked_at + 1;
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
  const double error = 1e-13 * cell->size / cell->half;
  const double first = box.radius * cell->hessian * (1 + 1e-12) + error;
  const double second = second_gradient_remainder(box, cell->third, cell->third, error);
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
