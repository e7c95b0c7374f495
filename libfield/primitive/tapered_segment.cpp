#include "libfield/primitive/tapered_segment.h"

#include <algorithm>
#include <cmath>

namespace cs2mesh {

Interval range(const SegmentWeight& w) {
  Interval found(std::min(w.b0, w.b2), std::max(w.b0, w.b2));
  // dw/dx = 2 ((b1 - b0) (1 - x) + (b2 - b1) x) vanishes between the ends where b1 lies outside of
  // what they span; there w = b1 - (b1 - b0) (b1 - b2) / ((b1 - b0) + (b1 - b2)).
  const double rise = w.b1 - w.b0, fall = w.b1 - w.b2;
  if ((rise > 0 && fall > 0) || (rise < 0 && fall < 0)) {
    found = hull(found, w.b1 - rise * (fall / (rise + fall)));
  }
  return widened(found, 1e-15 * std::max({std::abs(w.b0), std::abs(w.b1), std::abs(w.b2)}));
}

}  // namespace cs2mesh
