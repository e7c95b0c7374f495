#include "polygonize/error_picture.h"

#include <cmath>
#include <limits>

#include "libfield/base/check.h"
#include "libfield/base/color.h"
#include "tests/unit/polygonize/analytic_surfaces.h"
#include "tests/unit/polygonize/mesh_test_tools.h"

namespace cs2mesh {
namespace {

using namespace test;
using namespace analytic;

constexpr int kSize = 50;

struct Fixture {
  CompiledScene compiled;
  View view;
  Model model;

  Fixture() {
    Part part;
    part.name = "soft";
    part.surface = std::make_shared<Surface<Sphere>>(Sphere{{0, 0, 0}, 1});
    compiled.parts = {part};
    compiled.extent = {{-1, -1, -1}, {1, 1, 1}};
    view = orthographic_view({0, 1, 0}, {0, 0, 1}, compiled.extent, kSize, kSize);
  }
};

TEST(ErrorPicture, ShowsHowFarTheMeshIs) {
  Fixture f;
  f.model.parts = {{"soft", sphere_mesh(5, {}, 1.02)}};
  const ScalarImage errors = error_picture(f.model, f.compiled, f.view, kSize, kSize);
  EXPECT_TRUE(std::isnan(errors.at(0, 0)));
  for (int x = 20; x < 30; ++x) EXPECT_NEAR(errors.at(x, 25), 0.02, 2e-3);
}

TEST(ErrorPicture, MarksSurfaceWithoutMesh) {
  Fixture f;
  f.model.parts = {{"soft", {}}};
  ScalarImage errors = error_picture(f.model, f.compiled, f.view, kSize, kSize);
  ScalarImage depth(kSize, kSize, std::numeric_limits<float>::infinity());
  depth.at(25, 25) = 3;
  mark_missing_mesh(depth, errors);
  EXPECT_TRUE(std::isinf(errors.at(25, 25)));
  EXPECT_TRUE(std::isnan(errors.at(24, 25)));
  EXPECT_THROW(mark_missing_mesh(ScalarImage(1, 1), errors), ContractViolation);
}

TEST(ErrorPicture, AMeshForEachPart) {
  const Fixture f;
  EXPECT_THROW((void)error_picture(f.model, f.compiled, f.view, kSize, kSize), ContractViolation);
}

double lightness(const Vec3<float>& c) {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

TEST(FalseColors, AreThoseOfTheScaleByTheLogarithm) {
  ScalarImage errors(5, 1);
  errors.pixels() = {0.0F, 0.5e-3F, 1e-2F, 2e-1F, 7.0F};
  const ColorImage colors = false_colors(errors, 1e-3, 1e-1);
  EXPECT_EQ(colors.at(0, 0), colors.at(1, 0));
  EXPECT_EQ(colors.at(3, 0), colors.at(4, 0));
  const ColorImage scale = false_color_scale(1001);
  EXPECT_NEAR(lightness(scale.at(500, 0)), lightness(colors.at(2, 0)), 1e-3);
  for (int x = 1; x < scale.width(); ++x) {
    EXPECT_GT(lightness(scale.at(x, 0)), lightness(scale.at(x - 1, 0))) << x;
  }
  EXPECT_THROW((void)false_colors(errors, 1, 1), ContractViolation);
}

TEST(FalseColors, TellNothingAndMissingApart) {
  ScalarImage errors(2, 1);
  errors.pixels() = {std::numeric_limits<float>::quiet_NaN(),
                     std::numeric_limits<float>::infinity()};
  const ColorImage colors = false_colors(errors, 1e-3, 1e-1);
  EXPECT_EQ(colors.at(0, 0).x, colors.at(0, 0).y);
  EXPECT_EQ(colors.at(1, 0).y, 0.0F);
  EXPECT_EQ(colors.at(1, 0).x, 1.0F);
}

}  // namespace
}  // namespace cs2mesh
