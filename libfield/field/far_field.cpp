#include "libfield/field/far_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "libfield/base/check.h"
#include "libfield/field/far_cell.h"
#include "libfield/field/far_sorter.h"
#include "libfield/integral/bulk.h"

namespace cs2mesh {
namespace {

/// A cell whose list is no longer is a leaf: about as many as are summed in the time that finer
/// cells would take to set up. No more of them may be near, which take ten times as long, nor by
/// closed forms in packs, nor anything but points, which take least.
constexpr std::size_t kShortList = 1000, kMostNear = 100, kMostLines = 150, kMostTriangles = 300,
                      kMostPoints = 1000, kMostOthers = 900;
/// So many points are gathered by their cells at once: what that takes stays in memory at hand.
constexpr std::size_t kMostGathered = 16384;
/// A cell that so few elements reach into is a leaf, unless its list is longer than that.
constexpr std::size_t kFewElements = 3, kLongestList = 2048;
constexpr int kMostLevels = 20;
/// The part of the error budget for the series along the way from the root; all of it where the
/// lists of leaves, of points alone, are summed exactly. A cell with a long list serves many points
/// and may cost much: it has a small part of what its parents have left. Those of the last levels,
/// which are many, have a large one.
constexpr double kSeriesPart = 0.8;
constexpr std::size_t kLongList = 4000;
constexpr double kEarlyPart = 0.15, kLatePart = 0.55;
/// A list shrinks from level to level, so that each source that leaves it may leave open more.
constexpr double kShareGrowth = 2.3;

}  // namespace

FarField::FarField(double two_nu, std::vector<FarElement> elements, const std::vector<Term>& terms,
                   const Aabb& domain, double error_budget)
    : two_nu_(two_nu), tree_(std::move(elements)), terms_(&terms), error_budget_(error_budget) {
  require(!tree_.elements().empty(), "a far field needs elements");
  require(error_budget > 0, "the error budget must be positive");
  kernel_ = terms[tree_.elements().front().term].kernel.index();
  make_sources(domain);
  law_ = {two_nu, far_terms(two_nu), rule_bounds(two_nu), sum_bounds(two_nu)};
  for (std::size_t i = 0; i < chord_factors_.size(); ++i) {
    chord_factors_[i] = chord_factor(two_nu, kChordCounts[i]);
  }
  for (int j = 0; j < kTauOrders; ++j) remainders_.emplace_back(two_nu + 2 * j);
  root_ = make_root(domain);
}

void FarField::make_sources(const Aabb& domain) {
  Aabb all = domain;
  const std::size_t count = tree_.elements().size();
  all.include(tree_.node(0).box);
  reach_ = all.diagonal();
  segments_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const FarElement& element = tree_.elements()[i];
    const double weight = std::copysign(element.mass(), element.weight);
    segments_.push_back({element.middle(), 0.5 * (element.b - element.a), weight, element.tau});
    if (element.is_triangle()) make_triangle(i);
    if (element.length > 0) continue;
    points_.resize(count);
    const Term& term = (*terms_)[element.term];
    points_[i] = point_source(term.kernel, Point{element.a}, term.sign);
  }
}

void FarField::make_triangle(std::size_t element) {
  constexpr double kGreatest = 1e18;
  const Term& term = (*terms_)[tree_.elements()[element].term];
  const auto* cauchy = std::get_if<Cauchy>(&term.kernel);
  if (cauchy == nullptr || !(cauchy->s * reach_ < kGreatest)) return;
  const auto& frame = *std::get<std::shared_ptr<const TriangleFrame<double>>>(term.frame);
  triangle_number_.resize(tree_.elements().size());
  triangle_number_[element] = static_cast<std::uint32_t>(triangles_.size());
  triangles_.push_back(triangle_source(*cauchy, frame, term.sign));
}

/// What the bulk sum leaves open of an element that is a triangle; infinite if there is none.
double FarField::rounding_of(std::uint32_t triangle) const {
  if (triangle_number_.empty() || !triangle_number_[triangle]) {
    return std::numeric_limits<double>::infinity();
  }
  const Term& term = (*terms_)[tree_.elements()[triangle].term];
  return triangle_rounding(std::get<Cauchy>(term.kernel));
}

FarField::~FarField() = default;
FarField::FarField(FarField&&) noexcept = default;

// ---- Cells ----

std::unique_ptr<FarField::Cell> FarField::make_root(const Aabb& domain) const {
  auto root = std::make_unique<Cell>();
  const Vec3d extent = domain.extent();
  root->center = domain.center();
  root->half = 0.5 * std::max({extent.x, extent.y, extent.z}) * (1 + 1e-9);
  const Vec3d half{root->half, root->half, root->half};
  root->lo = root->center - half;
  root->hi = root->center + half;
  fill(*root, {0}, {}, tree_.node(0).work(), 1.0);
  return root;
}

void FarField::fill(Cell& cell, const std::vector<std::uint32_t>& nodes,
                    const std::vector<std::uint32_t>& elements, std::size_t listed,
                    double guess) const {
  Sorter sorter(*this, cell);
  const bool exact_lists = !(tree_.node(0).longest > 0);
  const double rest = (exact_lists ? 1.0 : kSeriesPart) * error_budget_ - greatest(cell.errors);
  const double part = listed > kLongList ? kEarlyPart : kLatePart;
  const OctantErrors errors = sorter.sort(nodes, elements, part * rest, guess);
  for (std::size_t k = 0; k < errors.size(); ++k) cell.errors[k] += errors[k];
  // Where all is close together, smaller cells do not help; nor where a cell holds so little of
  // the surface that its points are summed before finer cells are set up.
  const bool stuck = cell.level > 4 && 5 * cell.listed > 4 * listed;
  cell.leaf =
      cell.level == kMostLevels - 1 || stuck || (cell.listed <= kLongestList && holds_few(cell));
  if (!cell.leaf && cell.listed > kShortList) return;
  sorter.finish(error_budget_ - greatest(cell.errors));
  cell.leaf =
      cell.leaf || (cell.near.size() <= kMostNear && cell.lines.size() <= kMostLines &&
                    cell.points.size() <= kMostPoints && cell.triangles.size() <= kMostTriangles &&
                    cell.listed - cell.points.size() <= kMostOthers);
  if (!cell.leaf) cell.forget_shares();
}

bool FarField::holds_few(const Cell& cell) const {
  std::size_t inside = 0;
  const auto is_one_too_many = [&](std::uint32_t index) {
    inside += Aabb{cell.lo, cell.hi}.overlaps(tree_.elements()[index].box()) ? 1 : 0;
    return inside > kFewElements;
  };
  for (const std::uint32_t index : cell.nodes) {
    const SourceNode& node = tree_.node(index);
    for (std::uint32_t i = 0; i < node.count; ++i) {
      if (is_one_too_many(node.first + i)) return false;
    }
  }
  return std::none_of(cell.elements.begin(), cell.elements.end(), is_one_too_many);
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
  // All of it is in one of the parent's octants.
  const int signs = octant & 1 ? ~octant : octant;
  cell->errors.fill(parent.errors[static_cast<std::size_t>(signs >> 1 & 3)]);
  fill(*cell, parent.nodes, parent.elements, parent.listed, kShareGrowth * parent.share);
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
  if (!cell.points.empty()) {
    table.point_row<Out>()[kernel_](points_.data(), cell.points.data(), cell.points.size(),
                                    points.data(), sums.data(), points.size());
  }
  thread_local ChordSources chords;
  for (std::size_t which = 0; which < kFarNodes.size(); ++which) {
    const auto add = [&](const SegmentSource* sources, std::span<const std::uint32_t> list) {
      if (list.empty()) return;
      table.add_segments<Out>()(two_nu_, which, sources, list.data(), list.size(), points.data(),
                                sums.data(), points.size());
    };
    add(segments_.data(), cell.segments[which]);
    chords.set(cell.chords[which], tree_.elements());
    add(chords.sources().data(), chords.all());
  }
  if (!cell.lines.empty()) {
    table.add_lines<Out>()(segments_.data(), cell.lines.data(), cell.lines.size(), points.data(),
                           sums.data(), points.size());
  }
  if (!cell.triangles.empty()) {
    table.add_triangles<Out>()(triangles_.data(), cell.triangles.data(), cell.triangles.size(),
                               points.data(), sums.data(), points.size());
  }
  for (const std::uint32_t element : cell.near) {
    accumulate((*terms_)[tree_.elements()[element].term], points, sums);
  }
}

template <class Out>
void FarField::add_grouped(std::span<const Vec3d> points, std::span<Out> sums) const {
  if (points.empty()) return;
  const auto cell_of_place = [&](const Vec3d& p) -> const Cell* {
    return root_->holds(p) ? &leaf_of(p) : nullptr;
  };
  const Cell* cell = cell_of_place(points[0]);
  const auto is_within = [&](const Vec3d& p) {
    return cell != nullptr ? cell->holds(p) : !root_->holds(p);
  };
  if (std::all_of(points.begin() + 1, points.end(), is_within)) {
    return add_cell(cell, points, sums);
  }
  // Cell by cell, in the order in which they are met.
  std::vector<const Cell*> cells;
  std::unordered_map<const Cell*, std::uint32_t> number_of;
  std::vector<std::uint32_t> number(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_within(points[i])) cell = cell_of_place(points[i]);
    const auto [place, is_new] =
        number_of.try_emplace(cell, static_cast<std::uint32_t>(cells.size()));
    if (is_new) cells.push_back(cell);
    number[i] = place->second;
  }
  std::vector<std::uint32_t> begin(cells.size() + 1, 0);
  for (const std::uint32_t n : number) ++begin[n + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> order(points.size()), next(begin.begin(), begin.end() - 1);
  for (std::uint32_t i = 0; i < points.size(); ++i) order[next[number[i]]++] = i;
  std::vector<Vec3d> gathered;
  std::vector<Out> results;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::span<const std::uint32_t> here(order.data() + begin[c], begin[c + 1] - begin[c]);
    gathered.clear(), results.clear();
    for (const std::uint32_t i : here) gathered.push_back(points[i]), results.push_back(sums[i]);
    add_cell(cells[c], std::span<const Vec3d>(gathered), std::span(results));
    for (std::size_t i = 0; i < here.size(); ++i) sums[here[i]] = results[i];
  }
}

template <class Out>
void FarField::add_all(std::span<const Vec3d> points, std::span<Out> sums) const {
  for (std::size_t first = 0; first < points.size(); first += kMostGathered) {
    const std::size_t here = std::min(points.size() - first, kMostGathered);
    add_grouped(points.subspan(first, here), sums.subspan(first, here));
  }
}

void FarField::add(std::span<const Vec3d> points, std::span<Jet> sums) const {
  add_all(points, sums);
}
void FarField::add(std::span<const Vec3d> points, std::span<double> sums) const {
  add_all(points, sums);
}

}  // namespace cs2mesh
