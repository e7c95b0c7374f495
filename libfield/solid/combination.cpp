#include "libfield/solid/combination.h"

#include <algorithm>
#include <limits>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

/// Takes over from `other` where that decides.
template <class Out>
void decide(CombinationKind kind, std::span<const Out> other, std::span<Out> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool decides = kind == CombinationKind::intersection ? other[i].value < out[i].value
                                                               : other[i].value > out[i].value;
    if (decides) out[i] = other[i];
  }
}

}  // namespace

Combination::Combination(CombinationKind kind,
                         std::vector<std::shared_ptr<const ImplicitSurface>> parts)
    : kind_(kind), parts_(std::move(parts)) {
  require(!parts_.empty(), "a combination needs parts");
}

void Combination::values(std::span<const Vec3d> points, std::span<double> out) const {
  parts_[0]->values(points, out);
  std::vector<double> other(points.size());
  for (std::size_t k = 1; k < parts_.size(); ++k) {
    parts_[k]->values(points, other);
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = kind_ == CombinationKind::intersection ? std::min(out[i], other[i])
                                                      : std::max(out[i], other[i]);
    }
  }
}

void Combination::jets(std::span<const Vec3d> points, std::span<Jet> out) const {
  parts_[0]->jets(points, out);
  std::vector<Jet> other(points.size());
  for (std::size_t k = 1; k < parts_.size(); ++k) {
    parts_[k]->jets(points, other);
    decide<Jet>(kind_, other, out);
  }
}

void Combination::second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const {
  parts_[0]->second_jets(points, out);
  std::vector<Jet2> other(points.size());
  for (std::size_t k = 1; k < parts_.size(); ++k) {
    parts_[k]->second_jets(points, other);
    decide<Jet2>(kind_, other, out);
  }
}

Interval Combination::enclose(const Aabb& box) const {
  Interval range = parts_[0]->enclose(box);
  for (std::size_t k = 1; k < parts_.size(); ++k) {
    const Interval other = parts_[k]->enclose(box);
    range = kind_ == CombinationKind::intersection
                ? Interval(std::min(range.lo, other.lo), std::min(range.hi, other.hi))
                : Interval(std::max(range.lo, other.lo), std::max(range.hi, other.hi));
  }
  return range;
}

std::vector<const ImplicitSurface*> Combination::deciding(const Aabb& box) const {
  std::vector<Interval> ranges;
  for (const auto& part : parts_) ranges.push_back(part->enclose(box));
  const Interval all = enclose(box);
  std::vector<const ImplicitSurface*> found;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const bool may =
        kind_ == CombinationKind::intersection ? ranges[k].lo <= all.hi : ranges[k].hi >= all.lo;
    if (may) found.push_back(parts_[k].get());
  }
  return found;
}

std::array<Interval, 3> Combination::enclose_gradient(const Aabb& box) const {
  const auto candidates = deciding(box);
  std::array<Interval, 3> gradient = candidates[0]->enclose_gradient(box);
  for (std::size_t k = 1; k < candidates.size(); ++k) {
    const std::array<Interval, 3> other = candidates[k]->enclose_gradient(box);
    for (std::size_t axis = 0; axis < 3; ++axis) gradient[axis] = hull(gradient[axis], other[axis]);
  }
  return gradient;
}

double Combination::derivative_bound(int order, const Aabb& box) const {
  const auto candidates = deciding(box);
  if (order >= 2 && candidates.size() > 1) return std::numeric_limits<double>::infinity();
  double most = 0;
  for (const ImplicitSurface* part : candidates) {
    most = std::max(most, part->derivative_bound(order, box));
  }
  return most;
}

Aabb Combination::bounds() const {
  Aabb box = parts_[0]->bounds();
  for (std::size_t k = 1; k < parts_.size(); ++k) {
    const Aabb other = parts_[k]->bounds();
    if (kind_ == CombinationKind::union_of) {
      box.include(other);
    } else {
      box = {max(box.min, other.min), min(box.max, other.max)};
    }
  }
  return box;
}

std::unique_ptr<ImplicitSurface> Combination::restrict_to(const Aabb& box) const {
  const auto candidates = deciding(box);
  if (candidates.size() == 1) return candidates[0]->restrict_to(box);
  std::vector<std::shared_ptr<const ImplicitSurface>> parts;
  parts.reserve(candidates.size());
  for (const ImplicitSurface* part : candidates) parts.push_back(part->restrict_to(box));
  return std::make_unique<Combination>(kind_, std::move(parts));
}

}  // namespace cs2mesh
