// How often a surface is asked, whoever asks: a surface like another that counts on the way.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

/// Evaluations of F. A jet counts as one value and one gradient, a second jet as one of each.
struct Evaluations {
  std::uint64_t values = 0, gradients = 0, hessians = 0;
  /// Boxes over which F, its gradient, its slope or a derivative was bounded, each question apart.
  std::uint64_t enclosures = 0;

  Evaluations& operator+=(const Evaluations& other);
  friend Evaluations operator-(Evaluations a, const Evaluations& b);
  friend bool operator==(const Evaluations&, const Evaluations&) = default;
};

/// Adds up evaluations from any number of threads at once; each of the first 255 of the process
/// adds to a place of its own, so that they do not wait for each other.
class EvaluationCounter {
 public:
  void add(const Evaluations& more);
  /// Of all threads, so far. What is added at the same time may be in it or not.
  Evaluations total() const;

 private:
  struct alignas(64) Place {
    std::array<std::atomic<std::uint64_t>, 4> counts{};
  };
  static constexpr std::size_t kPlaces = 256;  ///< the last is shared
  std::array<Place, kPlaces> places_;
};

/// The surface itself, to the bit, with each question counted, also those that its restrictions are
/// asked. What a surface asks of itself to answer one is not. Costs nanoseconds a question, which
/// may be for many points at once.
class CountedSurface final : public ImplicitSurface {
 public:
  /// `counter` outlives this and all restrictions; neither is null (else ContractViolation).
  CountedSurface(std::shared_ptr<const ImplicitSurface> surface, EvaluationCounter* counter);

  void values(std::span<const Vec3d> points, std::span<double> out) const override;
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override;
  void second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const override;
  Interval enclose(const Aabb& box) const override;
  void enclose_each(std::span<const Aabb> boxes, std::span<Interval> out) const override;
  std::array<Interval, 3> enclose_gradient(const Aabb& box) const override;
  double least_slope(const Aabb& box, const Vec3d& direction) const override;
  Rise rise(const Aabb& box, const Vec3d& gradient) const override;
  HullBound hull_bound(std::span<const Vec3d> points,
                       std::span<const Vec3d> directions) const override;
  bool has_cheap_bounds() const override { return surface_->has_cheap_bounds(); }
  bool has_cheap_hull_bounds() const override { return surface_->has_cheap_hull_bounds(); }
  double derivative_bound(int order, const Aabb& box) const override;
  Aabb bounds() const override { return surface_->bounds(); }
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb& box) const override;

 private:
  std::shared_ptr<const ImplicitSurface> surface_;
  EvaluationCounter* counter_;
};

}  // namespace cs2mesh
