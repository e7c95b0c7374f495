// Laws of the lattice mesher on random input: whatever the signs, the mesh keeps its promises.
#include "polygonize/lattice_mesher.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "polygonize/check.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

double number(double lo, double hi) {
  return lo + (hi - lo) * *rc::gen::inRange(0, 1'000'000) * 1e-6;
}

RC_GTEST_PROP(LatticeMesher, EveryPatternOfSignsGivesAClosedManifold, ()) {
  const double smallest = *rc::gen::element(0.0, 0.3, 1.0);
  const LatticeNoise noise(*rc::gen::inRange(2, 11), number(0.05, 0.95), smallest,
                           *rc::gen::arbitrary<std::uint64_t>());
  // On the nodes of the noise every one of the 256 cases occurs; off them, creases at every turn.
  const bool aligned = *rc::gen::arbitrary<bool>();
  const LatticeOptions options{.cell = aligned ? 1.0 : number(0.4, 1.5),
                               .origin = aligned ? Vec3d{} : Vec3d{number(0, 1), 0, number(0, 1)}};
  const auto mesh = mesh_lattice(noise, options);
  RC_ASSERT(mesh.diagnostics().empty());
  const MeshReport report = check(*mesh);
  RC_ASSERT(report.closed);
  RC_ASSERT(report.manifold_edges);
  RC_ASSERT(report.manifold_vertices);
  RC_ASSERT(report.oriented);
  RC_ASSERT(report.outward);
  RC_ASSERT(report.count(DefectKind::degenerate_triangle) == 0U);
  RC_ASSERT(report.count(DefectKind::duplicate_vertex) == 0U);
  RC_ASSERT(report.self_intersections.value_or(0) == 0U);
}

RC_GTEST_PROP(LatticeMesher, RandomBallsKeepEveryPromise, ()) {
  const double radius = number(0.1, 2);
  const Sphere sphere{{number(-1, 1), number(-1, 1), number(-1, 1)}, radius};
  const double cell = radius * number(0.05, 0.8);
  const auto mesh = mesh_lattice(Surface<Sphere>{sphere}, {.cell = cell});
  const MeshReport report = check(*mesh);
  RC_ASSERT(report.ok());
  RC_ASSERT(report.components == 1U);
  RC_ASSERT(report.genus == 0);
  for (const Vec3d& p : mesh->positions) {
    RC_ASSERT(std::abs(norm(p - sphere.center) - radius) < 1e-12 * radius);
  }
}

RC_GTEST_PROP(LatticeMesher, NodesOnTheSurfaceDoNoHarm, ()) {
  // A ball about a node whose surface passes through others, up to a few ulps.
  const int k = *rc::gen::inRange(1, 12);
  const double radius = 0.125 * k * (1 + *rc::gen::inRange(-4, 5) * 0x1p-52);
  const auto mesh = mesh_lattice(Surface<Sphere>{Sphere{{}, radius}}, {.cell = 0.125});
  const MeshReport report = check(*mesh);
  RC_ASSERT(report.ok());
  RC_ASSERT(report.components == 1U);
}

}  // namespace
}  // namespace cs2mesh
