// Random kernels, primitives and points for property tests: sizes and widths over several powers of
// ten, so that stiff, wide, near and far cases all occur.
#pragma once

#include <cmath>
#include <numbers>

#include "libfield/base/affine.h"
#include "libfield/base/random.h"
#include "libfield/kernel/kernel.h"
#include "libfield/primitive/primitive.h"

namespace cs2mesh::testing {

inline double log_uniform(Random& random, double lo, double hi) {
  return lo * std::pow(hi / lo, random.uniform());
}

inline Vec3d random_vector(Random& random, double size) {
  return size * random.uniform() * random.direction();
}

/// `length` is about where the kernel falls.
inline Kernel random_kernel(Random& random, KernelKind kind, double length) {
  const bool inverse_width = kind == KernelKind::cauchy || kind == KernelKind::gaussian;
  const double width = inverse_width ? 1.0 / length : 2.0 * length;
  const double strength = log_uniform(random, 0.1, 10.0);
  return make_kernel(kind, width, strength, std::log(strength), 0.0);
}

inline Primitive random_primitive(Random& random, std::size_t index, double size) {
  const Vec3d at = random_vector(random, 2.0);
  const auto vertex = [&] { return at + random_vector(random, size); };
  switch (index) {
    case 0:
      return Point{at};
    case 1:
      return Segment{vertex(), vertex()};
    case 2:
      return make_arc(at, log_uniform(random, 0.1, 1.0) * size, random.direction(),
                      random.uniform(-400.0, 400.0), log_uniform(random, 1.0, 360.0));
    case 3:
      return Triangle{{vertex(), vertex(), vertex()}};
    default:
      return Plane{at, random.direction()};
  }
}
inline constexpr std::size_t kPrimitiveKinds = 5;

/// A rotation about a random axis, a translation, a scale; mirrored if asked for.
inline Affine random_similarity(Random& random, double factor, bool mirrored) {
  const Affine mirror = Affine::scale({1.0, 1.0, mirrored ? -1.0 : 1.0});
  const Affine grow = Affine::scale({factor, factor, factor});
  return Affine::translate(random_vector(random, 3.0)) *
         Affine::rotate(random.direction(), random.uniform(-180.0, 180.0)) * mirror * grow;
}

/// A point near a primitive of that size: half of them at a kernel's length from it.
inline Vec3d random_near(Random& random, const Primitive& primitive, double size, double length) {
  const Vec3d middle_of = std::visit([](const auto& p) { return middle(p); }, primitive);
  return middle_of + random_vector(random, size) + random_vector(random, length);
}

}  // namespace cs2mesh::testing
