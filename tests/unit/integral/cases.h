// Random configurations of a primitive, a point and a width, from easy to what closed forms fear:
// wide, stiff, tiny, huge, far from the origin, on the primitive, on axes, behind ends, full
// circles, slivers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libfield/base/random.h"
#include "libfield/kernel/gaussian.h"
#include "libfield/primitive/arc.h"
#include "libfield/primitive/segment.h"
#include "libfield/primitive/triangle.h"

namespace cs2mesh::cases {

inline double power_of_ten(Random& random, double lo, double hi) {
  return std::pow(10.0, random.uniform(lo, hi));
}

/// A size from tiny to huge, a place near or far from the origin, a distance from on the primitive
/// to far away (in sizes).
struct Setting {
  double size, distance, per_width;
  Vec3d origin;

  explicit Setting(Random& random) {
    size = power_of_ten(random, -6, 5);
    origin = (random.uniform() < 0.3 ? 1e6 : 1.0) * size * random.direction();
    distance = random.uniform() < 0.05 ? 0.0 : size * power_of_ten(random, -8, 4);
    // Times distances seen: from wide to stiff.
    per_width = power_of_ten(random, -4, 4) / std::min(size, std::max(distance, 1e-3 * size));
  }
};

struct SegmentCase {
  Segment primitive;
  Vec3d point;
  double per_width, scale, condition = 1.0;

  explicit SegmentCase(Random& random) {
    const Setting setting(random);
    per_width = setting.per_width;
    const Vec3d axis = random.direction();
    primitive = {setting.origin, setting.origin + setting.size * axis};
    // Along it, at an end, or on its line behind an end.
    const double choice = random.uniform();
    const double along = choice < 0.5 ? random.uniform() : choice < 0.75 ? 0.0 : 1.0;
    const Vec3d away = random.uniform() < 0.3 ? axis : random.direction();
    point = setting.origin + (setting.size * along) * axis + setting.distance * away;
    scale = std::max({norm(point - primitive.a), norm(point - primitive.b), setting.size});
  }
};

struct ArcCase {
  Arc primitive;
  Vec3d point;
  double per_width, scale, condition = 1.0;

  explicit ArcCase(Random& random) {
    const Setting setting(random);
    per_width = setting.per_width;
    primitive.center = setting.origin;
    primitive.radius = setting.size;
    const double kind = random.uniform();
    primitive.sweep = kind < 0.2   ? 2.0 * std::numbers::pi
                      : kind < 0.4 ? power_of_ten(random, -7, 0)
                                   : random.uniform(0.1, 6.2);
    const Vec3d n = random.direction();
    primitive.normal = n;
    primitive.ex = normalized(cross(n, random.direction()));
    primitive.ey = cross(n, primitive.ex);
    // Near a point of the arc, near its axis, or opposite to its middle.
    const double place = random.uniform();
    const double angle = place < 0.6   ? random.uniform(-0.5, 0.5) * primitive.sweep
                         : place < 0.8 ? std::numbers::pi
                                       : random.uniform(-3.1, 3.1);
    const double radius = random.uniform() < 0.2 ? 0.0 : setting.size;
    point = setting.origin + (radius * std::cos(angle)) * primitive.ex +
            (radius * std::sin(angle)) * primitive.ey + setting.distance * random.direction();
    scale = std::max(norm(point - primitive.center), primitive.radius);
  }
};

struct TriangleCase {
  Triangle primitive;
  Vec3d point;
  double per_width, scale, condition;

  explicit TriangleCase(Random& random) {
    const Setting setting(random);
    per_width = setting.per_width;
    const Vec3d along = random.direction();
    const Vec3d up = normalized(cross(along, random.direction()));
    const double height = random.uniform() < 0.3 ? power_of_ten(random, -8, -1) : random.uniform();
    primitive.vertex = {setting.origin, setting.origin + setting.size * along,
                        setting.origin + (setting.size * random.uniform(0.0, 1.2)) * along +
                            (setting.size * height) * up};
    // Near a point of the triangle, of an edge, a vertex; off the plane or in it.
    double a = random.uniform(), b = random.uniform() * (1.0 - a);
    if (random.uniform() < 0.3) b = 0.0;
    if (random.uniform() < 0.2) a = 0.0;
    const Vec3d& v0 = primitive.vertex[0];
    const Vec3d normal = normalized(cross(along, up));
    const Vec3d away = random.uniform() < 0.3   ? normal
                       : random.uniform() < 0.3 ? normalized(cross(normal, random.direction()))
                                                : random.direction();
    point = v0 + a * (primitive.vertex[1] - v0) + b * (primitive.vertex[2] - v0) +
            setting.distance * away;
    double longest = 0.0;
    scale = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      longest = std::max(longest, norm(primitive.vertex[(i + 1) % 3] - primitive.vertex[i]));
      scale = std::max(scale, norm(point - primitive.vertex[i]));
    }
    scale = std::max(scale, longest);
    condition = longest * longest / norm(cross(primitive.vertex[1] - v0, primitive.vertex[2] - v0));
  }
};

/// A Gaussian where there is something to compare, neither cut off nor vanished. The rounding of
/// its amplitude's logarithm is an error of the exponent, which `sample.condition` takes up.
inline Gaussian gaussian_for(SegmentCase& sample) {
  const double a = std::min(sample.per_width, 20.0 / std::max(1e-3 * sample.scale, 1e-300));
  const Segment& segment = sample.primitive;
  const double u = squared_norm(sample.point - 0.5 * (segment.a + segment.b));
  const double log_amplitude = std::min(500.0, 0.5 * a * a * u);
  sample.condition = std::max(1.0, log_amplitude);
  return {a, log_amplitude};
}

inline Gaussian gaussian_for(ArcCase& sample) {
  const double a = std::min(sample.per_width, 20.0 / std::max(1e-3 * sample.scale, 1e-300));
  const double d = distance(sample.primitive, sample.point);
  const double log_amplitude = std::min(500.0, 0.9 * (a * d) * (a * d));
  sample.condition = std::max(1.0, log_amplitude);
  return {a, log_amplitude};
}

/// Arcs and points in every pairing of a sweep, from 1e-9 degrees to a full circle, with a place:
/// near or far, on the axis, all but on it, on the circle beside the arc, in its plane, beyond an
/// end. Widths from far below the distance to far beyond the arc.
struct ArcRegime : ArcCase {
  static constexpr std::array<double, 12> kDegrees = {1e-9,       1e-5, 0.01, 1,   30,       90,
                                                      179.999999, 180,  181,  300, 359.9999, 360};
  static constexpr int kPlaces = 9, kCount = 12 * kPlaces;

  explicit ArcRegime(Random& random) : ArcCase(random) {
    const auto pairing = static_cast<std::size_t>(random.uniform(0.0, kCount - 1e-6));
    const double half = 0.5 * std::numbers::pi / 180.0 * kDegrees[pairing % 12];
    primitive.sweep = std::min(2.0 * half, 2.0 * std::numbers::pi);
    const double c = primitive.radius, small = c * power_of_ten(random, -9, -3);
    const auto at = [&](double angle, double radius, double z) {
      return primitive.center + (radius * std::cos(angle)) * primitive.ex +
             (radius * std::sin(angle)) * primitive.ey + z * primitive.normal;
    };
    const double along = random.uniform(-1.0, 1.0) * half, any = random.uniform(-3.1, 3.1);
    switch (pairing / 12) {
      case 0:  // near a point of it
        point = at(along, c, 0) + small * random.direction();
        break;
      case 1:  // on the axis
        point = at(0, 0, c * random.uniform(-2.0, 2.0));
        break;
      case 2:  // all but on the axis
        point = at(any, small, c * random.uniform(-2.0, 2.0));
        break;
      case 3:  // on the circle beyond an end
        point = at(half + random.uniform() * (std::numbers::pi - half), c, 0);
        break;
      case 4:  // in the plane
        point = at(any, c * random.uniform(0.0, 3.0), 0);
        break;
      case 5:  // close to an end
        point = at(half, c, 0) + small * random.direction();
        break;
      case 6:  // opposite
        point = at(std::numbers::pi, c * random.uniform(0.5, 1.5), small);
        break;
      case 7:  // within the size of a short arc
        point = at(along, c, 0) + (c * half * power_of_ten(random, -3, 1)) * random.direction();
        break;
      default:
        point = primitive.center + (c * power_of_ten(random, 0, 5)) * random.direction();
    }
    scale = std::max(norm(point - primitive.center), c);
    const double d = distance(primitive, point);
    per_width = power_of_ten(random, -3, 1.5) / std::max(std::min(d, c), 1e-6 * c);
  }
};

}  // namespace cs2mesh::cases
