// A mesh brought near its surface from both sides keeps what meshes promise.
#include "polygonize/bring_near.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/base/check.h"
#include "polygonize/check.h"
#include "polygonize/metrology.h"
#include "tests/unit/polygonize/analytic_surfaces.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace analytic;

BringNearOptions options_for(double tolerance) {
  BringNearOptions options;
  options.tolerance = tolerance;
  options.reach = 0.1;
  options.small = 8 * tolerance;
  return options;
}

/// A ball with a knob on it that a coarse mesh of the ball has no vertex on.
struct Knob {
  static constexpr Vec3d kCenter{0.11, 0.07, 0.93};
  static constexpr double kRadius = 0.2;
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return larger(ball(p, {}, 1.0), ball(p, kCenter, kRadius));
  }
  Aabb bounds() const { return cube(1.2); }
};

TEST(BringNear, ABallComesWithinAnyTolerance) {
  const Surface<Sphere> surface;
  for (const double tolerance : {0.1, 0.01, 0.001}) {
    TriangleMesh mesh = test::bare_sphere({}, 1);
    std::vector<Vec3d> on_surface;
    Random random(3);
    for (int i = 0; i < 500; ++i) on_surface.push_back(random.direction());
    const BroughtNear brought = bring_near(surface, mesh, on_surface, options_for(tolerance));
    EXPECT_LE(brought.error, kAcceptedPart * tolerance);
    EXPECT_TRUE(check(mesh).ok()) << tolerance;
    MeasureOptions measuring;
    measuring.samples = 50'000;
    EXPECT_LE(measure(surface, mesh, measuring).max(), tolerance);
  }
}

TEST(BringNear, PointsThatTheMeshMissesAreJoined) {
  const Surface<Knob> surface;
  const double tolerance = 0.03;
  const Vec3d tip = Knob::kCenter + Vec3d{0, 0, Knob::kRadius};
  TriangleMesh mesh = test::bare_sphere({}, 1, 3);
  const BroughtNear brought = bring_near(surface, mesh, {&tip, 1}, options_for(tolerance));
  EXPECT_LE(brought.error, tolerance);
  const MeshReport report = check(mesh);
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.genus, 0);
  EXPECT_NEAR(bounds(mesh).max.z, tip.z, tolerance);
}

TEST(BringNear, AMeshThatIsNearStaysSo) {
  const Surface<Sphere> surface;
  TriangleMesh mesh = test::bare_sphere({}, 1, 5);
  const std::vector<Vec3d> on_surface = mesh.positions;
  const std::size_t before = mesh.triangles.size();
  const BroughtNear brought = bring_near(surface, mesh, on_surface, options_for(0.01));
  EXPECT_LE(brought.error, 0.01);
  EXPECT_TRUE(brought.trouble.empty());
  EXPECT_LE(mesh.triangles.size(), before);
}

TEST(BringNear, RefusesLengthsThatAreNotPositive) {
  const Surface<Sphere> surface;
  TriangleMesh mesh = test::bare_sphere({}, 1);
  EXPECT_THROW(bring_near(surface, mesh, {}, {}), ContractViolation);
}

}  // namespace
}  // namespace cs2mesh
