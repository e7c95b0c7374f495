// The sum of thousands of points, segments and triangles whose kernels reach everywhere, at a cost
// that does not grow with their number: a fast multipole method with the target octree built where
// it is asked for (Greengard and Rokhlin 1987; Taylor series after Duan and Krasny 2001).
//
// A cell of the octree holds the Taylor series about its centre of all that is far from it: what
// its parent held, moved, and what has become far since. What is never far stays listed: within a
// leaf an element of the list is summed by its closed form where it is near, in packs if what
// rounding leaves open of that is known (line_sum.h, triangle_sum.h), else as a few weighted points
// (Gauss-Legendre), a triangle chord by chord (far_chords.h). Every approximation carries a bound
// of its error (far_reach.h, far_nodes.h, far_chords.h), and the bounds along the way from the root
// to a leaf add up to at most the error budget.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libfield/field/far_chords.h"
#include "libfield/field/far_remainders.h"
#include "libfield/field/source_tree.h"
#include "libfield/field/term_bounds.h"
#include "libfield/integral/far_reach.h"
#include "libfield/integral/far_sum.h"
#include "libfield/integral/point_sum.h"
#include "libfield/integral/segment_sum.h"
#include "libfield/integral/triangle_sum.h"

namespace cs2mesh {

/// Immutable to its users: cells are made when a point in them is first asked for, the same ones
/// whoever asks and in whatever order. Safe to use from any number of threads at once.
class FarField {
 public:
  /// The elements must all have the exponent `two_nu`; they name `terms`, which must outlive this.
  /// `domain`: where evaluations are fast; elsewhere every element is summed. error_budget > 0.
  FarField(double two_nu, std::vector<FarElement> elements, const std::vector<Term>& terms,
           const Aabb& domain, double error_budget);
  ~FarField();
  FarField(FarField&&) noexcept;
  FarField& operator=(FarField&&) = delete;

  /// Adds the field at each point, to within the error budget. The points of one cell are summed
  /// together, wherever they stand. The values among jets are the same bits as those alone.
  void add(std::span<const Vec3d> points, std::span<Jet> sums) const;
  void add(std::span<const Vec3d> points, std::span<double> sums) const;
  /// Adds the second derivative: that of the series, and the exact ones of all that is not in it.
  /// What the series leave out counts relative to the squared distance of its sources.
  void add(std::span<const Vec3d> points, std::span<Symmetric3> sums) const;

  /// As add_bounds() of each term, the approximation not counted; returns the number of summands.
  /// Where many elements are near the boxes they are known by their ranges alone. Cost: a series
  /// for the boxes (some 10 to 100 us) and what add_bounds() takes for each element near them.
  std::size_t add_bounds(const BoxBatch& batch, double negligible, std::span<SumBound> sums) const;
  /// As add_gradient_bound() of each term, the approximation not counted.
  void add_gradient_bound(const BatchBox& box, GradientSum& sum) const;
  /// >= the norm of the derivative of that order (2, 3, 4) on the box, the approximation not
  /// counted.
  double derivative_bound(int order, const Aabb& box) const;

  /// Appends the terms whose field may exceed `least` somewhere in the box.
  void collect(const Aabb& box, double least, std::vector<std::uint32_t>& terms) const;

 private:
  struct Cell;
  class Sorter;

  template <class Out>
  void add_all(std::span<const Vec3d> points, std::span<Out> sums) const;
  template <class Out>
  void add_grouped(std::span<const Vec3d> points, std::span<Out> sums) const;
  /// Outside of all cells, where `leaf` is null, every element is summed.
  template <class Out>
  void add_cell(const Cell* leaf, std::span<const Vec3d> points, std::span<Out> sums) const;
  template <class Visit>
  void visit_unresolved(const Cell& cell, const Visit& visit) const;
  /// Visits what no series holds around the box; returns the cell whose series holds the rest, null
  /// where none does.
  template <class Visit>
  const Cell* visit_around(const Aabb& box, const Visit& visit) const;
  /// From the lists of its parent, of that many elements.
  void fill(Cell& cell, const std::vector<std::uint32_t>& nodes,
            const std::vector<std::uint32_t>& elements, std::size_t listed, double guess) const;
  bool holds_few(const Cell& cell) const;
  Interval cluster_range(std::uint32_t index, const Aabb& box) const;
  std::unique_ptr<Cell> cell_of(const BoxBatch& batch, double& error) const;
  double open_error(const Cell* around, const BoxBatch& batch) const;
  std::size_t add_near_bounds(const Cell& cell, const BoxBatch& batch, double negligible,
                              std::span<SumBound> sums) const;
  void add_series(const Cell& cell, const BoxBatch& batch, std::span<SumBound> sums) const;
  void make_sources(const Aabb& domain);
  void make_triangle(std::size_t element);
  double rounding_of(std::uint32_t triangle) const;
  std::unique_ptr<Cell> make_root(const Aabb& domain) const;
  std::unique_ptr<Cell> make_child(const Cell& parent, int octant) const;
  const Cell& child(const Cell& parent, int octant) const;
  const Cell& leaf_of(const Vec3d& p) const;
  const Cell& smallest_around(const Aabb& box) const;

  double two_nu_;
  SourceTree tree_;
  std::vector<FarRemainders> remainders_;  ///< of nu + j, j < kTauOrders
  const std::vector<Term>* terms_;
  std::size_t kernel_;  ///< as in KernelKind
  double error_budget_;
  double reach_ = 0.0;  ///< about how far a place may be from an element
  FarBounds law_;       ///< of single elements
  std::array<double, kChordCounts.size()> chord_factors_{};  ///< chord_factor()
  std::vector<SegmentSource> segments_;                      ///< the elements, points among them
  std::vector<PointSource> points_;  ///< those that are points, by element; empty without any
  /// Triangles of moderate numbers, if their kernel has a bulk sum, and where each element is among
  /// them; empty without any.
  std::vector<TriangleSource> triangles_;
  std::vector<std::optional<std::uint32_t>> triangle_number_;
  std::unique_ptr<Cell> root_;
};

}  // namespace cs2mesh
