// Every mesher of the table keeps the same promises over the same surfaces.
#include "polygonize/mesher.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <memory>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "libfield/field/counted_surface.h"
#include "polygonize/check.h"
#include "polygonize/metrology.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

struct Nothing {
  template <class T>
  T operator()(const Vec3<T>&) const {
    return T(-1.0);
  }
  Aabb bounds() const { return {}; }
};

struct Shape {
  std::string name;
  std::shared_ptr<const ImplicitSurface> surface;
  double radius = 1.0;
  bool creased = false;
  double tolerance = 0.01;
  std::size_t components = 1;
  long long genus = 0;
  friend std::ostream& operator<<(std::ostream& out, const Shape& shape) {
    return out << shape.name;
  }
};

template <class Function>
std::shared_ptr<const ImplicitSurface> made(const Function& f = {}) {
  return std::make_shared<Surface<Function>>(f);
}

std::vector<Shape> shapes() {
  return {
      {"sphere", made<Sphere>(), 1.0, false, 0.004},
      {"torus", made<Torus>(), 0.3, false, 0.004, 1, 1},
      {"ellipsoid", made<Ellipsoid>(), 0.3, false, 0.003},
      {"joined_blobs", made(CassiniOval{1.0, 1.1}), 0.2, false, 0.006},
      {"parted_blobs", made(CassiniOval{1.0, 0.9}), 0.2, false, 0.006, 2},
      {"near_spheres", made(TwoSpheres{0.05}), 0.5, false, 0.004, 2},
      {"clipped_saddle", made<ClippedSaddle>(), 1.0, true, 0.01},
      {"box", made<Box>(), 0.5, true, 0.01},
  };
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const Mesher& mesher : meshers()) all.emplace_back(mesher.name);
  return all;
}

MesherRequest request_for(const Shape& shape) {
  MesherRequest request;
  request.tolerance = shape.tolerance;
  request.thinnest_radius = shape.radius;
  request.creased = shape.creased;
  return request;
}

class EveryShape : public testing::TestWithParam<std::tuple<std::string, Shape>> {};

TEST_P(EveryShape, IsClosedManifoldAndWithinTheTolerance) {
  const auto& [name, shape] = GetParam();
  EvaluationCounter counter;
  const CountedSurface surface(shape.surface, &counter);
  const auto result = find_mesher(name)->mesh(surface, request_for(shape));
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->reached);
  EXPECT_LE(result->error, shape.tolerance);
  EXPECT_GT(result->cell, 0);
  // Of those of the cell meshers some vertices are roots between two nodes.
  EXPECT_GT(counter.total().gradients, result->mesh.positions.size() / 2);

  const MeshReport report = check(result->mesh);
  EXPECT_TRUE(report.ok());
  EXPECT_TRUE(report.closed && report.manifold_edges && report.manifold_vertices);
  EXPECT_TRUE(report.oriented && report.outward);
  EXPECT_EQ(report.self_intersections.value_or(0), 0U);
  EXPECT_EQ(report.components, shape.components);
  EXPECT_EQ(report.genus, shape.genus);
  EXPECT_EQ(report.voids, 0U);

  MeasureOptions options;
  options.samples = 20'000;
  const MeasuredError error = measure(*shape.surface, result->mesh, options);
  EXPECT_LE(error.mesh_to_surface_max, shape.tolerance);
  EXPECT_LE(error.surface_to_mesh_max, shape.tolerance);
}

INSTANTIATE_TEST_SUITE_P(Meshers, EveryShape,
                         testing::Combine(testing::ValuesIn(names()), testing::ValuesIn(shapes())),
                         [](const auto& info) {
                           return std::get<0>(info.param) + "_" + std::get<1>(info.param).name;
                         });

class EveryMesher : public testing::TestWithParam<std::string> {
 protected:
  static const Mesher& mesher() { return *find_mesher(GetParam()); }
};

TEST_P(EveryMesher, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const Shape& shape : shapes()) {
    if (shape.name != "joined_blobs" && shape.name != "clipped_saddle") continue;
    const auto with_threads = [&](std::size_t threads) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      return mesher().mesh(*shape.surface, request_for(shape));
    };
    const auto one = with_threads(1);
    const auto two = with_threads(2);
    ASSERT_TRUE(one && two);
    EXPECT_EQ(one->mesh.positions, two->mesh.positions);
    EXPECT_EQ(one->mesh.triangles, two->mesh.triangles);
  }
}

TEST_P(EveryMesher, KeepsTheToleranceWhereSmallFeaturesMayBeLost) {
  for (const Shape& shape : shapes()) {
    if (shape.name != "joined_blobs") continue;
    MesherRequest request = request_for(shape);
    const auto strict = mesher().mesh(*shape.surface, request);
    request.min_feature = 0.5 * shape.radius;
    const auto result = mesher().mesh(*shape.surface, request);
    ASSERT_TRUE(strict && result);
    EXPECT_FALSE(strict->unresolved_cells);
    EXPECT_TRUE(result->reached);
    EXPECT_TRUE(check(result->mesh).ok());
    MeasureOptions options;
    options.samples = 20'000;
    EXPECT_LE(measure(*shape.surface, result->mesh, options).max(), shape.tolerance);
  }
}

TEST_P(EveryMesher, HeedsLimits) {
  MesherRequest request = request_for(shapes().front());
  request.max_triangles = 100;
  auto limited = mesher().mesh(Surface<Sphere>{}, request);
  ASSERT_FALSE(limited);
  EXPECT_EQ(limited.diagnostics().front().failure, Failure::limit);
  request = request_for(shapes().front());
  request.max_nodes = 1000;
  limited = mesher().mesh(Surface<Sphere>{}, request);
  ASSERT_FALSE(limited);
  EXPECT_EQ(limited.diagnostics().front().failure, Failure::limit);
}

TEST_P(EveryMesher, HeedsWhoStopsItAnywhere) {
  /// Says yes from the n-th question on.
  struct Stop final : Progress {
    explicit Stop(int first) : left(first) {}
    bool cancelled() const override { return left.fetch_sub(1) <= 0; }
    mutable std::atomic<int> left;
  };
  MesherRequest request = request_for(shapes().front());
  Stop patient(1'000'000);
  request.progress = &patient;
  ASSERT_TRUE(mesher().mesh(Surface<Sphere>{}, request));
  const int questions = 1'000'000 - patient.left;
  ASSERT_GT(questions, 0);
  for (const int first : {0, questions / 8, questions / 4, questions / 2, questions * 3 / 4}) {
    Stop stop(first);
    request.progress = &stop;
    const auto stopped = mesher().mesh(Surface<Sphere>{}, request);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.diagnostics().front().failure, Failure::interrupted);
  }
}

TEST_P(EveryMesher, MakesAnEmptyMeshOfAnEmptySurface) {
  const auto result = mesher().mesh(Surface<Nothing>{}, request_for(shapes().front()));
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->mesh.empty());
  EXPECT_TRUE(result->reached);
}

TEST_P(EveryMesher, MeshesFarFromTheOrigin) {
  const Vec3d far{1e6, -2e6, 3e6};
  const auto result = mesher().mesh(Surface<Sphere>{Sphere{far, 1}}, request_for(shapes().front()));
  ASSERT_TRUE(result);
  EXPECT_TRUE(check(result->mesh).ok());
  for (const Vec3d& p : result->mesh.positions) EXPECT_NEAR(norm(p - far), 1.0, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Meshers, EveryMesher, testing::ValuesIn(names()),
                         [](const auto& info) { return info.param; });

TEST(Meshers, AreFoundByName) {
  EXPECT_EQ(find_mesher("adaptive"), &meshers().front());
  EXPECT_EQ(find_mesher("marching"), nullptr);
  for (const Mesher& mesher : meshers()) {
    EXPECT_EQ(find_mesher(mesher.name), &mesher);
    EXPECT_FALSE(mesher.promise.empty());
  }
}

}  // namespace
}  // namespace cs2mesh
