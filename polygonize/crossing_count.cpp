#include "polygonize/crossing_count.h"

#include <algorithm>
#include <cmath>

namespace cs2mesh {
namespace {

constexpr int kMany = 2;

/// A point of the segment, and F there.
struct Sample {
  Vec3d point;
  double value = 0.0;
  double slope = 0.0;  ///< along the segment, for all of its length
};

bool same_side(double f, double g) {
  return (f >= 0) == (g >= 0);
}

/// Whether F keeps its side between two samples that are `share` of the segment apart, if its
/// second derivative is at most `bend` for that piece: in each half by the sample at its end.
bool keeps_side(const Sample& at, const Sample& then, double share, double bend) {
  if (!same_side(at.value, then.value)) return false;
  const double sign = at.value >= 0 ? 1.0 : -1.0;
  return sign * (at.value + 0.5 * share * at.slope) > 0.125 * bend &&
         sign * (then.value - 0.5 * share * then.slope) > 0.125 * bend;
}

/// Whether F has one zero at most between a and b.
bool is_graph(const ImplicitSurface& surface, const Vec3d& a, const Vec3d& b, double rise,
              FieldCounts& counts) {
  const Aabb box{min(a, b), max(a, b)};
  ++counts.enclosures;
  const Interval range = surface.enclose(box);
  if (range.lo > 0 || range.hi < 0) return true;
  const Vec3d up = rise >= 0 ? b - a : a - b;
  counts.slopes += 2;
  return surface.least_slope(box, up) > 0 || surface.least_slope(box, -up) > 0;
}

class CrossingCounter {
 public:
  CrossingCounter(const ImplicitSurface& surface, const Vec3d& way, double bend,
                  FieldCounts& counts)
      : surface_(surface), way_(way), bend_(bend), counts_(counts) {}

  Sample sample(const Vec3d& point, const Jet& jet) const {
    return {point, jet.value, dot(jet.gradient, way_)};
  }
  Sample sample(const Vec3d& point) const {
    ++counts_.values;
    ++counts_.gradients;
    return sample(point, surface_.jet(point));
  }

  /// Between samples that are `share` of the segment apart, which may be halved so many times.
  int between(const Sample& at, const Sample& then, double share, int halvings) const {
    const double bend = share * share * bend_;
    if (keeps_side(at, then, share, bend)) return 0;
    const int told = same_side(at.value, then.value) ? 0 : 1;
    const bool monotone = share * std::max(std::abs(at.slope), std::abs(then.slope)) > bend;
    if (monotone) return told;
    if (halvings == 0) {
      const double rise = then.value - at.value;
      return is_graph(surface_, at.point, then.point, rise, counts_) ? told : kMany;
    }
    const Sample middle = sample(0.5 * (at.point + then.point));
    const int first = between(at, middle, 0.5 * share, halvings - 1);
    if (first == kMany) return kMany;
    return std::min(first + between(middle, then, 0.5 * share, halvings - 1), kMany);
  }

 private:
  const ImplicitSurface& surface_;
  Vec3d way_;
  double bend_;
  FieldCounts& counts_;
};

}  // namespace

int count_crossings(const ImplicitSurface& surface, const Vec3d& a, const Jet& at_a, const Vec3d& b,
                    FieldCounts& counts) {
  constexpr int kHalvings = 2;
  const Vec3d way = b - a;
  const double bend = surface.derivative_bound(2, Aabb{min(a, b), max(a, b)}) * squared_norm(way);
  const CrossingCounter counter(surface, way, bend, counts);
  return counter.between(counter.sample(a, at_a), counter.sample(b), 1.0, kHalvings);
}

}  // namespace cs2mesh
