#include "libfield/field/counted_surface.h"

#include <algorithm>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

/// The number of the calling thread, in the order in which threads first count.
std::size_t thread_number() {
  static std::atomic<std::size_t> next{0};
  thread_local const std::size_t number = next++;
  return number;
}

/// Of F, its gradient or a bound of either, over so many boxes.
Evaluations enclosed(std::size_t boxes) {
  Evaluations count;
  count.enclosures = boxes;
  return count;
}

}  // namespace

Evaluations& Evaluations::operator+=(const Evaluations& other) {
  values += other.values;
  gradients += other.gradients;
  hessians += other.hessians;
  enclosures += other.enclosures;
  return *this;
}

Evaluations operator-(Evaluations a, const Evaluations& b) {
  a.values -= b.values;
  a.gradients -= b.gradients;
  a.hessians -= b.hessians;
  a.enclosures -= b.enclosures;
  return a;
}

void EvaluationCounter::add(const Evaluations& more) {
  const std::size_t number = thread_number();
  auto& counts = places_[std::min(number, kPlaces - 1)].counts;
  const bool own = number < kPlaces - 1;
  const std::array<std::uint64_t, 4> added{more.values, more.gradients, more.hessians,
                                           more.enclosures};
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (added[i] == 0) continue;
    // Nobody else writes to a thread's own place, so that it need not be locked to add.
    if (own) {
      counts[i].store(counts[i].load(std::memory_order_relaxed) + added[i],
                      std::memory_order_relaxed);
    } else {
      counts[i].fetch_add(added[i], std::memory_order_relaxed);
    }
  }
}

Evaluations EvaluationCounter::total() const {
  Evaluations sum;
  for (const Place& place : places_) {
    const auto of = [&place](std::size_t i) {
      return place.counts[i].load(std::memory_order_relaxed);
    };
    sum += {of(0), of(1), of(2), of(3)};
  }
  return sum;
}

CountedSurface::CountedSurface(std::shared_ptr<const ImplicitSurface> surface,
                               EvaluationCounter* counter)
    : surface_(std::move(surface)), counter_(counter) {
  require(surface_ != nullptr && counter_ != nullptr, "CountedSurface: a surface and a counter");
}

void CountedSurface::values(std::span<const Vec3d> points, std::span<double> out) const {
  counter_->add({points.size(), 0, 0, 0});
  surface_->values(points, out);
}

void CountedSurface::jets(std::span<const Vec3d> points, std::span<Jet> out) const {
  counter_->add({points.size(), points.size(), 0, 0});
  surface_->jets(points, out);
}

void CountedSurface::second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const {
  counter_->add({points.size(), points.size(), points.size(), 0});
  surface_->second_jets(points, out);
}

Interval CountedSurface::enclose(const Aabb& box) const {
  counter_->add(enclosed(1));
  return surface_->enclose(box);
}

void CountedSurface::enclose_each(std::span<const Aabb> boxes, std::span<Interval> out) const {
  counter_->add(enclosed(boxes.size()));
  surface_->enclose_each(boxes, out);
}

std::array<Interval, 3> CountedSurface::enclose_gradient(const Aabb& box) const {
  counter_->add(enclosed(1));
  return surface_->enclose_gradient(box);
}

double CountedSurface::least_slope(const Aabb& box, const Vec3d& direction) const {
  counter_->add(enclosed(1));
  return surface_->least_slope(box, direction);
}

Rise CountedSurface::rise(const Aabb& box, const Vec3d& gradient) const {
  counter_->add(enclosed(1));
  return surface_->rise(box, gradient);
}

HullBound CountedSurface::hull_bound(std::span<const Vec3d> points,
                                     std::span<const Vec3d> directions) const {
  counter_->add(enclosed(1));
  return surface_->hull_bound(points, directions);
}

double CountedSurface::derivative_bound(int order, const Aabb& box) const {
  counter_->add(enclosed(1));
  return surface_->derivative_bound(order, box);
}

std::unique_ptr<ImplicitSurface> CountedSurface::restrict_to(const Aabb& box) const {
  return std::make_unique<CountedSurface>(surface_->restrict_to(box), counter_);
}

}  // namespace cs2mesh
