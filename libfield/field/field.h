// The field of a blend group as an ImplicitSurface: F(p) = sum of the terms, surface F = T = 1.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "libfield/base/box_tree.h"
#include "libfield/base/made_once.h"
#include "libfield/field/compile.h"
#include "libfield/field/implicit_surface.h"
#include "libfield/field/term.h"

namespace cs2mesh {

/// What all views of a field share.
struct FieldData;
struct BatchBox;
class LogSum;
class LogTerms;
enum class TaylorOrder;
class LazyNearSum;

/// values(), jets() and enclose() are those of F - T. A term is left out of a block of the field's
/// own lattice where its influence provably stays under its share of the error budget; the shares
/// sum to the budget, so F may step by as much where blocks meet. A point on a face belongs to the
/// block below it.
///
/// Not promised: that gradients of jets() lie within enclose_gradient() and derivative_bound() to
/// the last bit where a far field approximates them; those bound the sum itself, enclose() both.
///
/// Cost of an evaluation: the terms near the point's block, and a tree walk for each run of
/// consecutive points in one block; so sort points by place, or evaluate them in a restriction.
class Field final : public ImplicitSurface, public MaterialBlend {
 public:
  /// `terms` must not be empty; error_budget in units of T, > 0.
  Field(std::vector<Term> terms, double error_budget);
  ~Field() override;

  void values(std::span<const Vec3d> points, std::span<double> out) const override;
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override;
  /// Values and gradients are those of jets(). Where a far field approximates, its error in F is
  /// within the budget; that of its second derivative is that over the squared distance of what it
  /// approximates.
  void second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const override;
  Interval enclose(const Aabb& box) const override;
  void enclose_each(std::span<const Aabb> boxes, std::span<Interval> out) const override;
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override;
  double least_slope(const Aabb& box, const Vec3d& direction) const override;
  Rise rise(const Aabb& box, const Vec3d& gradient) const override;
  bool has_cheap_bounds() const override;
  bool has_cheap_hull_bounds() const override;
  double derivative_bound(int order, const Aabb& box) const override;
  /// In the exponent where all terms near are positive and of kernels without an end. Some 30 ns a
  /// Gaussian point near, 1 us another; with far fields, of all their terms. In restrictions of
  /// sums with cheap bounds, some 200 ns each of those that are near.
  HullBound hull_bound(std::span<const Vec3d> points,
                       std::span<const Vec3d> directions) const override;
  Aabb bounds() const override;
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb& box) const override;

  void shares(const Vec3d& point, std::vector<MaterialShare>& shares) const override;
  /// Points near each other cost less: the terms near all of them are found once.
  void blend(std::span<const Vec3d> points, std::span<const Vec3d> property,
             std::span<Vec3d> out) const override;

  /// F itself, T not subtracted and nothing left out.
  void full_jets(std::span<const Vec3d> points, std::span<Jet> out) const;
  std::size_t term_count() const;

 private:
  struct Enclosure;

  Field();
  template <class Out>
  void evaluate(std::span<const Vec3d> points, std::span<Out> out) const;
  void enclose_batch(std::span<const BatchBox> boxes, TaylorOrder order,
                     std::span<Enclosure> out) const;
  LogTerms log_terms_in(const Aabb& box) const;
  template <class F>
  void with_log_terms(const Aabb& box, const F& f) const;
  void enclose_in_exponents(std::span<const BatchBox> boxes, std::span<Interval> out) const;
  bool keeps_sign(const Aabb& box) const;
  Interval range_in_exponents(const LogTerms& terms, LogSum& sum) const;
  bool keeps_sign_in_exponents(const LogTerms& terms, LogSum& sum) const;
  double slope_in_exponents(const LogTerms& terms, const LogSum& sum, const Vec3d& direction) const;
  Interval enclose_in_parts(const Aabb& box, const Enclosure& whole) const;
  void enclose_by_near_sum(std::span<const BatchBox> boxes, std::span<Interval> out) const;
  void near_terms(const Aabb& box, std::vector<std::uint32_t>& found) const;
  double turn() const;
  bool knows_turn(const Aabb& box) const;
  void plain_jets(std::span<const Vec3d> points, std::vector<std::uint32_t>& profiled,
                  std::span<Jet> out) const;
  void enclose_by_turn(std::span<const BatchBox> boxes, std::span<Enclosure> out) const;
  double least_slope_by_turn(const BatchBox& box, const Vec3d& direction) const;

  std::shared_ptr<const FieldData> data_;
  /// Where this is a restriction: the terms that reach its box, in ascending order.
  bool restricted_ = false;
  Aabb box_;  ///< of the restriction
  /// Once asked for, a bound over box_ of the second derivative of all terms without profiles.
  mutable std::atomic<double> turn_{-1.0};
  /// And one of the size of all terms that are subtracted, set before it.
  mutable std::atomic<double> subtracted_{0.0};
  /// And its terms for bounds in the exponent.
  MadeOnce<LogTerms> log_terms_;
  std::vector<std::uint32_t> candidates_;
  /// What bounds over small boxes need of the restriction; null where they are not cheap.
  std::shared_ptr<const LazyNearSum> near_sum_;
  /// All candidates reach every block of the restriction's box: its one list.
  bool uniform_ = false;
};

}  // namespace cs2mesh
