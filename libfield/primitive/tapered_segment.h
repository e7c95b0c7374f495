// A segment that carries a weight along itself, inside of the convolution integral: f(p) is the
// integral of w(x) h(|p - q(x)|) over it. The surface of such a bone tapers and stays as smooth as
// the kernel, which a strength profile, that multiplies the finished field, does not promise.
#pragma once

#include "libfield/base/interval.h"
#include "libfield/primitive/segment.h"

namespace cs2mesh {

/// w(x) = b0 (1 - x)^2 + 2 b1 x (1 - x) + b2 x^2 for x from 0 at the start to 1 at the end: any
/// quadratic function, in the basis in which no digits cancel where all three are >= 0, and in
/// which a part, the reverse and the mean of w are sums of few terms. b0 and b2 are the weights at
/// the ends; w runs within the least and the greatest of the three.
struct SegmentWeight {
  double b0 = 1.0, b1 = 1.0, b2 = 1.0;
  friend bool operator==(const SegmentWeight&, const SegmentWeight&) = default;
};

/// The linear weight with those values at the ends.
inline SegmentWeight linear_weight(double start, double end) {
  return {start, 0.5 * start + 0.5 * end, end};
}
/// The quadratic weight with those values at the ends and in the middle.
inline SegmentWeight quadratic_weight(double start, double middle, double end) {
  return {start, 2.0 * middle - (0.5 * start + 0.5 * end), end};
}
/// Its value in the middle: that of which quadratic_weight() makes the same weight again.
inline double middle_value(const SegmentWeight& w) {
  return 0.5 * ((0.5 * w.b0 + 0.5 * w.b2) + w.b1);
}
/// w(x).
inline double value_at(const SegmentWeight& w, double x) {
  const double y = 1.0 - x;
  return (w.b0 * y + 2.0 * w.b1 * x) * y + w.b2 * x * x;
}
/// Its mean over [0, 1].
inline double mean(const SegmentWeight& w) {
  return (w.b0 + w.b1 + w.b2) / 3.0;
}
/// Contains w(x) for all x in [0, 1]; tight to rounding.
Interval range(const SegmentWeight& w);

/// Its measure is the length of its axis; the weight is no part of it.
struct TaperedSegment {
  static constexpr int kDimension = 1;
  Segment axis;
  SegmentWeight weight;
};

inline double measure(const TaperedSegment& segment) {
  return measure(segment.axis);
}
inline double distance(const TaperedSegment& segment, const Vec3d& p) {
  return distance(segment.axis, p);
}
inline Aabb bounds(const TaperedSegment& segment) {
  return bounds(segment.axis);
}
inline Vec3d middle(const TaperedSegment& segment) {
  return middle(segment.axis);
}
inline double size(const TaperedSegment& segment) {
  return size(segment.axis);
}
/// The coordinates of its axis.
inline Uv uv(const TaperedSegment& segment, const Vec3d& p) {
  return uv(segment.axis, p);
}
inline UvIntervals enclose_uv(const TaperedSegment& segment, const Aabb& box) {
  return enclose_uv(segment.axis, box);
}
/// The image under the map, with the same weight. Any map.
inline TaperedSegment transformed(const TaperedSegment& segment, const Affine& map) {
  return {transformed(segment.axis, map), segment.weight};
}

}  // namespace cs2mesh
