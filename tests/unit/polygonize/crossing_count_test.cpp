// How often segments are said to cross a surface, and how often they do.
#include "polygonize/crossing_count.h"

#include <gtest/gtest.h>

#include "libfield/base/random.h"
#include "libfield/field/compile.h"

namespace cs2mesh {
namespace {

Result<CompiledScene> touching_balls() {
  Scene scene;
  Material material;
  material.name = "skin";
  material.kernel = KernelKind::gaussian;
  material.radius = 0.5;
  material.blobbiness = -6;
  scene.materials.push_back(material);
  for (const Vec3d& at : {Vec3d{-0.5, 0, 0}, Vec3d{0.5, 0, 0}, Vec3d{0, 0.87, 0}}) {
    Element element;
    element.skeleton = Point{at};
    scene.elements.push_back(element);
  }
  return compile(scene);
}

/// As seen from many points of the segment.
int sampled_crossings(const ImplicitSurface& surface, const Vec3d& a, const Vec3d& b) {
  constexpr int kSamples = 500;
  int changes = 0;
  bool inside = surface.value(a) >= 0;
  for (int i = 1; i <= kSamples; ++i) {
    const bool now = surface.value(a + static_cast<double>(i) / kSamples * (b - a)) >= 0;
    if (now != inside) ++changes;
    inside = now;
  }
  return changes;
}

TEST(CrossingCount, IsThatOfSamplesWhereItIsTold) {
  const Result<CompiledScene> scene = touching_balls();
  const ImplicitSurface& surface = *scene->parts[0].surface;
  Random random(6, 1);
  FieldCounts counts;
  std::size_t told[2] = {}, twice = 0;
  for (int round = 0; round < 3000; ++round) {
    const double length = 0.4 * random.uniform();
    const Vec3d a{random.uniform(-1.1, 1.1), random.uniform(-0.6, 1.4), random.uniform(-0.6, 0.6)};
    const Vec3d b = a + length * random.direction();
    const int count = count_crossings(surface, a, surface.jet(a), b, counts);
    const int sampled = sampled_crossings(surface, a, b);
    twice += sampled == 2 ? 1 : 0;
    if (count == 2) continue;
    EXPECT_EQ(count, sampled) << "round " << round;
    ++told[count];
  }
  EXPECT_GT(told[0], 1500U);
  EXPECT_GT(told[1], 100U);
  EXPECT_GT(twice, 10U) << "else the test says little";
  EXPECT_GE(counts.values, 3000U);
  EXPECT_LE(counts.values, 2U * 3000U) << "at most four each, mostly one";
  EXPECT_EQ(counts.gradients, counts.values);
}

}  // namespace
}  // namespace cs2mesh
