#include "polygonize/grower.h"

#include <algorithm>
#include <boost/container/static_vector.hpp>
#include <cmath>
#include <memory>

namespace cs2mesh {
namespace {

/// How often a box may be cut before it counts as not proven, and after how many times what is
/// asked is restricted to what is left of it.
constexpr int kMostCuts = 4, kRestrictedAfter = 2;

}  // namespace

bool Grower::grows_along(const Aabb& box) {
  ++slopes;
  if (surface.least_slope(box, direction) > 0) return true;
  return grows_in_parts(surface, box, 0);
}

bool Grower::grows_somehow(const Aabb& box) {
  ++slopes;
  const Rise rise = surface.rise(box, direction);
  if (rise.slope > 0) return true;
  direction = rise.direction;
  return grows_in_parts(surface, box, 0);
}

/// In halves first, which will do more often than not, then those in quarters, and so on. A few
/// questions are cheaper than a restriction; with more, what is far is better settled once.
bool Grower::grows_in_parts(const ImplicitSurface& part, const Aabb& box, int cuts) {
  if (cuts == kMostCuts) return false;
  const std::unique_ptr<const ImplicitSurface> own =
      cuts == kRestrictedAfter ? part.restrict_to(box) : nullptr;
  const ImplicitSurface& inner = own ? *own : part;
  boost::container::static_vector<Aabb, 4> parts;
  for (const Aabb& half : halves(box)) {
    if (cuts % 2 == 0) {
      parts.push_back(half);
    } else {
      for (const Aabb& quarter : halves(half)) parts.push_back(quarter);
    }
  }
  for (const Aabb& smaller : parts) {
    ++slopes;
    if (inner.least_slope(smaller, direction) > 0) continue;
    if (!grows_in_parts(inner, smaller, cuts + 1)) return false;
  }
  return true;
}

/// Of the longest sides, that which is most along the direction is halved: the surface is likely
/// to miss much of one half.
std::array<Aabb, 2> Grower::halves(const Aabb& box) const {
  constexpr double kAlmost = 0.9;
  const Vec3d extent = box.extent();
  const double longest = std::max({extent.x, extent.y, extent.z});
  std::size_t axis = 3;
  for (std::size_t k = 0; k < 3; ++k) {
    if (extent[k] < kAlmost * longest) continue;
    if (axis == 3 || std::abs(direction[k]) > std::abs(direction[axis])) axis = k;
  }
  std::array<Aabb, 2> found{box, box};
  found[0].max[axis] = found[1].min[axis] = box.center()[axis];
  return found;
}

}  // namespace cs2mesh
