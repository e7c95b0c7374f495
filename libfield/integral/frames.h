// What the closed forms need of a primitive and does not depend on the point: unit axes, lengths,
// fixed nodes. Computed once a primitive, used for any number of points.
//
// Coordinates are expected within 1e70 in absolute value, where products of four lengths stay
// finite; a primitive without extent gives 0.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "libfield/base/vec.h"
#include "libfield/integral/gauss_legendre.h"
#include "libfield/primitive/arc.h"
#include "libfield/primitive/segment.h"
#include "libfield/primitive/tapered_segment.h"
#include "libfield/primitive/triangle.h"
#include "libfield/simd/lanes.h"

namespace cs2mesh {

/// Squared distances from which a kernel of any usable width has vanished.
inline constexpr double kFarSquared = 1e280;

/// The unit vector along `v`, or zero for zero, without overflow or underflow on the way.
template <class T>
Vec3<T> unit_or_zero(const Vec3<T>& v) {
  using std::abs;
  using std::max;
  const T x = abs(v.x), y = abs(v.y), z = abs(v.z);
  const T scale = max(x, max(y, z));
  if (!(scale > T(0))) return {};
  const Vec3<T> scaled = v / scale;
  return scaled / norm(scaled);
}

template <class T>
struct SegmentFrame {
  Vec3<T> a, b;
  Vec3<T> axis;  ///< unit, from a to b
  T length;

  explicit SegmentFrame(const Segment& segment) : a(segment.a), b(segment.b) {
    axis = unit_or_zero(b - a);
    length = dot(b - a, axis);
  }
  /// The same frame in another number type.
  template <class U>
  explicit SegmentFrame(const SegmentFrame<U>& f)
      : a(f.a), b(f.b), axis(f.axis), length(f.length) {}
};

template <class T>
struct TaperedFrame {
  SegmentFrame<T> axis;
  T inverse_length;  ///< finite: shorter ones count as of 1e-300
  T b0, b1, b2;      ///< of the weight

  explicit TaperedFrame(const TaperedSegment& segment)
      : axis(segment.axis),
        inverse_length(T(1) / (axis.length > T(1e-300) ? axis.length : T(1e-300))),
        b0(segment.weight.b0),
        b1(segment.weight.b1),
        b2(segment.weight.b2) {}
  /// The same frame in another number type.
  template <class U>
  explicit TaperedFrame(const TaperedFrame<U>& f)
      : axis(f.axis), inverse_length(f.inverse_length), b0(f.b0), b1(f.b1), b2(f.b2) {}
};

template <class T>
struct ArcFrame {
  Vec3<T> center, ex, ey, normal;
  T radius, sweep;
  T cos_quarter, sin_quarter, sin_half;  ///< of the sweep
  /// Places of a 14- and an 8-point rule on the arc, in units of the radius along ex and ey: node i
  /// and its mirror image about ex.
  std::array<double, 7> node14_x{}, node14_y{};
  std::array<double, 4> node8_x{}, node8_y{};
  /// sinh^2(chi / 2) for the distance chi of the poles from the real axis of the azimuth from which
  /// those rules suffice, wherever on the axis they are: 2 chi = reach times sweep.
  double far14, far8;

  explicit ArcFrame(const Arc& arc)
      : center(arc.center),
        ex(arc.ex),
        ey(arc.ey),
        normal(arc.normal),
        radius(arc.radius),
        sweep(arc.sweep) {
    using std::cos;
    using std::sin;
    cos_quarter = cos(sweep / T(4));
    sin_quarter = sin(sweep / T(4));
    // Never negative, so that a full circle's angle is +pi rather than -pi.
    sin_half = std::max(T(T(2) * sin_quarter * cos_quarter), T(0));
    place(arc.sweep, kGaussLegendre<14>.node, node14_x, node14_y);
    place(arc.sweep, kGaussLegendre<8>.node, node8_x, node8_y);
    far14 = squared_sinh(0.25 * kReach14 * arc.sweep);
    far8 = squared_sinh(0.25 * kReach8 * arc.sweep);
  }
  /// The same frame in another number type.
  template <class U>
  explicit ArcFrame(const ArcFrame<U>& f)
      : center(f.center),
        ex(f.ex),
        ey(f.ey),
        normal(f.normal),
        radius(f.radius),
        sweep(f.sweep),
        cos_quarter(f.cos_quarter),
        sin_quarter(f.sin_quarter),
        sin_half(f.sin_half),
        node14_x(f.node14_x),
        node14_y(f.node14_y),
        node8_x(f.node8_x),
        node8_y(f.node8_y),
        far14(f.far14),
        far8(f.far8) {}

 private:
  template <std::size_t N>
  static void place(double sweep, const std::array<double, N>& node, std::array<double, N>& x,
                    std::array<double, N>& y) {
    for (std::size_t i = 0; i < N; ++i) {
      x[i] = std::cos(0.5 * sweep * node[i]);
      y[i] = std::sin(0.5 * sweep * node[i]);
    }
  }
  static double squared_sinh(double x) { return std::sinh(x) * std::sinh(x); }
};

/// The longest edge is the base, from vertex 0 to vertex 1; the apex is vertex 2.
template <class T>
struct TriangleFrame {
  struct Edge {
    Vec3<T> along;    ///< unit, counter-clockwise about the normal
    Vec3<T> outward;  ///< unit, in the plane
    T length;
  };
  std::array<Vec3<T>, 3> vertex;
  std::array<Edge, 3> edge;  ///< edge[i] from vertex i to vertex i + 1
  Vec3<T> normal;            ///< unit; zero for a triangle without area
  T height;                  ///< of the apex over the base
  T foot;                    ///< abscissa of the apex on the base, in [0, edge[0].length]

  explicit TriangleFrame(const Triangle& triangle) {
    std::size_t base = 0;
    double longest = -1.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double length = norm(triangle.vertex[(i + 1) % 3] - triangle.vertex[i]);
      if (length > longest) longest = length, base = i;
    }
    for (std::size_t i = 0; i < 3; ++i) vertex[i] = Vec3<T>(triangle.vertex[(base + i) % 3]);
    // The apex over the base from its nearer end. In a sliver the first projection leaves a part
    // along the base; the second removes it, so that the frame is orthogonal to rounding.
    const Vec3<T> left = vertex[2] - vertex[0];
    const Vec3<T> right = vertex[2] - vertex[1];
    const Vec3<T> along = unit_or_zero(vertex[1] - vertex[0]);
    const Vec3<T> side = squared_norm(left) < squared_norm(right) ? left : right;
    Vec3<T> up = unit_or_zero(side - dot(side, along) * along);
    up = unit_or_zero(up - dot(up, along) * along);
    normal = cross(along, up);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3<T> between = vertex[(i + 1) % 3] - vertex[i];
      edge[i].along = unit_or_zero(between);
      edge[i].outward = cross(edge[i].along, normal);
      edge[i].length = dot(between, edge[i].along);
    }
    height = dot(side, up);
    const T length = edge[0].length;
    foot = std::min(std::max(T(dot(left, along)), T(0)), length);
  }
  /// The same frame in another number type.
  template <class U>
  explicit TriangleFrame(const TriangleFrame<U>& f)
      : normal(f.normal), height(f.height), foot(f.foot) {
    for (std::size_t i = 0; i < 3; ++i) {
      vertex[i] = Vec3<T>(f.vertex[i]);
      edge[i] = {Vec3<T>(f.edge[i].along), Vec3<T>(f.edge[i].outward), T(f.edge[i].length)};
    }
  }
};

}  // namespace cs2mesh
