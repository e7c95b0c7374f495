// Fields of arcs against the same in 33 digits and more, over every regime of sweep and place; the
// laws that they obey; what a cut-off leaves.

#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_rd.hpp>
#include <boost/math/special_functions/ellint_rf.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "libfield/base/random.h"
#include "libfield/integral/carlson.h"
#include "libfield/integral/integral.h"
#include "tests/unit/integral/cases.h"
#include "tests/unit/integral/exactness.h"
#include "tests/unit/integral/wide_arc.h"

namespace cs2mesh {
namespace {

using cases::ArcCase;
using cases::ArcRegime;

constexpr double kPi = std::numbers::pi;

TEST(Carlson, AgreesWithAnIndependentImplementation) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const double x = i % 5 == 0 ? 0.0 : cases::power_of_ten(random, -20, 8);
    const double y = cases::power_of_ten(random, -15, 8), z = cases::power_of_ten(random, -15, 8);
    const CarlsonPair<double> pair = carlson(x, y, z);
    const double rf = boost::math::ellint_rf(x, y, z), rd = boost::math::ellint_rd(x, y, z);
    EXPECT_NEAR(pair.rf, rf, 2e-15 * rf) << x << " " << y << " " << z;
    EXPECT_NEAR(pair.rd, rd, 2e-15 * rd) << x << " " << y << " " << z;
    const double m = std::min(y, z), q = std::max(y, z);
    if (m < 1e-10 * q) continue;
    const CarlsonPair<double> quarter = detail::carlson_quarter(m, q);
    const double whole = boost::math::ellint_rf(0.0, q, m);
    EXPECT_NEAR(quarter.rf, whole, 1e-15 * whole);
    EXPECT_NEAR(quarter.rd, m * boost::math::ellint_rd(0.0, q, m) / 3, 4e-15 * whole);
  }
}

TEST(Carlson, SeriesLeaveOutTheEighthDegree) {
  using W = wide::Wide;
  const W d(1e-10);  // carlson() itself, of wide numbers, has its arguments much closer together
  const double least = 1e-75;  // (5 d)^8
  for (const auto& [a, b, c] : {Vec3d{1, -2, 3}, {-1, 0.5, 2}, {3, 1, -1}, {-2, -1, 1}}) {
    const W x = 1 + a * d, y = 1 + b * d, z = 1 + c * d;
    const CarlsonPair<W> exact = carlson(x, y, z);
    EXPECT_LT(abs(W(detail::carlson_rf_series(x, y, z) - exact.rf)), least);
    EXPECT_LT(abs(W(detail::carlson_rd_series(x, y, z) - exact.rd)), least);
  }
}

/// Off the arc, where the kernels that are unbounded there are not cut off.
template <class Case>
struct Beside : Case {
  explicit Beside(Random& random) : Case(random) {
    while (distance(this->primitive, this->point) < 1e-10 * this->scale) {
      Case::operator=(Case(random));
    }
  }
};

template <class Case, class MakeKernel>
void expect_closed(const char* name, int count, const MakeKernel& make_kernel) {
  wide::expect_exact_for<Beside<Case>>(name, count, make_kernel, [](const auto& k, const auto& c) {
    return wide::exact_field(k, c.primitive, c.point, c.scale, c.condition);
  });
}

TEST(ArcFields, InverseKernelsAreExactForInputsMovedByAFewUlp) {
  expect_closed<ArcCase>("inverse arc", 80, [](const ArcCase&) { return Inverse{}; });
  expect_closed<ArcCase>("squared arc", 80, [](const ArcCase&) { return Squared{}; });
  expect_closed<ArcRegime>("inverse arc, regimes", 150, [](const ArcCase&) { return Inverse{}; });
  expect_closed<ArcRegime>("squared arc, regimes", 150, [](const ArcCase&) { return Squared{}; });
}

template <class Case, class MakeKernel>
void expect_nodes(const char* name, int count, const MakeKernel& make_kernel,
                  const wide::Limits& limits = {}) {
  wide::expect_exact_for<Case>(
      name, count, make_kernel,
      [](const auto& k, const auto& c) {
        return wide::exact_arc_field(k, c.primitive, c.point, c.scale, c.condition);
      },
      limits);
}

TEST(ArcFields, GaussiansAreExactForInputsMovedByAFewUlp) {
  const auto make = [](ArcCase& c) { return cases::gaussian_for(c); };
  expect_nodes<ArcCase>("gaussian arc", 12, make);
  expect_nodes<ArcRegime>("gaussian arc, regimes", 25, make);
}

TEST(ArcFields, KernelsOfFiniteSupportAreExactForInputsMovedByAFewUlp) {
  const auto soft = [](const ArcCase& c) { return Soft{1 / c.per_width}; };
  const auto quartic = [](const ArcCase& c) { return Quartic{1 / c.per_width}; };
  const auto metaball = [](const ArcCase& c) { return Metaball{1 / c.per_width}; };
  expect_nodes<ArcRegime>("soft arc, regimes", 25, soft);
  expect_nodes<ArcRegime>("quartic arc, regimes", 25, quartic);
  expect_nodes<ArcCase>("metaball arc", 20, metaball, {16.0, 64.0});
  expect_nodes<ArcRegime>("metaball arc, regimes", 40, metaball, {16.0, 64.0});
}

/// As the closed form of the inverse kernels does for wide numbers: the integral itself.
TEST(ArcFields, TheClosedFormsAreTheIntegralsThatDefineThem) {
  for (int i = 0; i < 30; ++i) {
    Random random(29, static_cast<std::uint64_t>(i));
    ArcCase c(random);
    c.primitive.sweep = std::min(c.primitive.sweep, 6.0);
    c.point += (0.3 * c.primitive.radius) * random.direction();
    const auto compare = [&](const auto& kernel) {
      const Jet jet = quadrature(kernel, c.primitive, c.point);
      const JetOf<wide::Wide> closed = integral(kernel, c.primitive, Vec3<wide::Wide>(c.point));
      EXPECT_NEAR(static_cast<double>(closed.value), jet.value, 1e-12 * jet.value) << i;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(static_cast<double>(closed.gradient[axis]), jet.gradient[axis],
                    1e-11 * norm(jet.gradient))
            << i;
      }
      EXPECT_LT(wide::gradient_mismatch(kernel, c.primitive, c.point, c.scale), 1e-12) << i;
    };
    compare(Inverse{2.0});
    compare(Squared{3.0});
  }
}

template <class Visit>
void for_each_kernel(double length, const Visit& visit) {
  visit(Cauchy{1.0 / length});
  visit(Gaussian{1.0 / length, 1.0});
  visit(Inverse{});
  visit(Squared{});
  visit(Metaball{2.0 * length});
  visit(Soft{2.0 * length});
  visit(Quartic{2.0 * length});
}

void expect_near(const Jet& a, const Jet& b, double relative, const char* what, int i) {
  EXPECT_NEAR(a.value, b.value, relative * std::abs(b.value)) << what << " " << i;
  EXPECT_LE(norm(a.gradient - b.gradient), relative * (norm(b.gradient) + std::abs(b.value)))
      << what << " " << i;
}

Arc part_of(const Arc& arc, double from, double to) {
  Arc part = arc;
  const double turn = 0.5 * (from + to);
  part.ex = std::cos(turn) * arc.ex + std::sin(turn) * arc.ey;
  part.ey = std::cos(turn) * arc.ey - std::sin(turn) * arc.ex;
  part.sweep = to - from;
  return part;
}

TEST(ArcFields, AnArcIsItsParts) {
  for (int i = 0; i < 300; ++i) {
    Random random(31, static_cast<std::uint64_t>(i));
    Arc arc;
    arc.sweep = i % 4 == 0 ? 2.0 * kPi : random.uniform(0.01, 6.28);
    const double cut = random.uniform(-0.5, 0.5) * arc.sweep;
    const Vec3d p = random.uniform(0.3, 2.0) * random.direction();
    if (distance(arc, p) < 0.05) continue;
    for_each_kernel(random.uniform(0.1, 3.0), [&](const auto& kernel) {
      Jet sum = integral(kernel, part_of(arc, -0.5 * arc.sweep, cut), p);
      sum += integral(kernel, part_of(arc, cut, 0.5 * arc.sweep), p);
      expect_near(sum, integral(kernel, arc, p), 1e-12, name_of(kernel.kKind).data(), i);
    });
  }
}

TEST(ArcFields, AFullCircleLooksTheSameAllAround) {
  Arc circle;
  circle.sweep = 2.0 * kPi;
  for (int i = 0; i < 100; ++i) {
    Random random(37, static_cast<std::uint64_t>(i));
    const double rho = i % 10 == 0 ? 0.0 : random.uniform(0.0, 2.0), z = random.uniform(0.05, 1.0);
    const double angle = random.uniform(-kPi, kPi);
    const double c = std::cos(angle), s = std::sin(angle);
    for_each_kernel(random.uniform(0.1, 3.0), [&](const auto& kernel) {
      const Jet ahead = integral(kernel, circle, Vec3d{rho, 0, z});
      const Jet turned = integral(kernel, circle, Vec3d{rho * c, rho * s, z});
      const Vec3d& g = ahead.gradient;
      expect_near(turned, {ahead.value, {c * g.x, s * g.x, g.z}}, 1e-12,
                  name_of(kernel.kKind).data(), i);
      EXPECT_LE(std::abs(g.y), 1e-13 * (norm(g) + ahead.value));
    });
  }
}

TEST(ArcFields, AMirroredPointHasTheMirroredField) {
  for (int i = 0; i < 200; ++i) {
    Random random(41, static_cast<std::uint64_t>(i));
    Arc arc;
    arc.sweep = random.uniform(0.01, 6.28);
    const Vec3d p = random.uniform(0.3, 2.0) * random.direction();
    for_each_kernel(random.uniform(0.1, 3.0), [&](const auto& kernel) {
      const Jet jet = integral(kernel, arc, p);
      const Jet across = integral(kernel, arc, Vec3d{p.x, -p.y, p.z});
      const Jet below = integral(kernel, arc, Vec3d{p.x, p.y, -p.z});
      EXPECT_EQ(across.value, jet.value);
      EXPECT_EQ(across.gradient.y, -jet.gradient.y);
      EXPECT_EQ(below.value, jet.value);
      EXPECT_EQ(below.gradient.z, -jet.gradient.z);
    });
  }
}

TEST(ArcFields, CutOffInverseKernelsAreThoseAtTheCutOffDistance) {
  Arc arc;
  arc.sweep = 4.0;
  const double clamp = 1e-3;
  const auto expect_cut_off = [&](const auto& kernel) {
    for (const double along : {-1.9, 0.0, 0.7}) {
      const Vec3d out{std::cos(along), std::sin(along), 0};
      const Jet above = integral(kernel, arc, out + Vec3d{0, 0, clamp * (1 + 1e-13)});
      EXPECT_GT(norm(above.gradient), 0.0);
      for (const double aside : {0.0, 1e-17, 1e-9, 0.5 * clamp, 0.99 * clamp}) {
        const Jet jet = integral(kernel, arc, out + Vec3d{0, 0, aside});
        EXPECT_NEAR(jet.value, above.value, 1e-11 * above.value) << along << " " << aside;
        EXPECT_EQ(norm(jet.gradient), 0.0);
      }
      // In the plane, straight away from the arc, as in detail::clamped().
      const Jet beyond = integral(kernel, arc, (1 + clamp * (1 + 1e-12)) * out);
      const Jet within = integral(kernel, arc, (1 + 0.3 * clamp) * out);
      EXPECT_NEAR(within.value, beyond.value, 1e-9 * beyond.value);
      EXPECT_NEAR(within.value, quadrature(kernel, arc, (1 + 0.3 * clamp) * out).value,
                  1e-11 * within.value);
    }
    // Beyond an end.
    const Vec3d end{std::cos(2.0), std::sin(2.0), 0}, on{-std::sin(2.0), std::cos(2.0), 0};
    const Jet before = integral(kernel, arc, end + (0.9 * clamp) * on);
    EXPECT_EQ(norm(before.gradient), 0.0);
    EXPECT_NEAR(before.value, quadrature(kernel, arc, end + (0.9 * clamp) * on).value,
                1e-10 * before.value);
    EXPECT_GT(norm(integral(kernel, arc, end + (1.1 * clamp) * on).gradient), 0.0);
  };
  expect_cut_off(Inverse{1.0, clamp});
  expect_cut_off(Squared{1.0, clamp});
}

template <class Kernel>
void expect_finite(const Kernel& kernel, const Arc& arc, const Vec3d& point) {
  const auto check = [&](const Jet& jet) {
    EXPECT_TRUE(std::isfinite(jet.value) && is_finite(jet.gradient))
        << name_of(kernel.kKind) << " " << point.x << ", " << point.y << ", " << point.z
        << " sweep " << arc.sweep << " radius " << arc.radius;
    EXPECT_GE(jet.value, 0.0);
  };
  check(integral(kernel, arc, point));
  const Term term = testing::plain_term(kernel, arc);
  testing::with_every_isa([&](Isa) { check(testing::accumulated(term, point)); });
}

TEST(ArcFields, FiniteForEveryFinitePoint) {
  const double greatest = std::numeric_limits<double>::max();
  const double reaches[] = {0.0,     std::numeric_limits<double>::denorm_min(),
                            1e-160,  1e-8,
                            1.0,     2.0,
                            1e8,     1e77,
                            1e100,   1e141,
                            greatest};
  for (const double radius : {1.0, 1e-100, 1e100}) {
    for (const double sweep : {1e-9, 1.0, kPi, 6.0, 2.0 * kPi}) {
      Arc arc;
      arc.radius = radius, arc.sweep = sweep;
      for (const double x : reaches) {
        for (const double y : reaches) {
          for (const Vec3d& p : {Vec3d{x, y, 0}, Vec3d{-x, 0, y}, Vec3d{1, x, -x}}) {
            expect_finite(Inverse{}, arc, p);
            expect_finite(Squared{1.0, 1e-30}, arc, p);
            for (const double width : {1e-20, 1.0, 1e20}) {
              expect_finite(Gaussian{width, 1e4}, arc, p);
              expect_finite(Metaball{width}, arc, p);
              expect_finite(Soft{width}, arc, p);
            }
          }
        }
      }
    }
  }
}

TEST(ArcFields, StiffGaussiansDoNotOverflow) {
  // Blobbiness -1e6 at radius 1: the amplitude e^1e6 has no double, the field at radius 1 has.
  const Gaussian kernel{1e3, 1e6};
  Arc arc;
  arc.radius = 1e3, arc.sweep = 1.0;
  const Jet jet = integral(kernel, arc, Vec3d{1e3, 0, 1});
  EXPECT_NEAR(jet.value, std::sqrt(kPi) / 1e3, 1e-12);
  EXPECT_NEAR(jet.gradient.z, -2e6 * jet.value, 1e-6);
}

}  // namespace
}  // namespace cs2mesh
