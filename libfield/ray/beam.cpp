#include "libfield/ray/beam.h"

#include <algorithm>
#include <cmath>

namespace cs2mesh {
namespace {

Interval square(const Interval& a) {
  const double far = a.magnitude();
  const double near = a.contains(0.0) ? 0.0 : std::min(std::abs(a.lo), std::abs(a.hi));
  return {std::max(0.0, next_down(near * near)), next_up(far * far)};
}

}  // namespace

Beam::Beam(const View& view, double x0, double y0, double x1, double y1) {
  // Places in the picture are rounded; a few ulps cover that.
  const auto padded = [](double a, double b, double half) {
    return widened(Interval(half) * Interval(a, b), 1e-15 * half);
  };
  const Interval right = padded(2.0 * x0 - 1.0, 2.0 * x1 - 1.0, view.half_width);
  const Interval up = padded(1.0 - 2.0 * y1, 1.0 - 2.0 * y0, view.half_height);
  std::array<Interval, 3> offset;
  for (std::size_t k = 0; k < 3; ++k) {
    offset[k] = right * Interval(view.right[k]) + up * Interval(view.up[k]);
  }
  if (view.orthographic) {
    for (std::size_t k = 0; k < 3; ++k) {
      origin_[k] = Interval(view.eye[k]) + offset[k];
      direction_[k] = view.forward[k];
    }
    return;
  }
  // The length of forward + offset, from the orthonormal axes; 1e-14 for their rounding.
  const Interval length2 = widened(Interval(1.0) + square(right) + square(up), 1e-14);
  const double least = std::sqrt(length2.lo) * (1.0 - 1e-15);
  const double most = std::sqrt(length2.hi) * (1.0 + 1e-15);
  for (std::size_t k = 0; k < 3; ++k) {
    origin_[k] = view.eye[k];
    const Interval reciprocal(next_down(1.0 / most), next_up(1.0 / least));
    direction_[k] = widened((Interval(view.forward[k]) + offset[k]) * reciprocal, 1e-15);
  }
}

Aabb Beam::box(double t0, double t1) const {
  Aabb box;
  for (std::size_t k = 0; k < 3; ++k) {
    const Interval side = origin_[k] + Interval(t0, t1) * direction_[k];
    box.min[k] = side.lo;
    box.max[k] = side.hi;
  }
  return box;
}

double Beam::width(double t) const {
  Vec3d side;
  for (std::size_t k = 0; k < 3; ++k) side[k] = origin_[k].width() + t * direction_[k].width();
  return norm(side);
}

std::vector<RayRange> occupied_ranges(const ImplicitSurface& surface, const Beam& beam,
                                      const std::vector<RayRange>& known, RayCost* cost) {
  // A solver starts and ends clearly outside bounds that the surface touches; so do the ranges.
  Aabb bounds = surface.bounds();
  if (bounds.empty()) return {};
  if (!bounds.finite()) return known;
  bounds = bounds.grown(2e-6 * bounds.diagonal());

  // No point of the bounds has a larger t.
  const Aabb start = beam.box(0.0, 0.0);
  const double farthest =
      bounds.farthest_distance(start.center()) + start.diagonal() + bounds.diagonal();

  // Halve the known ranges until pieces are as long as wide; near the eye, a 256th of the bounds
  // will do.
  std::vector<RayRange> occupied;
  std::vector<RayRange> stack;
  for (auto range = known.rbegin(); range != known.rend(); ++range) {
    if (range->t0 < farthest) stack.push_back({range->t0, std::min(range->t1, farthest)});
  }
  while (!stack.empty()) {
    const RayRange piece = stack.back();
    stack.pop_back();
    const Aabb box = beam.box(piece.t0, piece.t1);
    if (!box.overlaps(bounds)) continue;
    if (cost) ++cost->bounds;
    const Interval range = surface.enclose(box);
    if (range.lo > 0.0 || range.hi < 0.0) continue;
    const double length = piece.t1 - piece.t0;
    if (length <= std::max(beam.width(piece.t1), bounds.diagonal() / 256.0)) {
      if (!occupied.empty() && occupied.back().t1 == piece.t0) {
        occupied.back().t1 = piece.t1;
      } else {
        occupied.push_back(piece);
      }
      continue;
    }
    const double middle = 0.5 * (piece.t0 + piece.t1);
    stack.push_back({middle, piece.t1});
    stack.push_back({piece.t0, middle});
  }
  return occupied;
}

}  // namespace cs2mesh
