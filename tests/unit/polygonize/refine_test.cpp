// Local refinement: what is joined stays closed, and comes near.
#include "polygonize/refine.h"

#include <gtest/gtest.h>

#include "libfield/base/check.h"
#include "polygonize/check.h"
#include "polygonize/editable_mesh.h"
#include "polygonize/insert_points.h"
#include "polygonize/metrology.h"
#include "polygonize/shell_probe.h"
#include "polygonize/surface_watch.h"
#include "tests/unit/polygonize/analytic_surfaces.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace analytic;

double largest_error(const ImplicitSurface& surface, const TriangleMesh& mesh) {
  MeasureOptions options;
  options.samples = 50'000;
  return measure(surface, mesh, options).max();
}

TEST(HalfEdges, OppositesRunTheOtherWay) {
  const TriangleMesh mesh = test::bare_sphere({}, 1, 2);
  const std::vector<HalfEdge> opposite = opposite_half_edges(mesh);
  for (HalfEdge h = 0; h < opposite.size(); ++h) {
    EXPECT_EQ(opposite[opposite[h]], h);
    EXPECT_EQ(start_of(mesh, h), end_of(mesh, opposite[h]));
  }
  TriangleMesh open = mesh;
  open.triangles.pop_back();
  EXPECT_THROW(opposite_half_edges(open), ContractViolation);
}

TEST(EditableMesh, StaysClosedWhateverIsSplit) {
  EditableMesh mesh(test::bare_sphere({}, 1, 1));
  Random random(3);
  for (int i = 0; i < 400; ++i) {
    const std::size_t count = mesh.mesh().triangles.size();
    const auto pick = static_cast<std::size_t>(random.uniform() * static_cast<double>(count));
    const Vec3d p = random.direction();
    if (i % 2 == 0) {
      mesh.split_triangle(pick, p);
    } else {
      mesh.split_edge(static_cast<HalfEdge>(3 * pick + i % 3), p);
    }
  }
  const std::vector<HalfEdge> fresh = opposite_half_edges(mesh.mesh());
  for (HalfEdge h = 0; h < fresh.size(); ++h) EXPECT_EQ(mesh.opposite(h), fresh[h]);
  CheckOptions options;
  options.self_intersections = false;
  const MeshReport report = check(mesh.take(), options);
  EXPECT_TRUE(report.closed && report.manifold_edges && report.manifold_vertices);
  EXPECT_EQ(report.genus, 0);
}

TEST(Refine, BringsASphereWithinToleranceWithItsVerticesOnIt) {
  for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
    RefineStatistics statistics;
    const TriangleMesh mesh = refine(Surface<Sphere>{}, test::bare_sphere({}, 1, 1),
                                     {.tolerance = tolerance}, &statistics);
    EXPECT_TRUE(statistics.far.empty());
    EXPECT_LE(largest_error(Surface<Sphere>{}, mesh), 1.1 * tolerance);
    EXPECT_TRUE(check(mesh).ok());
    for (const Vec3d& p : mesh.positions) EXPECT_NEAR(norm(p), 1.0, 1e-14);
  }
}

TEST(Refine, TellsWhatTheLastRoundHasNotSeen) {
  const TriangleMesh before = test::bare_sphere({}, 1, 1);
  RefineStatistics statistics;
  const TriangleMesh once =
      refine(Surface<Sphere>{}, before, {.tolerance = 1e-3, .most_rounds = 1}, &statistics);
  EXPECT_EQ(statistics.rounds, 1);
  EXPECT_EQ(statistics.first_unseen, before.positions.size());
  EXPECT_GT(once.positions.size(), before.positions.size());
  refine(Surface<Sphere>{}, once, {.tolerance = 1e-2}, &statistics);
  EXPECT_EQ(statistics.first_unseen, ~TriangleMesh::Index{0}) << "all";
}

TEST(Refine, LeavesAloneWhatIsNearEnough) {
  const TriangleMesh before = test::bare_sphere({}, 1, 4);
  RefineStatistics statistics;
  const TriangleMesh after = refine(Surface<Sphere>{}, before, {.tolerance = 0.01}, &statistics);
  EXPECT_EQ(statistics.splits, 0U);
  EXPECT_EQ(after.triangles, before.triangles);
  // Triangles of old vertices count as known.
  const auto all = static_cast<TriangleMesh::Index>(before.positions.size());
  const TriangleMesh known =
      refine(Surface<Sphere>{}, before, {.tolerance = 1e-6, .first_new = all});
  EXPECT_EQ(known.triangles, before.triangles);
}

TEST(InsertPoints, ATentReachesALostPoint) {
  TriangleMesh mesh = test::bare_sphere({}, 1, 3);
  const ClosestPoint tree(mesh);
  Random random(5);
  std::vector<LostPoint> lost;
  for (int i = 0; i < 20; ++i) {
    const Vec3d p = 1.1 * random.direction();
    const ClosestPoint::Hit hit = tree.nearest(p);
    lost.push_back({p, hit.point, hit.distance, hit.triangle});
  }
  const std::vector<std::size_t> joined = insert_points(Surface<Sphere>{}, mesh, lost);
  EXPECT_GE(joined.size(), 15U);
  const std::size_t first = mesh.positions.size() - joined.size();
  for (std::size_t i = 0; i < joined.size(); ++i) {
    EXPECT_EQ(mesh.positions[first + i], lost[joined[i]].on_surface);
  }
  EXPECT_TRUE(check(mesh).ok());
}

/// A unit ball with a slot of width 0.02 across it, from its top down to z = 0.8.
struct SlottedBall {
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return smaller(ball(p, {}, 1.0), larger(square(p.x) - T(1e-4), T(0.8) - p.z));
  }
  Aabb bounds() const { return cube(1.0); }
};

TEST(ShellProbe, FindsTheBottomOfASlotThatTheMeshBridges) {
  const Surface<SlottedBall> surface{};
  const TriangleMesh mesh = test::bare_sphere({}, 1, 4);
  const ClosestPoint tree(mesh);
  const std::vector<LostPoint> lost =
      probe_shell(surface, mesh, tree, {.enough = 0.05, .spacing = 0.3});
  ASSERT_FALSE(lost.empty());
  for (const LostPoint& point : lost) {
    EXPECT_LT(std::abs(point.on_surface.x), 0.0101);
    EXPECT_GT(point.distance, 0.05);
    EXPECT_LT(std::abs(surface.value(point.on_surface)), 1e-3);
  }
  const std::vector<LostPoint> none =
      probe_shell(Surface<Sphere>{}, mesh, tree, {.enough = 0.05, .spacing = 0.3});
  EXPECT_TRUE(none.empty());
}

TEST(SurfaceWatch, SeesAPieceThatTheMeshLacks) {
  const Surface<TouchingSpheres> two{};
  const SurfaceWatch watch(two, {.samples = 20'000, .enough = 0.1});
  ASSERT_TRUE(watch.any());
  const SurfaceWatch::Look look = watch.look(ClosestPoint(test::bare_sphere({}, 1, 4)));
  EXPECT_GT(look.farthest, 0.1);
  EXPECT_FALSE(look.lost.empty());
  for (const LostPoint& lost : look.lost) {
    EXPECT_NEAR(two.value(lost.on_surface), 0.0, 1e-4);
    EXPECT_NEAR(norm(lost.on_surface - lost.on_mesh), lost.distance, 1e-12);
  }
}

}  // namespace
}  // namespace cs2mesh
