// The closed forms against themselves in 100 digits, in every regime where the double versions
// change their form: the worst backward error over random configurations.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "libfield/base/random.h"
#include "libfield/integral/cauchy_arc.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/cauchy_triangle.h"
#include "libfield/integral/gaussian_segment.h"
#include "tests/unit/integral/wide.h"

namespace cs2mesh {
namespace {

constexpr double kLimit = 16.0;
constexpr int kConfigurations = 600;

double power_of_ten(Random& random, double lo, double hi) {
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

template <class Case, class MakeKernel>
void expect_exact(const char* name, const MakeKernel& make_kernel) {
  double worst_value = 0.0, worst_gradient = 0.0;
  for (int i = 0; i < kConfigurations; ++i) {
    Random random(7, static_cast<std::uint64_t>(i));
    Case sample(random);
    const auto kernel = make_kernel(sample);
    const Jet jet = integral(kernel, sample.primitive, sample.point);
    const reference::Exact exact =
        wide::exact_field(kernel, sample.primitive, sample.point, sample.scale, sample.condition);
    const reference::BackwardError error = reference::backward_error(jet, exact);
    EXPECT_LE(error.value, kLimit) << name << ", configuration " << i;
    EXPECT_LE(error.gradient, kLimit) << name << ", configuration " << i;
    worst_value = std::max(worst_value, error.value);
    worst_gradient = std::max(worst_gradient, error.gradient);
  }
  std::printf("%s: worst value %.2f, gradient %.2f ulp\n", name, worst_value, worst_gradient);
}

TEST(ClosedForm, CauchySegmentIsExactForInputsMovedByAFewUlp) {
  expect_exact<SegmentCase>("cauchy segment",
                            [](const SegmentCase& c) { return Cauchy{c.per_width}; });
}

TEST(ClosedForm, CauchyArcIsExactForInputsMovedByAFewUlp) {
  expect_exact<ArcCase>("cauchy arc", [](const ArcCase& c) { return Cauchy{c.per_width}; });
}

TEST(ClosedForm, CauchyTriangleIsExactForInputsMovedByAFewUlp) {
  expect_exact<TriangleCase>("cauchy triangle",
                             [](const TriangleCase& c) { return Cauchy{c.per_width}; });
}

TEST(ClosedForm, GaussianSegmentIsExactForInputsMovedByAFewUlp) {
  expect_exact<SegmentCase>("gaussian segment", [](SegmentCase& c) {
    // Where there is something to compare: neither cut off nor vanished.
    const double a = std::min(c.per_width, 20.0 / std::max(1e-3 * c.scale, 1e-300));
    const double u = squared_norm(c.point - 0.5 * (c.primitive.a + c.primitive.b));
    const double log_amplitude = std::min(500.0, 0.5 * a * a * u);
    // Its own rounding is an error of the exponent.
    c.condition = std::max(1.0, log_amplitude);
    return Gaussian{a, log_amplitude};
  });
}

}  // namespace
}  // namespace cs2mesh
