#include "libfield/ray/render.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "tests/unit/ray/analytic_surfaces.h"

namespace cs2mesh {
namespace {

class OneMaterial : public MaterialBlend {
 public:
  explicit OneMaterial(int material) : material_(material) {}
  void shares(const Vec3d&, std::vector<MaterialShare>& shares) const override {
    shares.assign(1, {material_, 1.0});
  }

 private:
  int material_;
};

struct Stage {
  Scene scene;
  CompiledScene compiled;

  /// A matt surface of that colour.
  void add(std::shared_ptr<const ImplicitSurface> surface, const Color& color) {
    Material material;
    material.diffuse = color;
    const int index = static_cast<int>(scene.materials.size());
    scene.materials.push_back(material);
    compiled.extent.include(surface->bounds());
    Part part;
    part.name = "part" + std::to_string(index);
    part.surface = std::move(surface);
    part.materials = std::make_shared<OneMaterial>(index);
    compiled.parts.push_back(part);
  }
};

/// Seen from z = 5 with 40 degrees, 100 x 100 pixels.
Stage unit_sphere() {
  Stage stage;
  stage.add(std::make_shared<test::Sphere>(Vec3d{0, 0, 0}, 1.0), {1, 1, 1});
  Camera& camera = stage.scene.camera;
  camera.eye = {0, 0, 5};
  camera.has_eye = true;
  camera.up = {0, 1, 0};
  camera.fov_horizontal = camera.fov_vertical = 40.0;
  camera.width = camera.height = 100;
  return stage;
}

TEST(Render, SphereHasItsSilhouetteDepthAndNormals) {
  const Stage stage = unit_sphere();
  RenderOptions options;
  options.depth = options.normal = options.cost = true;
  const Result<RenderedImage> image = render(stage.compiled, stage.scene, options);
  ASSERT_TRUE(image);
  int seen = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const bool hit = std::isfinite(image->depth.at(x, y));
      seen += hit;
      const Vec3<float>& n = image->normal.at(x, y);
      EXPECT_NEAR(norm(Vec3d(n)), hit ? 1.0 : 0.0, 1e-6);
      if (!hit) continue;
      const Ray ray = make_view(stage.scene.camera, stage.compiled.extent, 100, 100)
                          .ray((x + 0.5) / 100, (y + 0.5) / 100);
      const Vec3d point = ray.at(image->depth.at(x, y));
      EXPECT_NEAR(norm(point), 1.0, 1e-6);
      EXPECT_NEAR(norm(point - Vec3d(n)), 0.0, 2e-6);
      EXPECT_GT(image->cost.at(x, y), 0.0F);
    }
  }
  // The silhouette is a disc of tangent 1 / sqrt(24) in a square of half width tan 20.
  const double radius = 50.0 / std::sqrt(24.0) / std::tan(std::numbers::pi / 9.0);
  EXPECT_NEAR(seen, std::numbers::pi * radius * radius, 8.0);
  EXPECT_EQ(image->statistics.hits, static_cast<std::uint64_t>(seen));
  EXPECT_EQ(image->statistics.hits + image->statistics.misses, 10000u);
  EXPECT_EQ(image->statistics.uncertain, 0u);
  // The headlight: brightest in the middle, where the normal faces the eye.
  EXPECT_NEAR(image->color.at(50, 50).x, 1.0, 1e-3);
  EXPECT_LT(image->color.at(50, 82).x, 0.6F);
}

TEST(Render, SameForAnyNumberOfThreads) {
  Stage stage = unit_sphere();
  stage.add(std::make_shared<test::Torus>(1.2, 0.2), {0.9, 0.4, 0.1});
  stage.scene.camera.samples = 3;
  stage.scene.lights.resize(1);
  stage.scene.lights[0].position = {4, 5, 6};
  const auto with_threads = [&](std::size_t count) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, count);
    return *render(stage.compiled, stage.scene);
  };
  const RenderedImage one = with_threads(1);
  const RenderedImage two = with_threads(2);
  EXPECT_EQ(one.color.pixels(), two.color.pixels());
  EXPECT_EQ(one.statistics.hit_cost.jets, two.statistics.hit_cost.jets);
  EXPECT_EQ(one.statistics.shadow_rays, two.statistics.shadow_rays);
}

TEST(Render, SupersamplingMeasuresCoverage) {
  Stage stage = unit_sphere();
  stage.scene.materials[0].diffuse = {0, 0, 0};
  stage.scene.materials[0].ambient = {1, 1, 1};
  const auto covered = [&](int samples) {
    RenderOptions options;
    options.samples = samples;
    options.width = options.height = 25;
    double sum = 0.0;
    const Result<RenderedImage> image = render(stage.compiled, stage.scene, options);
    for (const Vec3<float>& pixel : image->color.pixels()) sum += pixel.x;
    return sum;
  };
  const double radius = 12.5 / std::sqrt(24.0) / std::tan(std::numbers::pi / 9.0);
  const double exact = std::numbers::pi * radius * radius;
  EXPECT_NEAR(covered(8), exact, 0.3);
  EXPECT_NE(covered(1), covered(8));
}

TEST(Render, ThePartInFrontHidesTheOther) {
  Stage stage = unit_sphere();
  stage.add(std::make_shared<test::Sphere>(Vec3d{0, 0, 2}, 0.3), {1, 0, 0});
  stage.add(std::make_shared<test::Sphere>(Vec3d{0, 0, -2}, 0.3), {0, 1, 0});
  const Result<RenderedImage> image = render(stage.compiled, stage.scene);
  const Vec3<float> middle = image->color.at(50, 50);
  EXPECT_GT(middle.x, 0.9F);
  EXPECT_EQ(middle.y, 0.0F);
}

TEST(Render, ShadowsFallWhereTheSceneWantsThem) {
  Stage stage = unit_sphere();
  // A small ball between the light and the middle of the sphere, off the line of sight.
  stage.add(std::make_shared<test::Sphere>(Vec3d{1.5, 0, 2.5}, 0.1), {1, 1, 1});
  stage.scene.lights.resize(1);
  stage.scene.lights[0].position = {3, 0, 4};
  for (const bool shadow : {true, false}) {
    stage.scene.lights[0].shadow = shadow;
    const Result<RenderedImage> image = render(stage.compiled, stage.scene);
    if (shadow) {
      EXPECT_EQ(image->color.at(50, 50).x, 0.0F);
      EXPECT_GT(image->statistics.shadow_rays, 0u);
    } else {
      EXPECT_GT(image->color.at(50, 50).x, 0.3F);
      EXPECT_EQ(image->statistics.shadow_rays, 0u);
    }
    // Beside the shadow there is light in both.
    EXPECT_GT(image->color.at(62, 50).x, 0.3F);
  }
}

TEST(Render, BackgroundAndOverrides) {
  Stage stage = unit_sphere();
  stage.scene.background = {1, 0, 0.5};
  RenderOptions options;
  options.width = 31;
  options.height = 17;
  const Result<RenderedImage> image = render(stage.compiled, stage.scene, options);
  EXPECT_EQ(image->color.width(), 31);
  EXPECT_EQ(image->color.height(), 17);
  EXPECT_FLOAT_EQ(image->color.at(0, 0).x, 1.0F);
  EXPECT_NEAR(image->color.at(0, 0).z, 0.2140, 1e-4);
  EXPECT_TRUE(image->depth.empty());
}

TEST(Render, AnEmptySceneIsAllBackground) {
  const Stage stage;
  const Result<RenderedImage> image = render(stage.compiled, stage.scene);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->statistics.misses, 128u * 128u);
}

TEST(Render, RefusesSizesOutOfRange) {
  const Stage stage = unit_sphere();
  const auto failure = [&](int width, int height, int samples) {
    RenderOptions options;
    options.width = width;
    options.height = height;
    options.samples = samples;
    const Result<RenderedImage> image = render(stage.compiled, stage.scene, options);
    return image ? Failure::none : image.diagnostics()[0].failure;
  };
  EXPECT_EQ(failure(0, 10, 1), Failure::bad_input);
  EXPECT_EQ(failure(10, 1 << 30, 1), Failure::bad_input);
  EXPECT_EQ(failure(10, 10, 17), Failure::bad_input);
  EXPECT_EQ(failure(60000, 60000, 1), Failure::limit);
  EXPECT_EQ(failure(10, 10, 1), Failure::none);
}

TEST(Render, StopsWhenCancelled) {
  class Cancelled : public Progress {
   public:
    bool cancelled() const override { return true; }
  } progress;
  const Stage stage = unit_sphere();
  RenderOptions options;
  options.progress = &progress;
  const Result<RenderedImage> image = render(stage.compiled, stage.scene, options);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.diagnostics()[0].failure, Failure::interrupted);
}

}  // namespace
}  // namespace cs2mesh
