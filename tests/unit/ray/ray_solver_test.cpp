#include "libfield/ray/ray_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "libfield/base/check.h"
#include "libfield/base/random.h"
#include "libfield/field/field.h"
#include "libfield/ray/bound_tree.h"
#include "tests/unit/ray/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using test::Cube;
using test::GaussianSum;
using test::Sphere;
using test::Torus;

constexpr double kFar = 1e3;

Ray random_ray(Random& random, double spread) {
  const Vec3d from = 6.0 * random.direction();
  const Vec3d to = spread * random.direction();
  return {from, normalized(to - from)};
}

GaussianSum three_blobs() {
  return {{{{0, 0, 0}, 1.0, 1.0}, {{1.3, 0.2, 0}, 2.0, 1.0}, {{-0.5, 1.1, 0.4}, 1.5, 0.8}}, 0.4};
}

/// Sign changes of F between equidistant samples, as intervals.
std::vector<Interval> sampled_crossings(const ImplicitSurface& surface, const Ray& ray, double t1,
                                        int n) {
  std::vector<Interval> crossings;
  bool inside = surface.value(ray.at(0.0)) >= 0.0;
  for (int i = 1; i <= n; ++i) {
    const double t = t1 * i / n;
    const bool now = surface.value(ray.at(t)) >= 0.0;
    if (now != inside) crossings.push_back({t1 * (i - 1) / n, t});
    inside = now;
  }
  return crossings;
}

TEST(RaySolver, FindsBothCrossingsOfASphereToTheStatedError) {
  const Vec3d c{0.3, -0.2, 0.1};
  const Sphere sphere(c, 1.25);
  Random random(1);
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const Ray ray = random_ray(random, 2.0);
    const double along = dot(c - ray.origin, ray.direction);
    const Vec3d off = ray.origin + along * ray.direction - c;
    const double half2 = 1.25 * 1.25 - squared_norm(off);
    std::vector<RayHit> found;
    all_hits(sphere, ray, 0.0, kFar, {}, found);
    if (half2 < 0.0) {
      EXPECT_TRUE(found.empty());
      continue;
    }
    ++hits;
    ASSERT_EQ(found.size(), 2u);
    const double half = std::sqrt(half2);
    for (int k = 0; k < 2; ++k) {
      const RayHit& hit = found[static_cast<std::size_t>(k)];
      EXPECT_EQ(hit.status, RayStatus::hit);
      EXPECT_EQ(hit.entering, k == 0);
      EXPECT_LE(hit.t_error, 1e-9);
      EXPECT_LE(std::abs(hit.t - (along + (k == 0 ? -half : half))), hit.t_error + 1e-14);
    }
  }
  EXPECT_GT(hits, 100);
}

TEST(RaySolver, FindsAllFourCrossingsOfATorus) {
  const Torus torus(2.0, 0.5);
  const Ray ray{{-5, 0, 0}, {1, 0, 0}};
  std::vector<RayHit> hits;
  all_hits(torus, ray, 0.0, kFar, {}, hits);
  ASSERT_EQ(hits.size(), 4u);
  const double exact[4] = {2.5, 3.5, 6.5, 7.5};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(hits[k].status, RayStatus::hit);
    EXPECT_NEAR(hits[k].t, exact[k], hits[k].t_error + 1e-14);
    EXPECT_LE(hits[k].t_error, 1e-9);
  }
  EXPECT_EQ(first_hit(torus, ray, 0.0, kFar).t, hits[0].t);
}

TEST(RaySolver, AgreesWithDenseSamplingOnSumsAndTori) {
  const GaussianSum blobs = three_blobs();
  const Torus torus(1.0, 0.35);
  Random random(2);
  int crossings = 0;
  for (int i = 0; i < 400; ++i) {
    const ImplicitSurface& surface = i % 2 ? static_cast<const ImplicitSurface&>(blobs) : torus;
    const Ray ray = random_ray(random, 1.5);
    const std::vector<Interval> sampled = sampled_crossings(surface, ray, 12.0, 3000);
    std::vector<RayHit> hits;
    all_hits(surface, ray, 0.0, 12.0, {}, hits);
    // A pair of roots nearer than two samples may be missed by the samples, never by the solver.
    ASSERT_GE(hits.size(), sampled.size());
    std::size_t k = 0;
    for (const RayHit& hit : hits) {
      EXPECT_EQ(hit.status, RayStatus::hit);
      if (k < sampled.size() && sampled[k].contains(hit.t)) ++k;
    }
    EXPECT_EQ(k, sampled.size());
    crossings += static_cast<int>(k);
  }
  EXPECT_GT(crossings, 300);
}

TEST(RaySolver, StatedErrorHoldsAtTheSignChange) {
  const GaussianSum blobs = three_blobs();
  Random random(3);
  for (const double accuracy : {1e-3, 1e-6, 1e-9}) {
    RaySolverOptions options;
    options.accuracy = accuracy;
    for (int i = 0; i < 200; ++i) {
      const Ray ray = random_ray(random, 1.2);
      const RayHit hit = first_hit(blobs, ray, 0.0, kFar, options);
      if (hit.status != RayStatus::hit) continue;
      EXPECT_LE(hit.t_error, accuracy);
      const double before = blobs.value(ray.at(hit.t - 1.01 * hit.t_error));
      const double after = blobs.value(ray.at(hit.t + 1.01 * hit.t_error));
      EXPECT_TRUE(before < 0.0 && after >= 0.0) << before << " " << after << " " << accuracy;
    }
  }
}

TEST(RaySolver, GrazingRaysAreExcludedAtAPriceLogarithmicInTheMargin) {
  // Two Gaussians side by side; the ray passes where the peak of the sum is T (1 - m).
  const auto peak = [](double y) { return 2.0 * std::exp(-(0.8 * 0.8 + y * y)); };
  const double y = 0.7;
  for (const double m : {1e-1, 1e-2, 1e-4, 1e-6, 1e-8}) {
    const GaussianSum blobs({{{-0.8, 0, 0}, 1.0, 1.0}, {{0.8, 0, 0}, 1.0, 1.0}},
                            peak(y) / (1.0 - m));
    RayCost cost;
    const RayHit miss = first_hit(blobs, {{0, y, -5}, {0, 0, 1}}, 0.0, kFar, {}, &cost);
    EXPECT_EQ(miss.status, RayStatus::miss) << m;
    EXPECT_LE(cost.jets, 8u + static_cast<unsigned>(6.0 * -std::log10(m))) << m;
    std::vector<RayHit> hits;
    const GaussianSum cut({{{-0.8, 0, 0}, 1.0, 1.0}, {{0.8, 0, 0}, 1.0, 1.0}}, peak(y) / (1.0 + m));
    all_hits(cut, {{0, y, -5}, {0, 0, 1}}, 0.0, kFar, {}, hits);
    ASSERT_EQ(hits.size(), 2u) << m;
    // exp(-z^2) (1 + m) = 1 at the crossings.
    const double z = std::sqrt(std::log1p(m));
    EXPECT_NEAR(hits[0].t, 5.0 - z, hits[0].t_error + 1e-14);
    EXPECT_NEAR(hits[1].t, 5.0 + z, hits[1].t_error + 1e-14);
  }
}

TEST(RaySolver, ATangentRayIsUncertainNotAMiss) {
  const Sphere sphere({0, 0, 0}, 1.0);
  const RayHit hit = first_hit(sphere, {{-3, 1, 0}, {1, 0, 0}}, 0.0, kFar);
  EXPECT_EQ(hit.status, RayStatus::uncertain);
  EXPECT_NEAR(hit.t, 3.0, hit.t_error);
  EXPECT_LT(hit.t_error, 1e-6);
}

TEST(RaySolver, StartsInsideAndOnTheSurface) {
  const Sphere sphere({0, 0, 0}, 1.0);
  const RayHit out = first_hit(sphere, {{0.5, 0, 0}, {1, 0, 0}}, 0.0, kFar);
  EXPECT_EQ(out.status, RayStatus::hit);
  EXPECT_FALSE(out.entering);
  EXPECT_NEAR(out.t, 0.5, 1e-9);
  // Leaving the surface outwards meets nothing; going inwards meets the far side.
  EXPECT_EQ(first_hit(sphere, {{1, 0, 0}, {1, 0, 0}}, 1e-6, kFar).status, RayStatus::miss);
  const RayHit through = first_hit(sphere, {{1, 0, 0}, {-1, 0, 0}}, 1e-6, kFar);
  EXPECT_NEAR(through.t, 2.0, 1e-9);
  // Inside up to the end of the range.
  EXPECT_EQ(first_hit(sphere, {{0, 0, 0}, {1, 0, 0}}, 0.0, 0.5).status, RayStatus::miss);
}

TEST(RaySolver, ValuesDeepInsideDoNotBlurTheSurface) {
  // Two balls, F = 1e170 in their middles; 64 units of rounding of that are more than F is near 1.
  std::vector<Term> terms(2);
  for (Term& term : terms) term.kernel = Gaussian{std::sqrt(400.0), 400.0};
  terms[0].primitive = Point{{-1.5, 0, 0}};
  terms[1].primitive = Point{{1.5, 0, 0}};
  for (Term& term : terms) term.frame = frame_of(term.primitive);
  const Field balls(std::move(terms), 1e-9);
  const BoundTree tree(balls, 5000);
  for (const double y : {0.0, 0.3, 0.9}) {
    const Ray ray{{-6, y, 0}, {1, 0, 0}};
    std::vector<RayHit> alone, by_tree;
    all_hits(balls, ray, 0.0, 12.0, {}, alone);
    all_hits(tree, ray, 0.0, 12.0, {}, by_tree);
    const double half = std::sqrt(1.0 - y * y);
    const std::vector<double> right = {4.5 - half, 4.5 + half, 7.5 - half, 7.5 + half};
    for (const std::vector<RayHit>& hits : {alone, by_tree}) {
      ASSERT_EQ(hits.size(), 4u) << y;
      for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_EQ(hits[k].status, RayStatus::hit);
        EXPECT_NEAR(hits[k].t, right[k], hits[k].t_error + 1e-12);
        EXPECT_LT(hits[k].t_error, 2e-9);
      }
    }
  }
}

TEST(RaySolver, SeparatesTwoNearbyRoots) {
  const Sphere sphere({0, 0, 0}, 1.0);
  for (const double gap : {1e-2, 1e-4, 1e-6}) {
    const double y = std::sqrt((1.0 - 0.5 * gap) * (1.0 + 0.5 * gap));
    std::vector<RayHit> hits;
    all_hits(sphere, {{-3, y, 0}, {1, 0, 0}}, 0.0, kFar, {}, hits);
    ASSERT_EQ(hits.size(), 2u) << gap;
    EXPECT_EQ(hits[0].status, RayStatus::hit);
    EXPECT_NEAR(hits[1].t - hits[0].t, gap, hits[0].t_error + hits[1].t_error + 1e-9 * gap);
  }
}

TEST(RaySolver, HandlesCreases) {
  const Cube cube(1.0);
  Random random(4);
  std::uint64_t jets = 0;
  int hit_count = 0;
  for (int i = 0; i < 300; ++i) {
    const Ray ray = random_ray(random, 1.2);
    const RayRange exact = clip(ray, cube.bounds(), {0.0, kFar});
    RayCost cost;
    std::vector<RayHit> hits;
    all_hits(cube, ray, 0.0, kFar, {}, hits, &cost);
    if (exact.empty() || exact.t1 - exact.t0 < 1e-9) {
      EXPECT_TRUE(hits.empty() || hits[0].status == RayStatus::uncertain);
      continue;
    }
    ASSERT_EQ(hits.size(), 2u);
    EXPECT_NEAR(hits[0].t, exact.t0, hits[0].t_error + 1e-13);
    EXPECT_NEAR(hits[1].t, exact.t1, hits[1].t_error + 1e-13);
    jets += cost.jets;
    ++hit_count;
  }
  EXPECT_GT(hit_count, 100);
  EXPECT_LE(jets, static_cast<std::uint64_t>(40 * hit_count));
}

/// Claims a second derivative that is too small by `factor`.
class Boaster : public GaussianSum {
 public:
  Boaster(const GaussianSum& honest, double factor) : GaussianSum(honest), factor_(factor) {}
  Interval enclose(const Aabb&) const override { return Interval::everything(); }
  double derivative_bound(int order, const Aabb& box) const override {
    return factor_ * GaussianSum::derivative_bound(order, box);
  }

 private:
  double factor_;
};

int disagreements_with_sampling(const ImplicitSurface& surface) {
  Random random(5);
  int wrong = 0;
  for (int i = 0; i < 300; ++i) {
    const Ray ray = random_ray(random, 1.5);
    std::vector<RayHit> hits;
    all_hits(surface, ray, 0.0, 12.0, {}, hits);
    wrong += hits.size() < sampled_crossings(surface, ray, 12.0, 1500).size();
  }
  return wrong;
}

TEST(RaySolver, DenseSamplingCatchesAWrongBound) {
  const GaussianSum blobs = three_blobs();
  EXPECT_EQ(disagreements_with_sampling(Boaster(blobs, 1.0)), 0);
  EXPECT_GT(disagreements_with_sampling(Boaster(blobs, 0.02)), 0);
}

TEST(RaySolver, CostsLittle) {
  const GaussianSum blobs = three_blobs();
  Random random(6);
  RayCost hit_cost;
  RayCost miss_cost;
  std::uint64_t hits = 0;
  std::uint64_t misses = 0;
  for (int i = 0; i < 2000; ++i) {
    const Ray ray = random_ray(random, 2.0);
    RayCost cost;
    const bool hit = first_hit(blobs, ray, 0.0, kFar, {}, &cost).status == RayStatus::hit;
    (hit ? hit_cost : miss_cost) += cost;
    ++(hit ? hits : misses);
  }
  const auto mean = [](std::uint64_t total, std::uint64_t n) {
    return static_cast<double>(total) / static_cast<double>(n);
  };
  RecordProperty("jets_per_hit", std::to_string(mean(hit_cost.jets, hits)));
  RecordProperty("jets_per_miss", std::to_string(mean(miss_cost.jets, misses)));
  RecordProperty("bounds_per_hit", std::to_string(mean(hit_cost.bounds, hits)));
  RecordProperty("bounds_per_miss", std::to_string(mean(miss_cost.bounds, misses)));
  EXPECT_LE(mean(hit_cost.jets, hits), 15.0);
  EXPECT_LE(mean(miss_cost.jets, misses), 3.0);
}

TEST(RaySolver, FindsTheSameByATreeOfBoundsWithFewerOfThem) {
  const GaussianSum blobs = three_blobs();
  const Torus torus(1.0, 0.35);
  const Cube cube(0.8);
  for (const ImplicitSurface* surface :
       {static_cast<const ImplicitSurface*>(&blobs), static_cast<const ImplicitSurface*>(&torus),
        static_cast<const ImplicitSurface*>(&cube)}) {
    const BoundTree tree(*surface, 5000);
    Random random(7);
    RayCost alone_cost;
    RayCost tree_cost;
    for (int i = 0; i < 400; ++i) {
      Ray ray = random_ray(random, 1.5);
      // Along the planes between cells, too.
      if (i % 10 == 0) ray = {{-6, 0, 0.01 * i}, {1, 0, 0}};
      std::vector<RayHit> alone;
      std::vector<RayHit> by_tree;
      all_hits(*surface, ray, 0.0, 12.0, {}, alone, &alone_cost);
      all_hits(tree, ray, 0.0, 12.0, {}, by_tree, &tree_cost);
      ASSERT_EQ(alone.size(), by_tree.size()) << i;
      for (std::size_t k = 0; k < alone.size(); ++k) {
        EXPECT_EQ(alone[k].status, by_tree[k].status);
        EXPECT_EQ(alone[k].entering, by_tree[k].entering);
        EXPECT_NEAR(alone[k].t, by_tree[k].t, alone[k].t_error + by_tree[k].t_error);
      }
    }
    EXPECT_LT(tree_cost.bounds, alone_cost.bounds);
  }
}

TEST(RaySolver, ATreeLeavesOutNoSurface) {
  const GaussianSum blobs = three_blobs();
  const BoundTree tree(blobs, 2000);
  Random random(8);
  for (int i = 0; i < 300; ++i) {
    const Ray ray = random_ray(random, 1.5);
    std::vector<BoundTree::Stretch> stretches;
    tree.walk(ray, {0.0, 12.0}, stretches);
    double covered_to = 0.0;
    for (const BoundTree::Stretch& stretch : stretches) {
      EXPECT_GE(stretch.t0, covered_to);
      EXPECT_GT(stretch.t1, stretch.t0);
      covered_to = stretch.t1;
    }
    for (const Interval& crossing : sampled_crossings(blobs, ray, 12.0, 500)) {
      bool covered = false;
      for (const BoundTree::Stretch& stretch : stretches) {
        covered = covered || (stretch.t0 <= crossing.hi && crossing.lo <= stretch.t1);
      }
      EXPECT_TRUE(covered);
    }
  }
}

TEST(RaySolver, FromAfarTheTreeSteersClearOfRounding) {
  const Sphere sphere({0, 0, 0}, 1.0);
  const BoundTree tree(sphere);
  const double far = 1e10;
  EXPECT_FALSE(tree.serves({{-far, 0, 0}, {1, 0, 0}}, far));
  const RayHit hit = first_hit(tree, {{-far, 0, 0}, {1, 0, 0}}, 0.0, 2.0 * far);
  EXPECT_EQ(hit.status, RayStatus::hit);
  EXPECT_NEAR(hit.t, far - 1.0, hit.t_error);
}

TEST(RaySolver, GivesUpWithinItsBudgetAndSaysSo) {
  const GaussianSum blobs = three_blobs();
  RaySolverOptions options;
  options.max_evaluations = 4;
  RayCost cost;
  const RayHit hit = first_hit(blobs, {{0.1, 0.2, -5}, {0, 0, 1}}, 0.0, kFar, options, &cost);
  EXPECT_EQ(hit.status, RayStatus::uncertain);
  EXPECT_LE(cost.jets + cost.bounds, 4u + 8u);
  EXPECT_LE(hit.t - hit.t_error, 5.0);
  EXPECT_GE(hit.t + hit.t_error, 5.0);
}

TEST(RaySolver, RefusesWhatIsNoRay) {
  const Sphere sphere({0, 0, 0}, 1.0);
  EXPECT_THROW(first_hit(sphere, {{0, 0, 0}, {0, 0, 2}}, 0.0, 1.0), ContractViolation);
  EXPECT_THROW(first_hit(sphere, {{0, 0, 0}, {0, 0, 1}}, std::nan(""), 1.0), ContractViolation);
  EXPECT_EQ(first_hit(sphere, {{0, 0, 0}, {0, 0, 1}}, 2.0, 1.0).status, RayStatus::miss);
}

}  // namespace
}  // namespace cs2mesh
