// A surface that counts answers as the surface itself does, to the bit.
#include "libfield/field/counted_surface.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <vector>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

/// Answers each question in a way of its own, so that a question passed on as another one shows.
class Telltale final : public ImplicitSurface {
 public:
  explicit Telltale(double number) : number_(number) {}
  void values(std::span<const Vec3d> points, std::span<double> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = number_ + points[i].x;
  }
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = {number_ + 1, points[i]};
  }
  void second_jets(std::span<const Vec3d> points, std::span<Jet2> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i].value = number_ + 2 + points[i].y;
  }
  Interval enclose(const Aabb&) const override { return Interval(number_ + 3); }
  void enclose_each(std::span<const Aabb> boxes, std::span<Interval> out) const override {
    for (std::size_t i = 0; i < boxes.size(); ++i) out[i] = Interval(number_ + 4);
  }
  std::array<Interval, 3> enclose_gradient(const Aabb&) const override {
    return {Interval(number_ + 5), Interval(0.0), Interval(1.0)};
  }
  double least_slope(const Aabb&, const Vec3d& direction) const override {
    return number_ + 6 + direction.z;
  }
  bool has_cheap_bounds() const override { return number_ > 0; }
  bool has_cheap_hull_bounds() const override { return number_ > 0; }
  double derivative_bound(int order, const Aabb&) const override { return number_ + 7 + order; }
  Aabb bounds() const override { return {{0, 0, 0}, {number_, 1, 1}}; }
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb&) const override {
    return std::make_unique<Telltale>(10 * number_);
  }

 private:
  double number_;
};

/// Asks each question once, over `n` points or boxes where that is possible.
void expect_alike(const ImplicitSurface& a, const ImplicitSurface& b, std::size_t n) {
  const std::vector<Vec3d> points(n, {0.25, 0.5, 0.75});
  const Aabb box{{0, 0, 0}, {1, 1, 1}};
  const std::vector<Aabb> boxes(n, box);
  std::vector<double> f(n), g(n);
  a.values(points, f), b.values(points, g);
  EXPECT_EQ(f, g);
  std::vector<Jet> j(n), k(n);
  a.jets(points, j), b.jets(points, k);
  std::vector<Jet2> jj(n), kk(n);
  a.second_jets(points, jj), b.second_jets(points, kk);
  std::vector<Interval> r(n), s(n);
  a.enclose_each(boxes, r), b.enclose_each(boxes, s);
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_EQ(j[i].value, k[i].value);
    EXPECT_EQ(j[i].gradient, k[i].gradient);
    EXPECT_EQ(jj[i].value, kk[i].value);
    EXPECT_EQ(r[i].lo, s[i].lo);
  }
  EXPECT_EQ(a.enclose(box).lo, b.enclose(box).lo);
  EXPECT_EQ(a.enclose_gradient(box)[0].lo, b.enclose_gradient(box)[0].lo);
  EXPECT_EQ(a.least_slope(box, {0, 0, 2}), b.least_slope(box, {0, 0, 2}));
  EXPECT_EQ(a.derivative_bound(3, box), b.derivative_bound(3, box));
  EXPECT_EQ(a.has_cheap_bounds(), b.has_cheap_bounds());
  EXPECT_EQ(a.has_cheap_hull_bounds(), b.has_cheap_hull_bounds());
  EXPECT_EQ(a.bounds().max, b.bounds().max);
}

TEST(CountedSurface, AnswersAsTheSurfaceAndCounts) {
  const auto surface = std::make_shared<Telltale>(1.0);
  EvaluationCounter counter;
  const CountedSurface counted(surface, &counter);
  EXPECT_EQ(counter.total(), Evaluations{});
  expect_alike(*surface, counted, 5);
  EXPECT_EQ(counter.total(), (Evaluations{15, 10, 5, 9}));
}

TEST(CountedSurface, RestrictionsCountInTheSamePlace) {
  const auto surface = std::make_shared<Telltale>(-2.0);
  EvaluationCounter counter;
  const CountedSurface counted(surface, &counter);
  const Aabb box{{0, 0, 0}, {1, 1, 1}};
  const auto once = counted.restrict_to(box);
  expect_alike(*surface->restrict_to(box), *once, 2);
  expect_alike(*surface->restrict_to(box)->restrict_to(box), *once->restrict_to(box), 1);
  EXPECT_EQ(counter.total(), (Evaluations{9, 6, 3, 11}));
}

TEST(CountedSurface, ThreadsLoseNothing) {
  EvaluationCounter counter;
  const CountedSurface counted(std::make_shared<Telltale>(1.0), &counter);
  tbb::parallel_for(0, 20'000, [&](int) { counted.jet({0, 0, 0}); });
  EXPECT_EQ(counter.total(), (Evaluations{20'000, 20'000, 0, 0}));
  EXPECT_EQ(counter.total() - Evaluations({1, 2, 0, 0}), (Evaluations{19'999, 19'998, 0, 0}));
}

TEST(CountedSurface, NeedsASurfaceAndACounter) {
  EvaluationCounter counter;
  EXPECT_THROW(CountedSurface(nullptr, &counter), ContractViolation);
  EXPECT_THROW(CountedSurface(std::make_shared<Telltale>(1.0), nullptr), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
