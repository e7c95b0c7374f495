#include "polygonize/crossing_count.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cs2mesh {
namespace {

constexpr int kMany = 2;

/// F and its derivative along a piece of the segment, by which the piece is as long as 1.
struct Sample {
  double value = 0.0, slope = 0.0;
};

bool same_side(double f, double g) {
  return (f >= 0) == (g >= 0);
}

/// Whether F keeps its side between two samples, if its second derivative is at most `bend`: in
/// each half by the sample at its end.
bool keeps_side(const Sample& at, const Sample& then, double bend) {
  if (!same_side(at.value, then.value)) return false;
  const double sign = at.value >= 0 ? 1.0 : -1.0;
  return sign * (at.value + 0.5 * at.slope) > 0.125 * bend &&
         sign * (then.value - 0.5 * then.slope) > 0.125 * bend;
}

/// Whether F grows or falls all the way between them.
bool is_monotone(const Sample& at, const Sample& then, double bend) {
  return std::max(std::abs(at.slope), std::abs(then.slope)) > bend;
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

}  // namespace

int count_crossings(const ImplicitSurface& surface, const Vec3d& a, const Jet& at_a, const Vec3d& b,
                    FieldCounts& counts) {
  constexpr std::size_t kPieces = 4;
  const Vec3d step = 1.0 / kPieces * (b - a);
  const double bend = surface.derivative_bound(2, Aabb{min(a, b), max(a, b)}) * squared_norm(step);
  std::array<Vec3d, kPieces> points;
  std::array<Jet, kPieces> jets;
  for (std::size_t i = 0; i < kPieces; ++i) points[i] = a + static_cast<double>(i + 1) * step;
  surface.jets(points, jets);
  counts.values += kPieces;
  counts.gradients += kPieces;
  int crossings = 0;
  Vec3d from = a;
  Sample at{at_a.value, dot(at_a.gradient, step)};
  for (std::size_t i = 0; i < kPieces; ++i) {
    const Sample then{jets[i].value, dot(jets[i].gradient, step)};
    if (!keeps_side(at, then, bend)) {
      if (!is_monotone(at, then, bend) &&
          !is_graph(surface, from, points[i], then.value - at.value, counts)) {
        return kMany;
      }
      if (!same_side(at.value, then.value)) ++crossings;
    }
    from = points[i];
    at = then;
  }
  return std::min(crossings, kMany);
}

}  // namespace cs2mesh
