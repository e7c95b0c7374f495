#include "polygonize/edge_root.h"

#include <gtest/gtest.h>

#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

/// F = f(x), whatever y and z.
template <class F>
class AlongX final : public ImplicitSurface {
 public:
  explicit AlongX(F f) : f_(f) {}
  void values(std::span<const Vec3d> points, std::span<double> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = f_(points[i].x).value;
  }
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = f_(points[i].x);
  }
  Interval enclose(const Aabb&) const override { return Interval::everything(); }
  std::array<Interval, 3> enclose_gradient(const Aabb&) const override {
    return {Interval::everything(), Interval::everything(), Interval::everything()};
  }
  double derivative_bound(int, const Aabb&) const override { return HUGE_VAL; }
  Aabb bounds() const override { return cube(1); }
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb&) const override {
    return std::make_unique<AlongX>(f_);
  }

 private:
  F f_;
};

template <class F>
double root_along_x(F f, double a, double b, EdgeRootCounts& counts) {
  const AlongX<F> surface(f);
  const CrossedEdge edge{{a, 0, 0}, {b, 0, 0}, surface.jet({a, 0, 0}), surface.jet({b, 0, 0})};
  Vec3d root;
  find_roots(surface, {&edge, 1}, {&root, 1}, counts);
  return root.x;
}

TEST(HermiteRoot, ExactForCubics) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    // (t - r) times a positive quadratic
    const double r = random.uniform(0.01, 0.99);
    const double s = random.uniform(-3, 3);
    const double w = random.uniform(0.3, 2);
    const auto p = [&](double t) { return (t - r) * ((t - s) * (t - s) + w); };
    const auto d = [&](double t) { return (t - s) * (t - s) + w + (t - r) * 2 * (t - s); };
    EXPECT_NEAR(hermite_root(p(0), d(0), p(1), d(1)), r, 1e-11);
  }
}

TEST(FindRoots, SmoothSurfacesTakeFewRounds) {
  const Surface<Torus> torus;
  std::vector<CrossedEdge> edges;
  Random random(2);
  while (edges.size() < 2000) {
    const Vec3d a{random.uniform(-1.4, 1.4), random.uniform(-1.4, 1.4), random.uniform(-0.4, 0.4)};
    const Vec3d b = a + 0.05 * random.direction();
    const Jet at_a = torus.jet(a);
    const Jet at_b = torus.jet(b);
    if ((at_a.value >= 0) != (at_b.value >= 0)) edges.push_back({a, b, at_a, at_b});
  }
  std::vector<Vec3d> roots(edges.size());
  EdgeRootCounts counts;
  find_roots(torus, edges, roots, counts);
  EXPECT_LE(counts.jets, 3 * edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Jet jet = torus.jet(roots[i]);
    EXPECT_LE(std::abs(jet.value), 1e-14 * norm(jet.gradient));
    // On the edge, between its ends.
    EXPECT_LE(norm(roots[i] - edges[i].a) + norm(roots[i] - edges[i].b),
              norm(edges[i].b - edges[i].a) * (1 + 1e-14) + 1e-15);
  }
}

TEST(FindRoots, JumpsFlatSpotsAndKinksAreFoundByBisection) {
  EdgeRootCounts counts;
  const auto jump = [](double x) { return Jet{x < 0.3 ? 1.0 : -1.0, {0, 0, 0}}; };
  EXPECT_NEAR(root_along_x(jump, 0, 1, counts), 0.3, 1e-14);
  const auto flat = [](double x) {
    const double d = 0.7 - x;
    return Jet{d * d * d, {-3 * d * d, 0, 0}};
  };
  EXPECT_NEAR(root_along_x(flat, 0, 1, counts), 0.7, 1e-5);  // F is 1e-15 from there on
  const auto kink = [](double x) {
    return x < 0.6 ? Jet{1e6 * (0.6 - x), {-1e6, 0, 0}} : Jet{1e-6 * (0.6 - x), {-1e-6, 0, 0}};
  };
  EXPECT_NEAR(root_along_x(kink, 0, 1, counts), 0.6, 1e-13);
  const auto wrong_gradient = [](double x) { return Jet{0.4 - x, {5, 0, 0}}; };
  EXPECT_NEAR(root_along_x(wrong_gradient, 0, 1, counts), 0.4, 1e-13);
  const auto nan_gradient = [](double x) { return Jet{0.4 - x, {std::nan(""), 0, 0}}; };
  EXPECT_NEAR(root_along_x(nan_gradient, 0, 1, counts), 0.4, 1e-13);
}

TEST(FindRoots, RootsAtAnEndAreMovedOffIt) {
  EdgeRootCounts counts;
  const auto at_end = [](double x) { return Jet{0.0 - x, {-1, 0, 0}}; };
  EXPECT_NEAR(root_along_x(at_end, 0, 1, counts), kEndClearance, 1e-9);
  EXPECT_EQ(counts.clamped, 1U);
}

}  // namespace
}  // namespace cs2mesh
