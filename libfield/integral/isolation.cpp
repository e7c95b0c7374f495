#include "libfield/integral/isolation.h"

#include <cmath>
#include <limits>

#include "libfield/integral/integral.h"
#include "libfield/integral/line_field.h"

namespace cs2mesh {

double kernel_width(KernelKind kind, double radius, double blobbiness) {
  const double b = -blobbiness;
  switch (kind) {
    case KernelKind::cauchy:
    case KernelKind::gaussian:
      return std::sqrt(b) / radius;
    case KernelKind::inverse:
    case KernelKind::squared:
      return 0.0;
    case KernelKind::metaball:
      return radius * (b >= 0.5 ? (1.0 + b) / b : std::sqrt(3.0 * (1.0 + b) / b));
    case KernelKind::soft: {
      const double e = 5.0 * b - 2.0;
      const double root = std::sqrt(e * e + 160.0 * b + 480.0);
      // e + root cancels for e < 0.
      const double v = 20.0 / (e >= 0.0 ? e + root : (160.0 * b + 480.0) / (root - e));
      const double x = b * v * (5.0 + 4.0 * v) / (10.0 + 12.0 * v);
      return radius / std::sqrt(x);
    }
    case KernelKind::quartic:
      return radius * std::sqrt(1.0 + 2.0 / b);
  }
  return 0.0;
}

namespace {

/// A primitive moved to the origin and its characteristic point: nothing is lost far from it.
template <class P>
struct Isolated {
  P primitive;
  Vec3d characteristic;
};

Isolated<Point> isolated(const Point&, double radius) {
  return {Point{}, {radius, 0.0, 0.0}};
}

Isolated<Segment> isolated(const Segment& segment, double radius) {
  const double half = 0.5 * measure(segment);
  return {Segment{{-half, 0.0, 0.0}, {half, 0.0, 0.0}}, {0.0, radius, 0.0}};
}

Isolated<Arc> isolated(const Arc& arc, double radius) {
  Arc at_origin;
  at_origin.radius = arc.radius;
  at_origin.sweep = arc.sweep;
  return {at_origin, {arc.radius, 0.0, radius}};
}

Isolated<Triangle> isolated(const Triangle& triangle, double radius) {
  Triangle at_origin;
  const auto& v = triangle.vertex;
  for (std::size_t i = 0; i < 3; ++i) {
    // The vertex minus the centroid, from differences of vertices.
    at_origin.vertex[i] = ((v[i] - v[(i + 1) % 3]) + (v[i] - v[(i + 2) % 3])) / 3.0;
  }
  const Vec3d area = area_vector(triangle);
  const bool flat = squared_norm(area) > 0.0;
  return {at_origin, radius * (flat ? normalized(area) : Vec3d{0.0, 0.0, 1.0})};
}

Isolated<Plane> isolated(const Plane&, double radius) {
  return {Plane{}, {0.0, 0.0, radius}};
}

/// The strength of a tapered segment is that of its axis, whose weight is 1.
Isolated<Segment> isolated(const TaperedSegment& segment, double radius) {
  return isolated(segment.axis, radius);
}

}  // namespace

namespace {

/// A Gaussian's unit field underflows where e^(a^2 R^2) times it is of the size of the primitive:
/// fields are taken times e^lift.
double lift_of(KernelKind kind, double radius, double width) {
  return kind == KernelKind::gaussian ? width * radius * (width * radius) : 0.0;
}

Isolation isolation_of(KernelKind kind, double width, double lift, double field) {
  const bool has_width = kind != KernelKind::inverse && kind != KernelKind::squared;
  const double log_strength = lift - std::log(field);
  const double strength = kind == KernelKind::gaussian ? std::exp(log_strength) : 1.0 / field;
  return {has_width ? width : 0.0, strength, log_strength};
}

}  // namespace

Isolation isolate_at_width(KernelKind kind, const Primitive& primitive, double radius,
                           double width) {
  const double lift = lift_of(kind, radius, width);
  const Kernel kernel = make_kernel(kind, width, 1.0, lift, 0.0);
  const double field = std::visit(
      [&](const auto& k, const auto& p) {
        using K = std::decay_t<decltype(k)>;
        using P = std::decay_t<decltype(p)>;
        if constexpr (kDiverges<K, P>) {
          return std::numeric_limits<double>::infinity();
        } else {
          const auto alone = isolated(p, radius);
          return integral(k, alone.primitive, alone.characteristic).value;
        }
      },
      kernel, primitive);
  return isolation_of(kind, width, lift, field);
}

Isolation isolate_at_width(KernelKind kind, const Polygon& polygon, double radius, double width) {
  const double lift = lift_of(kind, radius, width);
  const Kernel kernel = make_kernel(kind, width, 1.0, lift, 0.0);
  const Affine to_origin = Affine::translate(-middle(polygon));
  double field = 0;
  for (const Triangle& piece : polygon.pieces) {
    const Triangle moved = transformed(piece, to_origin);
    field += std::visit(
        [&](const auto& k) { return integral(k, moved, radius * polygon.normal).value; }, kernel);
  }
  return isolation_of(kind, width, lift, field);
}

Isolation isolate_line_at_width(KernelKind kind, double radius, double width) {
  if (kind == KernelKind::squared)
    return isolation_of(kind, width, 0.0, line_field(kind, radius).value);
  const bool inverse_length = kind == KernelKind::cauchy || kind == KernelKind::gaussian;
  const double unit = inverse_length ? 1 / width : width;
  const double log_strength = -std::log(unit) - log_line_field(kind, radius / unit);
  return {width, std::exp(log_strength), log_strength};
}

Isolation isolate(KernelKind kind, const Primitive& primitive, double radius, double blobbiness) {
  return isolate_at_width(kind, primitive, radius, kernel_width(kind, radius, blobbiness));
}

}  // namespace cs2mesh
