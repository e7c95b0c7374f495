// Octrees that follow a surface, and what they prove.
#include "polygonize/surface_octree.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/base/check.h"
#include "libfield/base/random.h"
#include "libfield/field/compile.h"
#include "libfield/field/field.h"
#include "polygonize/adaptive_mesher.h"
#include "polygonize/check.h"
#include "polygonize/metrology.h"
#include "polygonize/tolerance.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

SurfaceOctreeOptions fine(double tolerance) {
  SurfaceOctreeOptions options;
  options.tolerance = tolerance;
  options.smallest = 0.02 * tolerance;
  return options;
}

TEST(SurfaceOctree, EmptyLeavesHoldNoSurface) {
  const Surface<Torus> torus;
  const Result<SurfaceOctree> tree = SurfaceOctree::build(torus, fine(0.01));
  const Octree& octree = tree->octree();
  Random random(1, 1);
  std::size_t leaves = 0;
  for (Octree::Index i = 0; i < octree.size(); ++i) {
    if (!octree.is_leaf(i) || tree->kind(i) != LeafKind::empty) continue;
    ++leaves;
    const Aabb box = octree.box(i);
    for (int k = 0; k < 8; ++k) {
      const Vec3d p{random.uniform(box.min.x, box.max.x), random.uniform(box.min.y, box.max.y),
                    random.uniform(box.min.z, box.max.z)};
      ASSERT_EQ(torus.value(p) >= 0, octree[i].inside);
    }
  }
  EXPECT_GT(leaves, 1000U);
}

TEST(SurfaceOctree, SmoothSurfacesAreSimpleThroughout) {
  const Surface<Torus> torus;
  const Result<SurfaceOctree> tree = SurfaceOctree::build(torus, fine(0.01));
  for (Octree::Index i = 0; i < tree->octree().size(); ++i) {
    EXPECT_TRUE(!tree->octree().is_leaf(i) || tree->kind(i) != LeafKind::open);
  }
}

TEST(SurfaceOctree, IsCutNearPointsAlone) {
  const Surface<Torus> torus;
  Result<SurfaceOctree> tree = SurfaceOctree::build(torus, fine(0.01));
  const auto leaf_near = [&](const Vec3d& p) {
    Octree::Index cell = 0;
    while (!tree->octree().is_leaf(cell)) {
      const Vec3d middle = tree->octree().center(cell);
      const int corner =
          (p.x > middle.x ? 1 : 0) | (p.y > middle.y ? 2 : 0) | (p.z > middle.z ? 4 : 0);
      cell = tree->octree().child(cell, corner);
    }
    return cell;
  };
  const Vec3d here{0.0, 1.25, 0.01}, there{0.0, -1.25, 0.01};
  const int before = tree->octree()[leaf_near(here)].level;
  const int far_before = tree->octree()[leaf_near(there)].level;
  const Result<std::size_t> cut = tree->cut_near({&here, 1});
  ASSERT_TRUE(cut);
  EXPECT_GT(*cut, 0U);
  EXPECT_LE(*cut, 8U);
  EXPECT_EQ(tree->octree()[leaf_near(here)].level, before + 1);
  EXPECT_EQ(tree->octree()[leaf_near(there)].level, far_before);
  // Far from the surface there is nothing to cut.
  const Vec3d away{0.0, 0.0, 0.0};
  EXPECT_EQ(*tree->cut_near({&away, 1}), 0U);
}

TEST(SurfaceOctree, HeedsItsLimits) {
  const Surface<Sphere> sphere;
  SurfaceOctreeOptions options = fine(0.01);
  options.max_cells = 100;
  const Result<SurfaceOctree> tree = SurfaceOctree::build(sphere, options);
  ASSERT_FALSE(tree);
  EXPECT_EQ(tree.diagnostics().front().failure, Failure::limit);
  options.tolerance = 0;
  EXPECT_THROW((void)SurfaceOctree::build(sphere, options), ContractViolation);
}

/// One element of radius 1.
Result<CompiledScene> stiff(KernelKind kernel, const Primitive& skeleton) {
  Scene scene;
  Material material;
  material.name = "m";
  material.kernel = kernel;
  material.radius = 1.0;
  material.blobbiness = -160;
  scene.materials.push_back(material);
  Element element;
  element.skeleton = skeleton;
  scene.elements.push_back(element);
  return compile(scene);
}

std::size_t cells_of(const Result<CompiledScene>& compiled) {
  SurfaceOctreeOptions options;
  options.tolerance = 0.02;
  options.smallest = 1.0 / 64 / 160;
  const Result<SurfaceOctree> tree = SurfaceOctree::build(*compiled->parts[0].surface, options);
  for (Octree::Index i = 0; i < tree->octree().size(); ++i) {
    EXPECT_TRUE(!tree->octree().is_leaf(i) || tree->kind(i) != LeafKind::open);
  }
  return tree->octree().size();
}

// Half of the cells of such a surface have their middle where F is level; and F grows towards the
// part of a ring that is in sight.
TEST(SurfaceOctree, IsNoFinerForTheEdgesOfFiniteSupports) {
  const Primitive ball = Point{{0, 0, 0}};
  const Primitive ring = make_arc({0, 0, 0}, 2.2, {0.1, 0.2, 1}, 0, 360);
  const std::size_t gaussian_ball = cells_of(stiff(KernelKind::gaussian, ball));
  for (const KernelKind kind : {KernelKind::metaball, KernelKind::soft, KernelKind::quartic}) {
    EXPECT_LT(cells_of(stiff(kind, ball)), 10 * gaussian_ball);
    EXPECT_LT(cells_of(stiff(kind, ring)), 40 * gaussian_ball);
  }
}

/// A ball of whose gradient nothing is known.
class VagueBall final : public ImplicitSurface {
 public:
  void values(std::span<const Vec3d> points, std::span<double> out) const override {
    ball_.values(points, out);
  }
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override {
    ball_.jets(points, out);
  }
  Interval enclose(const Aabb& box) const override { return ball_.enclose(box); }
  std::array<Interval, 3> enclose_gradient(const Aabb&) const override {
    return {Interval::everything(), Interval::everything(), Interval::everything()};
  }
  double derivative_bound(int, const Aabb&) const override { return HUGE_VAL; }
  Aabb bounds() const override { return ball_.bounds(); }
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb&) const override {
    return std::make_unique<VagueBall>();
  }

 private:
  Surface<Sphere> ball_;
};

TEST(SurfaceOctree, GivesUpWhereProofsFail) {
  const VagueBall ball;
  SurfaceOctreeOptions options = fine(0.02);
  options.fair_side = 0.1;
  options.most_slopes = 1000;
  const Result<SurfaceOctree> tree = SurfaceOctree::build(ball, options);
  ASSERT_TRUE(tree);
  EXPECT_TRUE(tree->gave_up());
  const Octree& octree = tree->octree();
  std::size_t open = 0;
  for (Octree::Index i = 0; i < octree.size(); ++i) {
    if (!octree.is_leaf(i)) continue;
    EXPECT_GE(octree.side(octree[i].level), 0.25 * options.fair_side);
    open += tree->kind(i) == LeafKind::open ? 1 : 0;
  }
  EXPECT_GT(open, 0U);
}

/// Stiff Gaussian balls of radius 1/2 at the corners of a cube; they all but touch.
Result<CompiledScene> balls(double gap, double blobbiness) {
  Scene scene;
  Material material;
  material.name = "m";
  material.kernel = KernelKind::gaussian;
  material.radius = 0.5;
  material.blobbiness = -blobbiness;
  scene.materials.push_back(material);
  for (int i = 0; i < 8; ++i) {
    Element element;
    const Int3 step = corner_step(i);
    element.skeleton = Point{(1 + gap) * Vec3d{double(step.x), double(step.y), double(step.z)}};
    scene.elements.push_back(element);
  }
  return compile(scene);
}

/// How many balls a mesh at a coarse tolerance has, and whether all of it is proven.
std::pair<std::size_t, std::size_t> components_and_open(double gap) {
  const Result<CompiledScene> compiled = balls(gap, 20);
  MesherRequest request;
  request.tolerance = 0.1;
  request.thinnest_radius = 0.5;
  AdaptiveStatistics log;
  const Result<MesherResult> made = mesh_adaptive(*compiled->parts[0].surface, request, &log);
  const MeshReport report = check(made->mesh);
  EXPECT_TRUE(made->reached);
  EXPECT_EQ(report.self_intersections.value_or(0), 0U);
  return {report.components, log.open_leaves};
}

/// Balls of many sizes, most of which touch others.
Result<CompiledScene> random_balls(Random& random) {
  Scene scene;
  for (int size = 0; size < 3; ++size) {
    Material material;
    material.name = std::string(1, static_cast<char>('a' + size));
    material.kernel = KernelKind::gaussian;
    material.radius = std::pow(3.0, -size);
    material.blobbiness = -6;
    scene.materials.push_back(material);
    const int count = size == 0 ? 1 : 12 * size;
    for (int i = 0; i < count; ++i) {
      Element element;
      element.material = size;
      element.skeleton = Point{(size == 0 ? 0.0 : 1.0 + *material.radius) * random.direction()};
      scene.elements.push_back(element);
    }
  }
  return compile(scene);
}

TEST(AdaptiveMesher, ProvenTopologiesAreTheSameAtEveryTolerance) {
  Random random(9, 1);
  for (int round = 0; round < 12; ++round) {
    const Result<CompiledScene> compiled = random_balls(random);
    std::vector<std::array<std::size_t, 2>> found;
    for (const double tolerance : {0.08, 0.02}) {
      MesherRequest request;
      request.tolerance = tolerance;
      request.thinnest_radius = compiled->parts[0].thinnest_radius;
      AdaptiveStatistics log;
      const Result<MesherResult> made = mesh_adaptive(*compiled->parts[0].surface, request, &log);
      ASSERT_TRUE(made);
      if (log.open_leaves > 0) continue;
      const MeshReport report = check(made->mesh);
      found.push_back({report.components, static_cast<std::size_t>(report.genus)});
    }
    for (const auto& topology : found) EXPECT_EQ(topology, found.front()) << "scene " << round;
  }
}

TEST(AdaptiveMesher, GapsFarBelowTheToleranceStayOpen) {
  EXPECT_EQ(components_and_open(0.06), (std::pair<std::size_t, std::size_t>(8, 0)));
}

TEST(AdaptiveMesher, NecksFarBelowTheToleranceAreJoined) {
  EXPECT_EQ(components_and_open(-0.02), (std::pair<std::size_t, std::size_t>(1, 0)));
}

/// Profiles that jump or bend are meshed on lattices, whose cells suit what is thinnest in the
/// scene, and made coarse.
TEST(AdaptiveMesher, TakesFewTrianglesOfProfiles) {
  Term bone;
  bone.kernel = Gaussian{4.0, 3.0};
  bone.primitive = Segment{{-1, 0, 0}, {1, 0, 0}};
  bone.frame = frame_of(bone.primitive);
  StrengthProfile waves;
  waves.along_u = ProfileFunction::sin;
  waves.scale_u = 5;
  waves.times = 1.2;
  waves.lower = 0.5;
  waves.upper = 0.8;
  bone.profiles = {waves};
  const Field surface({bone}, 1e-9);
  MesherRequest request;
  request.tolerance = 0.01;
  request.thinnest_radius = 0.05;
  const Result<MesherResult> made = mesh_adaptive(surface, request);
  ASSERT_TRUE(made);
  EXPECT_TRUE(made->reached);
  const Result<MesherResult> dense = mesh_by_lattice(surface, request);
  ASSERT_TRUE(dense);
  EXPECT_LT(4 * made->mesh.triangles.size(), dense->mesh.triangles.size());
  EXPECT_TRUE(check(made->mesh).ok());
  EXPECT_LE(measure(surface, made->mesh, {}).max(), request.tolerance);
}

}  // namespace
}  // namespace cs2mesh
