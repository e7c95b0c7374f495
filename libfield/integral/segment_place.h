// Where a point is as seen from a segment; see segment forms for what follows from it.
#pragma once

#include "libfield/integral/frames.h"

namespace cs2mesh {

/// t is the abscissa along the segment counted from the foot of p on its line.
template <class T>
struct SegmentPlace {
  T t1, t2;        ///< of the ends
  Vec3<T> perp;    ///< from the line to p
  T c2;            ///< |perp|^2
  MaskOf<T> near;  ///< coordinates small enough for the arithmetic that follows

  SegmentPlace(const SegmentFrame<T>& segment, const Vec3<T>& p) : near(true) {
    using std::abs;
    const Vec3<T> da = p - segment.a;
    const Vec3<T> db = p - segment.b;
    near = squared_norm(da) < T(kFarSquared);
    t1 = -dot(da, segment.axis);
    t2 = -dot(db, segment.axis);
    // From the nearer end: its difference carries the smaller rounding error.
    const auto first = abs(t1) < abs(t2);
    perp = select(first, da, db) + select(first, t1, t2) * segment.axis;
    c2 = squared_norm(perp);
  }
};

}  // namespace cs2mesh
