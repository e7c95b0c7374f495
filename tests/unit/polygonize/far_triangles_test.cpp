// Triangles are called far where they are.
#include "polygonize/far_triangles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "libfield/base/random.h"
#include "libfield/field/field.h"
#include "polygonize/distinct_points.h"
#include "polygonize/near_proof.h"
#include "tests/unit/polygonize/analytic_surfaces.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace analytic;

Field blob() {
  Term term;
  term.kernel = Gaussian{std::sqrt(3.0), 3.0};
  term.primitive = Point{Vec3d{}};
  term.frame = frame_of(term.primitive);
  return Field({term}, 1e-9);
}

/// A ball of triangles of many sizes, vertices off the surface by up to `off`.
TriangleMesh uneven_ball(double off) {
  TriangleMesh mesh = test::bare_sphere({}, 1, 3);
  Random random(5);
  for (Vec3d& p : mesh.positions) {
    p = normalized(p + (0.05 * random.uniform()) * random.direction());
    p = (1 + off * random.uniform(-1, 1)) * p;
  }
  return mesh;
}

/// How far a triangle is from the unit ball, by many points.
double true_distance(const TriangleMesh& mesh, std::size_t t) {
  constexpr int kSteps = 40;
  const auto& [a, b, c] = mesh.triangles[t];
  double most = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const Vec3d p = (1.0 / kSteps) * (i * mesh.positions[a] + j * mesh.positions[b] +
                                        (kSteps - i - j) * mesh.positions[c]);
      most = std::max(most, std::abs(norm(p) - 1));
    }
  }
  return most;
}

void expect_true_verdicts(const ImplicitSurface& surface, const TriangleMesh& mesh,
                          std::span<const Vec3d> directions) {
  constexpr double kBlurred = 0.05;  // of the tolerance: points are few
  std::vector<std::size_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  for (const double tolerance : {0.003, 0.006, 0.01, 0.015, 0.03}) {
    FarOptions options{tolerance, 8 * tolerance};
    options.directions = directions;
    std::vector<bool> far(all.size(), false);
    for (const LostPoint& lost : far_triangles(surface, mesh, all, options)) {
      far[lost.triangle] = true;
      EXPECT_GT(lost.distance, tolerance);
    }
    for (const std::size_t t : all) {
      const double distance = true_distance(mesh, t);
      if (std::abs(distance - tolerance) > kBlurred * tolerance) {
        EXPECT_EQ(far[t], distance > tolerance) << t << ' ' << distance;
      }
    }
  }
}

TEST(FarTriangles, AreThoseThatAreFar) {
  const Field ball = blob();
  const Surface<Sphere> sphere;
  for (const double off : {0.0, 0.004}) {
    const TriangleMesh mesh = uneven_ball(off);
    expect_true_verdicts(ball, mesh, {});
    expect_true_verdicts(ball, mesh, ways_out(mesh));
    expect_true_verdicts(sphere, mesh, {});
  }
}

/// Inside everywhere, with a slope that tolerances cannot be divided by.
struct NearlyLevel {
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return T(0.5) - T(1e-310) * (square(p.x) + square(p.y) + square(p.z));
  }
  static Aabb bounds() { return {{-1, -1, -1}, {1, 1, 1}}; }
};

TEST(FarTriangles, AreAllWhereTheFieldIsNearlyLevel) {
  const Surface<NearlyLevel> level;
  const TriangleMesh mesh = test::bare_sphere({}, 1, 3);
  std::vector<std::size_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const FarOptions options{0.01, 0.08};
  EXPECT_EQ(far_triangles(level, mesh, all, options).size(), all.size());
}

TEST(DistinctPoints, AreAllThereOnce) {
  const std::vector<Vec3d> points{{1, 2, 3}, {0, 5, 0}, {1, 2, 3}, {0, 4, 9}, {0, 5, 0}};
  const DistinctPoints distinct(points);
  EXPECT_EQ(distinct.points().size(), 3U);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(distinct.points()[distinct.number(i)], points[i]);
  }
  EXPECT_TRUE(DistinctPoints({}).points().empty());
}

}  // namespace
}  // namespace cs2mesh
