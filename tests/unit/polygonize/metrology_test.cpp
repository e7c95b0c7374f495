#include "polygonize/metrology.h"

#include <tbb/global_control.h>

#include "polygonize/closest_point.h"
#include "polygonize/surface_projection.h"
#include "polygonize/surface_samples.h"
#include "tests/unit/polygonize/analytic_surfaces.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace test;
using namespace analytic;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Projection> projections(const ImplicitSurface& surface,
                                    const std::vector<Vec3d>& points) {
  std::vector<Projection> out(points.size());
  Aabb box;
  for (const Vec3d& p : points) box.include(p);
  project(surface, *surface.restrict_to(box), box, points, 20, out);
  return out;
}

TEST(Projection, IsTheDistanceToASphere) {
  const Surface<Sphere> sphere(Sphere{{0.3, -0.2, 0.5}, 1.5});
  Random random(5);
  std::vector<Vec3d> points = {{0.3, -0.2, 0.5}, {1.8, -0.2, 0.5}};  // the centre; on the surface
  for (int i = 0; i < 3000; ++i) {
    const double r = i % 2 ? random.uniform(0, 5) : 1.5 + random.uniform(-1e-3, 1e-3);
    points.push_back(Vec3d{0.3, -0.2, 0.5} + r * random.direction());
  }
  const std::vector<Projection> found = projections(sphere, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double r = norm(points[i] - Vec3d{0.3, -0.2, 0.5});
    EXPECT_NEAR(found[i].distance, std::abs(r - 1.5), 1e-9 + 1e-6 * std::abs(r - 1.5));
    EXPECT_NEAR(norm(found[i].foot - Vec3d{0.3, -0.2, 0.5}), 1.5, 1e-8);
    EXPECT_NEAR(norm(found[i].foot - points[i]), found[i].distance, 1e-12);
  }
}

TEST(Projection, FeetLieOnTheSurfaceAndAreNearlyNearest) {
  const Surface<Ellipsoid> surface(Ellipsoid{{1.0, 0.5, 0.1}});
  std::vector<SurfaceBlock> blocks = surface_blocks(surface, surface.bounds(), 40000, 1);
  std::vector<Vec3d> on;
  for (const SurfaceBlock& block : blocks) append_crossings(block, 4, on);
  Random random(8);
  std::vector<Vec3d> points;
  for (int i = 0; i < 300; ++i) points.push_back(random.uniform(0.2, 1.5) * random.direction());
  const std::vector<Projection> found = projections(surface, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = kInfinity;
    for (const Vec3d& q : on) nearest = std::min(nearest, norm(q - points[i]));
    EXPECT_NEAR(surface.value(found[i].foot), 0, 1e-9);
    EXPECT_LT(found[i].distance, 1.1 * nearest + 1e-6)
        << points[i].x << ' ' << points[i].y << ' ' << points[i].z;
    EXPECT_GT(found[i].distance, nearest - 0.02);
  }
}

struct Nothing {
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return T(-1.0) - square(p.x);
  }
  Aabb bounds() const { return {}; }
};

/// A plane whose F is rounded so coarsely that it has a flat step at 0.
struct Stepped {
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return (T(1.0) - p.x * T(0.3) - p.y * T(0.7) + T(64.0)) - T(64.0);
  }
  Aabb bounds() const { return cube(3); }
};

TEST(Projection, PointsOnTheSurfaceButForRounding) {
  const Surface<Stepped> surface;
  Random random(2);
  std::vector<Vec3d> points;
  for (int i = 0; i < 2000; ++i) {
    const double x = random.uniform(-1, 1);
    points.push_back({x, (1 - 0.3 * x) / 0.7 + random.uniform(-3e-14, 3e-14), 0.2});
  }
  for (const Projection& found : projections(surface, points)) {
    EXPECT_LT(found.distance, 1e-12);
  }
}

TEST(Projection, InfiniteWithoutSurface) {
  const std::vector<Projection> found = projections(Surface<Nothing>(), {{1, 2, 3}, {0, 0, 0}});
  EXPECT_EQ(found[0].distance, kInfinity);
  EXPECT_EQ(found[1].distance, kInfinity);
}

TEST(Metrology, SphereByAnOctahedron) {
  // Nearest and farthest points are known: vertices on the surface, centroids of faces farthest.
  const Surface<Sphere> sphere;
  MeasureOptions options;
  options.samples = 20000;
  const MeasuredError error = measure(sphere, sphere_mesh(0), options);
  const double depth = 1 - 1 / std::sqrt(3.0);
  EXPECT_NEAR(error.mesh_to_surface_max, depth, 1e-9);
  EXPECT_NEAR(norm(error.mesh_to_surface_at), 1 / std::sqrt(3.0), 1e-12);
  EXPECT_LE(error.surface_to_mesh_max, depth + 1e-12);
  EXPECT_GT(error.surface_to_mesh_max, depth - 1e-3);
  // The face normal and the radius at a corner: acos(1 / sqrt 3).
  EXPECT_LT(error.normal_deg_max, 54.7357);
  EXPECT_GT(error.normal_deg_max, 50);
  EXPECT_NEAR(static_cast<double>(error.mesh_samples), 20000, 1);
  EXPECT_GT(error.surface_samples, 10000u);
  EXPECT_LE(error.rms, error.p999);
  EXPECT_LE(error.p999, error.max());
  EXPECT_TRUE(error.complete);
}

TEST(Metrology, FindsOneDisplacedVertex) {
  TriangleMesh mesh = sphere_mesh(4);
  mesh.positions[700] *= 1.07;
  const MeasuredError error = measure(Surface<Sphere>(), mesh);
  EXPECT_NEAR(error.mesh_to_surface_max, 0.07, 1e-12);
  EXPECT_EQ(error.mesh_to_surface_at, mesh.positions[700]);
}

TEST(Metrology, FindsAMissingSheet) {
  // Only one of the two balls is meshed; the far end of the other is 1 away.
  const TriangleMesh mesh = sphere_mesh(5, {-0.5, 0, 0}, 0.5);
  MeasureOptions options;
  options.samples = 50000;
  const MeasuredError error = measure(Surface<TouchingSpheres>(), mesh, options);
  EXPECT_LT(error.mesh_to_surface_max, 1e-3);
  EXPECT_NEAR(error.surface_to_mesh_max, 1, 0.01);
  EXPECT_GT(error.surface_to_mesh_at.x, 0.95);
}

TEST(Metrology, CertifiedRaysFindSheetsThinnerThanTheLattice) {
  const Surface<ThinPlate> plate(ThinPlate{1e-4, 1.0});
  MeasureOptions options;
  options.certified_rays = 400;
  const TriangleMesh far = sphere_mesh(2, {0, 0, 5}, 0.1);
  const MeasuredError error = measure(plate, far, options);
  EXPECT_GT(error.ray_samples, 50u);
  EXPECT_NEAR(error.surface_to_mesh_max, std::hypot(5.0, 1.0) - 0.1, 0.05);
}

TEST(Metrology, NormalsTellFlippedTriangles) {
  TriangleMesh mesh = sphere_mesh(4);
  EXPECT_LT(measure(Surface<Sphere>(), mesh).normal_deg_max, 2);
  std::swap(mesh.triangles[100][0], mesh.triangles[100][1]);
  const MeasuredError error = measure(Surface<Sphere>(), mesh);
  EXPECT_GT(error.normal_deg_max, 178);
  EXPECT_LT(error.normal_deg_mean, 2);
}

TEST(Metrology, SeveralSurfacesCountTheNearestAndTheOutside) {
  const Surface<Sphere> a(Sphere{{0, 0, 0}, 1}), b(Sphere{{1.5, 0, 0}, 0.8});
  const std::vector<const ImplicitSurface*> both = {&a, &b};
  TriangleMesh mesh = sphere_mesh(5);
  const TriangleMesh second = sphere_mesh(5, {1.5, 0, 0}, 0.8);
  const auto base = static_cast<TriangleMesh::Index>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), second.positions.begin(), second.positions.end());
  for (const auto& t : second.triangles) {
    mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  MeasureOptions options;
  options.samples = 30000;
  EXPECT_LT(measure(both, mesh, options).max(), 2e-3);
  // What of b lies inside a may be missing from the mesh, what lies outside may not.
  TriangleMesh outside = mesh;
  std::erase_if(outside.triangles,
                [&](const auto& t) { return t[0] >= base && norm(mesh.positions[t[0]]) < 0.9; });
  ASSERT_LT(outside.triangles.size(), mesh.triangles.size());
  EXPECT_LT(measure(both, outside, options).max(), 2e-3);
  std::erase_if(mesh.triangles, [&](const auto& t) { return t[0] >= base; });
  EXPECT_NEAR(measure(both, mesh, options).surface_to_mesh_max, 1.3, 0.05);
}

TEST(Metrology, NothingAgainstSomething) {
  const MeasuredError no_mesh = measure(Surface<Sphere>(), TriangleMesh{});
  EXPECT_EQ(no_mesh.surface_to_mesh_max, kInfinity);
  EXPECT_EQ(no_mesh.mesh_to_surface_max, 0);
  const MeasuredError no_surface =
      measure(std::span<const ImplicitSurface* const>(), sphere_mesh(0));
  EXPECT_EQ(no_surface.mesh_to_surface_max, kInfinity);
}

TEST(Metrology, SameForAnyNumberOfThreads) {
  const auto run = [](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    MeasureOptions options;
    options.samples = 20000;
    options.certified_rays = 200;
    return measure(Surface<Torus>(), sphere_mesh(4), options);
  };
  const MeasuredError one = run(1), four = run(4);
  EXPECT_EQ(one.mesh_to_surface_max, four.mesh_to_surface_max);
  EXPECT_EQ(one.mesh_to_surface_at, four.mesh_to_surface_at);
  EXPECT_EQ(one.surface_to_mesh_max, four.surface_to_mesh_max);
  EXPECT_EQ(one.rms, four.rms);
  EXPECT_EQ(one.p999, four.p999);
  EXPECT_EQ(one.normal_deg_mean, four.normal_deg_mean);
  EXPECT_EQ(one.surface_samples, four.surface_samples);
}

class StopsAtOnce final : public Progress {
 public:
  bool cancelled() const override { return true; }
};

TEST(Metrology, StopsWhenAsked) {
  StopsAtOnce stop;
  MeasureOptions options;
  options.samples = 200000;
  options.progress = &stop;
  const MeasuredError error = measure(Surface<Sphere>(), sphere_mesh(5), options);
  EXPECT_FALSE(error.complete);
  EXPECT_LT(error.mesh_samples, 100000u);
}

}  // namespace
}  // namespace cs2mesh
