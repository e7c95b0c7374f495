// Integrals along the edges of triangles by panels that grow from the foot on, against much finer
// rules in extended precision.

#include "libfield/integral/edge_panels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/integral/gaussian_triangle.h"
#include "libfield/integral/squared_triangle.h"
#include "libfield/primitive/triangle.h"

namespace cs2mesh {
namespace {

using Real = long double;

/// int f over [from, to], by 20 nodes on panels of a quarter of sqrt(t^2 + gap^2) or `most`.
template <class F>
Real fine_integral(Real from, Real to, Real gap, Real most, const F& f) {
  constexpr const UnitRule<20>& rule = kUnitRule<20>;
  Real sum = 0.0L;
  for (Real t = from; t < to;) {
    const Real step = std::min({to - t, most, 0.25L * std::hypot(t, gap)});
    for (std::size_t i = 0; i < 20; ++i) {
      sum += step * rule.weight[i] * f(t + static_cast<Real>(rule.node[i]) * step);
    }
    t = to - t > step ? t + step : to;
  }
  return sum;
}

struct Sum {
  double weights = 0.0, squares = 0.0, farthest = 0.0;
};

Sum sum_over(double from, double to, bool lane, double gap) {
  Sum sum;
  detail::visit_edge_panels(
      detail::Stretch<double>{from, to, to - from}, lane,
      [&](double t) { return detail::longest_panel(kReach14, t, gap * gap); },
      [&](double t, double s, double weight) {
        sum.weights += 2.0 * weight;
        sum.squares += weight * (t * t + s * s);
        sum.farthest = std::max({sum.farthest, std::abs(t), std::abs(s)});
      });
  return sum;
}

TEST(EdgePanels, CoverTheStretchOnce) {
  for (const double gap : {1e-13, 1e-3, 0.2, 1.0, 50.0}) {
    for (const double from : {-2.0, -1.0, -0.25, 0.0, 1e-6, 0.5}) {
      for (const double length : {1e-5, 0.25, 1.0, 3.0}) {
        const double to = from + length;
        const Sum sum = sum_over(from, to, true, gap);
        EXPECT_NEAR(sum.weights, to - from, 1e-14 * (to - from));
        const double third = (to - from) * (to * to + to * from + from * from) / 3.0;
        EXPECT_NEAR(sum.squares, third, 1e-14 * std::abs(to - from) * sum.farthest * sum.farthest);
        EXPECT_LE(sum.farthest, std::max(std::abs(from), std::abs(to)));
        EXPECT_EQ(sum_over(-to, -from, true, gap).weights, sum.weights);
        EXPECT_EQ(sum_over(from, to, false, gap).weights, 0.0);
      }
    }
  }
}

TEST(EdgePanels, KeepTheirReachFromThePoles) {
  for (const double reach : {1.5, 2.2, 4.0}) {
    for (const double gap : {0.01, 1.0}) {
      for (const double t : {-3.0, -0.5, 0.0, 0.1, 2.0}) {
        const double length = detail::longest_panel(reach, t, gap * gap);
        EXPECT_NEAR(std::hypot(t, gap) + std::hypot(t + length, gap), reach * length,
                    1e-13 * length);
      }
    }
  }
}

TEST(SquaredPlaneGap, IsTheSquaredDistanceOfTheFoot) {
  const Triangle triangle{{Vec3d{-0.5, -0.3, 0}, {0.5, -0.3, 0}, {0.25, 0.5, 0}}};
  const TriangleFrame<double> frame(triangle);
  for (int i = 0; i < 200; ++i) {
    Random random(41, static_cast<std::uint64_t>(i));
    const Vec3d foot{random.uniform(-2, 2), random.uniform(-2, 2), 0};
    const TrianglePlace<double> at(frame, foot + Vec3d{0, 0, random.uniform(-1, 1)});
    const double gap = distance(triangle, foot);
    EXPECT_NEAR(detail::squared_plane_gap(at), gap * gap, 1e-14);
  }
}

/// An edge at a distance e from the foot, from t1 to t2; a is 1.
void expect_gaussian_edge(double x_least, double e, double t1, double t2) {
  const detail::GaussianForm<double> form(x_least);
  const double found = detail::gaussian_edge(form, 1.0, {t1, t2, e}, t2 - t1, true);
  const Real exact = e * fine_integral(t1, t2, std::abs(e), 0.25L, [&](Real t) {
                       const Real q = static_cast<Real>(e) * e + t * t;
                       return x_least < 1 ? -std::expm1(-q) / q : -std::exp(x_least - q) / q;
                     });
  // The exponents round as numbers of the size of x0.
  const double part = 4e-15 + 1e-16 * x_least;
  EXPECT_NEAR(found, static_cast<double>(exact), part * std::abs(static_cast<double>(exact)))
      << "x0 " << x_least << ", e " << e << ", t from " << t1 << " to " << t2;
}

TEST(GaussianEdge, NearTheTriangleIsExact) {
  for (const double e : {-0.7, 1e-9, 0.01, 0.3, 1.0, 3.0, 6.0, 8.0}) {
    for (const double t1 : {-9.0, -4.0, -0.3, 0.0, 0.5, 5.0}) {
      for (const double length : {0.1, 2.0, 2.6, 5.0, 12.0}) {
        expect_gaussian_edge(0.5, e, t1, t1 + length);
      }
    }
  }
}

TEST(GaussianEdge, BesideTheTriangleIsExact) {
  for (const double nearest : {1.0, 1.4, 3.0, 10.0}) {
    for (const double turn : {0.0, 0.3, 0.7, 1.1, 1.5}) {
      const double e = -nearest * std::cos(turn), t = nearest * std::sin(turn);
      for (const double length : {0.1, 1.0, 4.0, 20.0}) {
        expect_gaussian_edge(nearest * nearest, e, t, t + length);
        expect_gaussian_edge(nearest * nearest, e, -t - length, -t);
      }
      expect_gaussian_edge(e * e, e, -0.4, 0.7);
      expect_gaussian_edge(e * e, e, -5.0, 3.0);
    }
  }
}

TEST(GaussianEdge, OfAShortEdgeHasTheLengthThatIsGiven) {
  // t2 - t1 is off by one part in a million.
  const double e = 1.5, t = 5.0, length = 1.234e-10, q = e * e + t * t;
  for (const double x_least : {0.5, q}) {
    const detail::GaussianForm<double> form(x_least);
    const double rate = x_least < 1 ? -std::expm1(-q) / q : -std::exp(x_least - q) / q;
    const double found = detail::gaussian_edge(form, 1.0, {t, t + length, e}, length, true);
    EXPECT_NEAR(found, e * length * rate, 1e-8 * std::abs(e * length * rate));
  }
}

/// At a height z over the plane, the triangle's nearest point at a distance `gap` from the foot.
void expect_squared_edge(double z, double gap, double e, double t1, double t2) {
  const detail::SquaredForm<double> form(z * z, gap * gap);
  const auto sum = detail::squared_sums(form, {t1, t2, e}, z * z, t2 - t1, true);
  const Real e2 = static_cast<Real>(e) * e, z2 = static_cast<Real>(z) * z;
  const Real u0 = form.beside ? static_cast<Real>(gap) * gap + z2 : z2;
  const Real poles = std::sqrt(form.beside ? e2 : e2 + z2);
  const auto integral_of = [&](const auto& f) {
    return fine_integral(t1, t2, poles, 1e9L, [&](Real t) { return f(e2 + t * t); });
  };
  const Real value = integral_of([&](Real q) {
    if (form.beside) return u0 * std::log((q + z2) / u0) / q;
    return z2 * std::log1p(q / z2) / q;
  });
  const Real size = form.beside ? integral_of([&](Real q) { return u0 / q; }) : 0.0L;
  EXPECT_NEAR(sum.value, static_cast<double>(value),
              4e-15 * static_cast<double>(std::abs(value) + size))
      << "z " << z << ", e " << e << ", t from " << t1 << " to " << t2;
  if (!form.beside) return;
  const Real normal = integral_of([&](Real q) { return u0 * u0 / (q * (q + z2)); });
  EXPECT_NEAR(sum.normal, static_cast<double>(normal), 4e-15 * static_cast<double>(normal));
}

TEST(SquaredEdge, OverTheTriangleIsExact) {
  for (const double z : {1e-9, 1e-3, 0.2, 1.0, 7.0}) {
    for (const double e : {1e-12, 1e-3, 0.4, 2.0}) {
      for (const double t1 : {-1.0, -0.2, 0.0, 0.6}) {
        for (const double length : {1e-9, 0.5, 1.5})
          expect_squared_edge(z, 0.0, e, t1, t1 + length);
      }
    }
  }
}

TEST(SquaredEdge, BesideTheTriangleIsExact) {
  for (const double z : {0.0, 1e-6, 0.1, 0.4}) {
    for (const double turn : {0.0, 0.4, 1.2, 1.5}) {
      const double e = -std::cos(turn), t = std::sin(turn);
      for (const double length : {1e-3, 0.5, 3.0, 40.0}) {
        expect_squared_edge(z, 1.0, e, t, t + length);
        expect_squared_edge(z, 1.0, e, -t - length, -t);
      }
      expect_squared_edge(z, std::abs(e), e, -0.3, 0.8);
    }
  }
}

}  // namespace
}  // namespace cs2mesh
