// The forms over triangles against the same fields in 50 digits, near, far, over the face, on edges
// and vertices, in the plane, in slivers, with the support's edge anywhere: the worst backward
// error over random configurations. And what they promise at cut-offs, beyond supports, at
// extremes.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>

#include "libfield/base/random.h"
#include "libfield/integral/integral.h"
#include "tests/unit/integral/cases.h"
#include "tests/unit/integral/wide_triangle.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

using cases::TriangleCase;

constexpr double kLimit = 16.0;

/// `count` configurations; make_kernel may change the case.
template <class Case, class MakeKernel>
void expect_exact(const char* name, int count, const MakeKernel& make_kernel) {
  reference::BackwardError worst;
  for (int i = 0; i < count; ++i) {
    Random random(31, static_cast<std::uint64_t>(i));
    Case sample(random);
    const auto kernel = make_kernel(sample);
    const reference::Exact exact = wide::exact_triangle(kernel, sample.primitive, sample.point,
                                                        sample.scale, sample.condition);
    const Jet jet = integral(kernel, sample.primitive, sample.point);
    const reference::BackwardError error = reference::backward_error(jet, exact);
    EXPECT_LE(error.value, kLimit) << name << ", configuration " << i;
    EXPECT_LE(error.gradient, kLimit) << name << ", configuration " << i;
    worst.value = std::max(worst.value, error.value);
    worst.gradient = std::max(worst.gradient, error.gradient);
    const Term term = testing::plain_term(kernel, sample.primitive);
    testing::with_every_isa([&](Isa) {
      const Jet summed = testing::accumulated(term, sample.point);
      EXPECT_EQ(summed.value, jet.value) << name << ", configuration " << i;
      EXPECT_EQ(summed.gradient, jet.gradient) << name << ", configuration " << i;
    });
  }
  std::printf("%s: worst value %.2f, gradient %.2f ulp\n", name, worst.value, worst.gradient);
}

/// The support ends at a vertex, on an edge, at the nearest point, or close to that.
struct SupportEdgeCase : TriangleCase {
  explicit SupportEdgeCase(Random& random) : TriangleCase(random) {
    const auto& v = primitive.vertex;
    const std::size_t i = random.bits() % 3;
    const double choice = random.uniform();
    const double to_edge = distance(Segment{v[i], v[(i + 1) % 3]}, point);
    const double at = choice < 0.3   ? distance(primitive, point)
                      : choice < 0.6 ? to_edge
                                     : norm(point - v[i]);
    const double side = random.uniform() < 0.5 ? -1.0 : 1.0;
    const double part = random.uniform() < 0.3 ? 3.0 : 1.0;  // of metaballs
    const double radius = part * at * (1.0 + side * cases::power_of_ten(random, -9, -0.1));
    per_width = 1.0 / std::max(radius, 1e-6 * scale);
  }
};

TEST(TriangleForm, FiniteSupportsAreExactForInputsMovedByAFewUlp) {
  const auto soft = [](const TriangleCase& c) { return Soft{1 / c.per_width}; };
  const auto quartic = [](const TriangleCase& c) { return Quartic{1 / c.per_width}; };
  const auto metaball = [](const TriangleCase& c) { return Metaball{1 / c.per_width}; };
  expect_exact<TriangleCase>("soft triangle", 40, soft);
  expect_exact<TriangleCase>("quartic triangle", 40, quartic);
  expect_exact<TriangleCase>("metaball triangle", 15, metaball);
  expect_exact<SupportEdgeCase>("soft triangle across the support", 40, soft);
  expect_exact<SupportEdgeCase>("quartic triangle across the support", 40, quartic);
  expect_exact<SupportEdgeCase>("metaball triangle across the support", 15, metaball);
}

/// Off the triangle, where the kernels that are unbounded there are not cut off.
struct BesideTriangle : TriangleCase {
  explicit BesideTriangle(Random& random) : TriangleCase(random) {
    while (distance(primitive, point) < 1e-7 * scale) TriangleCase::operator=(TriangleCase(random));
  }
};

TEST(TriangleForm, InverseKernelsAreExactForInputsMovedByAFewUlp) {
  expect_exact<BesideTriangle>("inverse triangle", 40,
                               [](const TriangleCase&) { return Inverse{}; });
  expect_exact<BesideTriangle>("squared triangle", 10,
                               [](const TriangleCase&) { return Squared{}; });
}

TEST(TriangleForm, GaussiansAreExactForInputsMovedByAFewUlp) {
  expect_exact<TriangleCase>("gaussian triangle", 6, [](TriangleCase& c) {
    const double a = std::min(c.per_width, 20.0 / (1e-3 * c.scale));
    const double d = distance(c.primitive, c.point);
    const double log_amplitude = std::min(500.0, 0.5 * a * a * d * d);
    // Not so far that the field counts as none.
    if (a * a * d * d - log_amplitude > 600.0) c.point = c.primitive.vertex[0];
    c.condition = std::max(c.condition, log_amplitude);
    return Gaussian{a, log_amplitude};
  });
}

const Triangle kPlain{{Vec3d{-0.5, -0.3, 0}, {0.5, -0.3, 0}, {0, 0.5, 0}}};

TEST(TriangleForm, QuadratureHasFewPointsLeft) {
  int left = 0;
  const TriangleFrame<double> frame(kPlain);
  for (int i = 0; i < 512; ++i) {
    const Vec3d p = 0.2 * Vec3d{i % 8 - 3.4, i / 8 % 8 - 3.3, i / 64 - 3.6};
    const auto count = [&](const auto& kernel) {
      left += triangle_trial(kernel, frame, p).good ? 0 : 1;
    };
    count(Soft{1.5}), count(Quartic{1.5}), count(Metaball{1.5});
    count(Inverse{}), count(Squared{}), count(Gaussian{1.5});
  }
  EXPECT_LE(left, 20);
}

TEST(TriangleForm, CutOffInverseTrianglesAreThoseOfQuadrature) {
  const auto expect_cut_off = [](const auto& kernel) {
    for (const Vec3d& on : {Vec3d{0.1, 0, 0}, Vec3d{0, -0.3, 0}, Vec3d{0, 0.5, 0}}) {
      for (const double up : {0.0, 1e-17, -1e-9, 5e-4, 0.99e-3}) {
        const Vec3d p = on + Vec3d{0, 0, up};
        const Jet jet = integral(kernel, kPlain, p);
        EXPECT_EQ(jet.value, quadrature(kernel, kPlain, p).value);
        EXPECT_GT(jet.value, 0.0);
        EXPECT_EQ(norm(jet.gradient), 0.0);
      }
      EXPECT_GT(norm(integral(kernel, kPlain, on + Vec3d{0, 0, 1.01e-3}).gradient), 0.0);
    }
  };
  expect_cut_off(Inverse{1.0, 1e-3});
  expect_cut_off(Squared{1.0, 1e-3});
}

TEST(TriangleForm, NothingIsLeftBeyondTheSupport) {
  const auto expect_zero = [](const auto& kernel) {
    for (const Vec3d& p : {Vec3d{0, 0, 1 + 1e-12}, Vec3d{0, -1.3 - 1e-12, 0}, Vec3d{0, 1.2, 0.9},
                           Vec3d{1.3, -0.9, 0.5}, Vec3d{1e9, 3, 0}}) {
      const Jet jet = integral(kernel, kPlain, p);
      EXPECT_EQ(jet.value, 0.0) << name_of(kernel.kKind) << p.x << " " << p.y;
      EXPECT_EQ(norm(jet.gradient), 0.0);
    }
    EXPECT_GT(integral(kernel, kPlain, Vec3d{0, 0, 0.999}).value, 0.0);
    EXPECT_GT(integral(kernel, kPlain, Vec3d{0, -1.299, 0}).value, 0.0);
  };
  expect_zero(Soft{1.0});
  expect_zero(Quartic{1.0});
  expect_zero(Metaball{1.0});
}

TEST(TriangleForm, WideSupportsAreAlmostPlanes) {
  // A disc of the support, wholly over a great triangle, is what a plane gives.
  const Triangle great{{Vec3d{-90, -50, 0}, {90, -50, 0}, {0, 100, 0}}};
  const auto expect_plane = [&](const auto& kernel) {
    for (const double z : {0.0, 0.1, -0.4, 0.9}) {
      const Jet jet = integral(kernel, great, Vec3d{1, 2, z});
      const Jet plane = integral(kernel, Plane{}, Vec3d{1, 2, z});
      EXPECT_NEAR(jet.value, plane.value, 1e-14);
      EXPECT_LT(norm(jet.gradient - plane.gradient), 1e-14);
    }
  };
  expect_plane(Soft{1.0});
  expect_plane(Quartic{1.0});
  expect_plane(Metaball{1.0});
  expect_plane(Gaussian{2.0});
}

TEST(TriangleForm, FiniteForEveryFinitePoint) {
  const double greatest = std::numeric_limits<double>::max();
  const Triangle flat{{Vec3d{0, 0, 0}, {2, 0, 0}, {1, 0, 0}}};
  const Triangle spot{{Vec3d{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  const Triangle huge{{Vec3d{-1e100, 0, 0}, {1e100, 0, 0}, {0, 1e100, 0}}};
  const auto check = [&](const auto& kernel, const Vec3d& p) {
    for (const Triangle& triangle : {kPlain, flat, spot, huge}) {
      const Jet jet = integral(kernel, triangle, p);
      EXPECT_TRUE(std::isfinite(jet.value) && is_finite(jet.gradient))
          << name_of(kernel.kKind) << " " << p.x << " " << p.y << " " << p.z;
      EXPECT_GE(jet.value, 0.0);
    }
  };
  for (const double x : {0.0, 5e-324, 1e-160, 0.5, 1e8, 1e100, 1e141, greatest}) {
    for (const double y : {0.0, 0.3, 1e100}) {
      for (const Vec3d& p : {Vec3d{x, y, 0}, Vec3d{-x, 0, y}, Vec3d{y, -x, -y}}) {
        for (const double width : {1e-20, 1.0, 1e20}) {
          check(Soft{width}, p), check(Quartic{width}, p), check(Metaball{width}, p);
          check(Gaussian{width, 1e4}, p);
        }
        check(Inverse{1.0, 1e-6}, p), check(Squared{1.0, 1e-6}, p);
      }
    }
  }
}

}  // namespace
}  // namespace cs2mesh
