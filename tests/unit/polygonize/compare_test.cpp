#include "polygonize/compare.h"

#include "tests/unit/polygonize/analytic_surfaces.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace test;
using namespace analytic;

Part part(const std::string& name, const Vec3d& center, double radius) {
  Part out;
  out.name = name;
  out.surface = std::make_shared<Surface<Sphere>>(Sphere{center, radius});
  return out;
}

struct Fixture {
  CompiledScene compiled;
  Scene scene;
  Model model;
  CompareOptions options;

  Fixture() {
    compiled.parts = {part("soft", {0, 0, 0}, 1), part("eye", {1, 0.3, 0}, 0.4)};
    compiled.extent = {{-1, -1, -1}, {1.4, 1, 1}};
    model.parts = {{"eye", sphere_mesh(5, {1, 0.3, 0}, 0.4)}, {"soft", sphere_mesh(5)}};
    scene.camera.has_eye = true;
    scene.camera.eye = {0, -6, 0};
    options.samples = 20000;
    options.certified_rays = 200;
  }
};

TEST(Compare, PartsByName) {
  Fixture f;
  const Result<CompareReport> report = compare(f.compiled, f.scene, f.model, f.options);
  ASSERT_TRUE(report);
  ASSERT_EQ(report->parts.size(), 2u);
  EXPECT_EQ(report->parts[0].name, "soft");
  EXPECT_LT(report->total.max(), 1.5e-3);
  EXPECT_GT(report->total.max(), 0);
  EXPECT_EQ(report->total.max(),
            std::max(report->parts[0].error.max(), report->parts[1].error.max()));
  EXPECT_GT(report->silhouette_pixels, 500u);
  EXPECT_LT(report->silhouette_xor, 0.01);
  EXPECT_EQ(report->uncertain_pixels, 0u);
}

TEST(Compare, OneWayMayBeLeftOut) {
  Fixture f;
  const Result<CompareReport> both = compare(f.compiled, f.scene, f.model, f.options);
  f.options.mesh_to_surface = false;
  const Result<CompareReport> one = compare(f.compiled, f.scene, f.model, f.options);
  ASSERT_TRUE(both && one);
  EXPECT_EQ(one->total.mesh_samples, 0u);
  EXPECT_EQ(one->total.mesh_to_surface_max, 0);
  EXPECT_EQ(one->total.surface_to_mesh_max, both->total.surface_to_mesh_max);
}

TEST(Compare, OtherNamesMeanTheWhole) {
  Fixture f;
  for (MeshPart& mesh : f.model.parts) mesh.name = "mesh";
  const Result<CompareReport> report = compare(f.compiled, f.scene, f.model, f.options);
  ASSERT_TRUE(report);
  ASSERT_EQ(report->parts.size(), 1u);
  EXPECT_LT(report->total.max(), 1.5e-3);
}

TEST(Compare, TellsAMissingPart) {
  Fixture f;
  f.model.parts.erase(f.model.parts.begin());
  const Result<CompareReport> report = compare(f.compiled, f.scene, f.model, f.options);
  ASSERT_TRUE(report);
  EXPECT_NEAR(report->total.surface_to_mesh_max, std::hypot(1.0, 0.3) + 0.4 - 1, 0.02);
  EXPECT_GT(report->silhouette_xor, 0.02);
}

TEST(Compare, SilhouetteOfASmallerSphere) {
  Fixture f;
  f.compiled.parts.pop_back();
  f.model.parts = {{"soft", sphere_mesh(5, {}, 0.9)}};
  f.scene.camera.width = f.scene.camera.height = 400;
  f.scene.camera.fov_horizontal = f.scene.camera.fov_vertical = 25;
  const Result<CompareReport> report = compare(f.compiled, f.scene, f.model, f.options);
  ASSERT_TRUE(report);
  // Discs of tangent r / sqrt(36 - r^2): the share of the area between them.
  const double outer = 1 / 35.0, inner = 0.81 / (36 - 0.81);
  EXPECT_NEAR(report->silhouette_xor, 1 - inner / outer, 0.01);
}

TEST(Compare, Errors) {
  Fixture f;
  const Result<CompareReport> empty = compare(f.compiled, f.scene, Model{}, f.options);
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.diagnostics().front().failure, Failure::bad_input);
  struct Stop final : Progress {
    bool cancelled() const override { return true; }
  } stop;
  f.options.progress = &stop;
  const Result<CompareReport> stopped = compare(f.compiled, f.scene, f.model, f.options);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.diagnostics().front().failure, Failure::interrupted);
}

}  // namespace
}  // namespace cs2mesh
