// The closed forms against themselves in 100 digits, in every regime where the double versions
// change their form: the worst backward error over random configurations.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>

#include "libfield/base/random.h"
#include "libfield/integral/cauchy_arc.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/cauchy_triangle.h"
#include "libfield/integral/gaussian_segment.h"
#include "libfield/integral/inverse_segment.h"
#include "libfield/integral/plane.h"
#include "libfield/integral/quadrature.h"
#include "libfield/integral/support_arc.h"
#include "libfield/integral/support_segment.h"
#include "tests/unit/integral/cases.h"
#include "tests/unit/integral/exactness.h"

namespace cs2mesh {
namespace {

using cases::ArcCase;
using cases::SegmentCase;
using cases::TriangleCase;

constexpr int kConfigurations = 600;

template <class Case, class MakeKernel>
void expect_exact(const char* name, const MakeKernel& make_kernel) {
  wide::expect_exact_for<Case>(name, kConfigurations, make_kernel,
                               [](const auto& kernel, const auto& sample) {
                                 return wide::exact_field(kernel, sample.primitive, sample.point,
                                                          sample.scale, sample.condition);
                               });
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
  expect_exact<SegmentCase>("gaussian segment",
                            [](SegmentCase& c) { return cases::gaussian_for(c); });
}

/// Off the segment, where the kernels that are unbounded there are not cut off.
struct BesideSegment : SegmentCase {
  explicit BesideSegment(Random& random) : SegmentCase(random) {
    while (distance(primitive, point) < 1e-7 * scale) SegmentCase::operator=(SegmentCase(random));
  }
};

TEST(ClosedForm, InverseSegmentsAreExactForInputsMovedByAFewUlp) {
  expect_exact<BesideSegment>("inverse segment", [](const SegmentCase&) { return Inverse{}; });
  expect_exact<BesideSegment>("squared segment", [](const SegmentCase&) { return Squared{}; });
}

TEST(ClosedForm, CutOffInverseSegmentsAreExactlyThoseAtTheCutOffDistance) {
  const Segment segment{{0, 0, 0}, {3, 0, 0}};
  const double clamp = 1e-3;
  const auto expect_cut_off = [&](const auto& kernel) {
    for (const double along : {0.2, 1.5, 2.9}) {
      const Jet at_distance = integral(kernel, segment, Vec3d{along, 0, clamp * (1 + 1e-14)});
      EXPECT_GT(norm(at_distance.gradient), 0.0);
      for (const double aside : {0.0, 1e-17, 1e-9, 0.5 * clamp, 0.99 * clamp}) {
        const Jet jet = integral(kernel, segment, Vec3d{along, aside, 0});
        EXPECT_NEAR(jet.value, at_distance.value, 1e-11 * at_distance.value) << along << aside;
        EXPECT_EQ(norm(jet.gradient), 0.0);
      }
    }
    // Beyond an end.
    const Jet before = integral(kernel, segment, Vec3d{-0.9 * clamp, 0, 0});
    EXPECT_EQ(norm(before.gradient), 0.0);
    EXPECT_GT(norm(integral(kernel, segment, Vec3d{-1.1 * clamp, 0, 0}).gradient), 0.0);
  };
  expect_cut_off(Inverse{1.0, clamp});
  expect_cut_off(Squared{1.0, clamp});
}

TEST(ClosedForm, SegmentsOfFiniteSupportAreExactForInputsMovedByAFewUlp) {
  expect_exact<SegmentCase>("soft segment",
                            [](const SegmentCase& c) { return Soft{1 / c.per_width}; });
  expect_exact<SegmentCase>("quartic segment",
                            [](const SegmentCase& c) { return Quartic{1 / c.per_width}; });
  expect_exact<SegmentCase>("metaball segment",
                            [](const SegmentCase& c) { return Metaball{1 / c.per_width}; });
}

/// Twenty nodes against adaptive quadrature, in units of what rounding the inputs may change; the
/// reference rows have the digits.
template <class MakeKernel>
void expect_as_quadrature(const MakeKernel& make_kernel) {
  int reached = 0;
  for (int i = 0; i < 4000; ++i) {
    Random random(23, static_cast<std::uint64_t>(i));
    const ArcCase sample(random);
    const auto kernel = make_kernel(sample);
    const Jet jet = integral(kernel, sample.primitive, sample.point);
    const Jet exact = quadrature(kernel, sample.primitive, sample.point);
    const double curvature = measure(sample.primitive) * kernel.derivative_envelope(2, 0.0);
    const double slope = norm(exact.gradient);
    EXPECT_LE(std::abs(jet.value - exact.value),
              1e-14 * (exact.value + slope * sample.scale) + 1e-300)
        << i;
    EXPECT_LE(norm(jet.gradient - exact.gradient), 1e-14 * (slope + curvature * sample.scale)) << i;
    reached += exact.value > 0 ? 1 : 0;
  }
  EXPECT_GT(reached, 400);
}

TEST(ClosedForm, PlanesAreExactlyZeroBeyondTheSupport) {
  const auto expect_zero = [](const auto& kernel) {
    for (const double d : {1.0 + 1e-12, 1.5, 1e9}) {
      const Jet jet = integral(kernel, Plane{}, Vec3d{3, 4, -d});
      EXPECT_EQ(jet.value, 0.0) << name_of(kernel.kKind) << " " << d;
      EXPECT_EQ(norm(jet.gradient), 0.0);
    }
    EXPECT_GT(integral(kernel, Plane{}, Vec3d{3, 4, 0.999}).value, 0.0);
  };
  expect_zero(Soft{1.0});
  expect_zero(Quartic{1.0});
  expect_zero(Metaball{1.0});
}

TEST(ClosedForm, SupportArcsAreExactlyWhatQuadratureGives) {
  expect_as_quadrature([](const ArcCase& c) { return Soft{1 / c.per_width}; });
  expect_as_quadrature([](const ArcCase& c) { return Quartic{1 / c.per_width}; });
}

template <class Case, class MakeKernel>
void expect_gradient_of_value(const MakeKernel& make_kernel) {
  for (int i = 0; i < 60; ++i) {
    Random random(11, static_cast<std::uint64_t>(i));
    Case sample(random);
    const auto kernel = make_kernel(sample);
    EXPECT_LT(wide::gradient_mismatch(kernel, sample.primitive, sample.point, sample.scale), 1e-12)
        << "configuration " << i;
  }
}

TEST(ClosedForm, GradientsAreThoseOfTheValues) {
  const auto cauchy = [](const auto& c) { return Cauchy{c.per_width}; };
  expect_gradient_of_value<SegmentCase>(cauchy);
  expect_gradient_of_value<ArcCase>(cauchy);
  expect_gradient_of_value<TriangleCase>(cauchy);
  expect_gradient_of_value<SegmentCase>([](SegmentCase& c) { return cases::gaussian_for(c); });
  expect_gradient_of_value<BesideSegment>([](const SegmentCase&) { return Inverse{}; });
  expect_gradient_of_value<BesideSegment>([](const SegmentCase&) { return Squared{}; });
}

template <class Kernel, class Primitive>
void expect_finite(const Kernel& kernel, const Primitive& primitive, const Vec3d& point) {
  const auto check = [&](const Jet& jet) {
    EXPECT_TRUE(std::isfinite(jet.value) && is_finite(jet.gradient))
        << point.x << ", " << point.y << ", " << point.z;
    EXPECT_GE(jet.value, 0.0);
  };
  check(integral(kernel, primitive, point));
  const Term term = testing::plain_term(kernel, primitive);
  testing::with_every_isa([&](Isa) { check(testing::accumulated(term, point)); });
}

TEST(ClosedForm, FiniteForEveryFinitePoint) {
  const double greatest = std::numeric_limits<double>::max();
  const double reaches[] = {0.0,     std::numeric_limits<double>::denorm_min(),
                            1e-160,  1e-8,
                            1.0,     2.0,
                            1e8,     1e77,
                            1e100,   1e139,
                            1e141,   1e160,
                            greatest};
  const Segment segment{{0, 0, 0}, {2, 0, 0}};
  const Arc turn{{0, 0, 0}, 1.0, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 2.0 * std::numbers::pi};
  const Arc bit{{0, 0, 0}, 1.0, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 1e-9};
  const Triangle triangle{{Vec3d{0, 0, 0}, {2, 0, 0}, {1, 1, 0}}};
  const Triangle flat{{Vec3d{0, 0, 0}, {2, 0, 0}, {1, 0, 0}}};
  const Triangle spot{{Vec3d{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  for (const double x : reaches) {
    for (const double y : reaches) {
      for (const Vec3d& p : {Vec3d{x, y, 0}, Vec3d{-x, 0, y}, Vec3d{y, -x, -y}, Vec3d{1, x, -x}}) {
        for (const double width : {1e-20, 1e-3, 1.0, 1e3, 1e20}) {
          expect_finite(Cauchy{width}, segment, p);
          expect_finite(Cauchy{width}, turn, p);
          expect_finite(Cauchy{width}, bit, p);
          expect_finite(Cauchy{width}, triangle, p);
          expect_finite(Cauchy{width}, flat, p);
          expect_finite(Cauchy{width}, spot, p);
          expect_finite(Gaussian{width, 1e4}, segment, p);
          expect_finite(Gaussian{width}, Segment{{1, 0, 0}, {1, 0, 0}}, p);
        }
      }
    }
  }
}

TEST(ClosedForm, StiffGaussiansDoNotOverflow) {
  // Blobbiness -1000 at radius 1: the amplitude e^1000 has no double, the field at radius 1 has.
  const Gaussian kernel{std::sqrt(1000.0), 1000.0};
  const Segment segment{{-1, 0, 0}, {1, 0, 0}};
  const Jet jet = integral(kernel, segment, Vec3d{0, 1, 0});
  EXPECT_NEAR(jet.value, std::sqrt(std::numbers::pi / 1000.0), 1e-12);
  EXPECT_NEAR(jet.gradient.y, -2000.0 * jet.value, 1e-9);
}

}  // namespace
}  // namespace cs2mesh
