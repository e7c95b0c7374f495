// Soft polygons: one strength for the whole, the sum of the fields of its triangles.
#include <gtest/gtest.h>

#include <cmath>

#include "../art/art_testing.h"
#include "libfield/base/random.h"
#include "libfield/field/compile.h"

namespace cs2mesh {
namespace {

constexpr std::string_view kKernels[] = {"cauchy",   "gaussian", "inverse", "squared",
                                         "metaball", "soft",     "quartic"};

Part part_of(const std::string& text) {
  const Result<CompiledScene> compiled = compile(scene_of(text));
  EXPECT_TRUE(compiled);
  EXPECT_EQ(compiled->parts.size(), 1u);
  return compiled->parts.at(0);
}

std::string surface(std::string_view kernel, const std::string& more = "") {
  return "surface S { radius 0.4 blobbiness -3 kernel " + std::string(kernel) + " " + more + " }\n";
}

Vec3d random_point(Random& random) {
  return {random.uniform(-1, 3), random.uniform(-1, 3), random.uniform(-1, 1)};
}

const std::string kTriangle = "triangle S 0 0 0  2 0 0  0 1 0.5\n";
const std::string kSameAsPolygon = "polygon S 0 0 0  1 0 0  2 0 0  0 1 0.5\n";
const std::string kNotch = "polygon S 0 0 0  2 0 0  2 2 0  1 0.5 0  0 2 0\n";

TEST(SoftPolygon, OfThreeCornersIsTheTriangle) {
  Random random(1);
  for (const std::string_view kernel : kKernels) {
    const Part triangle = part_of(surface(kernel) + kTriangle);
    const Part polygon = part_of(surface(kernel) + kSameAsPolygon);
    EXPECT_EQ(polygon.primitive_count, 1u);
    for (int i = 0; i < 40; ++i) {
      const Vec3d p = random_point(random);
      const Jet a = triangle.surface->jet(p), b = polygon.surface->jet(p);
      EXPECT_NEAR(a.value, b.value, 1e-10 * (1 + std::abs(a.value))) << kernel;
      EXPECT_LT(norm(a.gradient - b.gradient), 1e-9 * (1 + norm(a.gradient))) << kernel;
    }
  }
}

TEST(SoftPolygon, HasItsRadiusAboveItsCentroid) {
  for (const std::string_view kernel : kKernels) {
    const Part notch = part_of(surface(kernel) + kNotch);
    // Of the square less the triangle 0 2, 1 0.5, 2 2: areas 4 and 1.5, centroids 1 and 1.5.
    const Vec3d centroid{1, (4 * 1 - 1.5 * 1.5) / 2.5, 0};
    for (const double side : {-0.4, 0.4}) {
      EXPECT_NEAR(notch.surface->value(centroid + Vec3d{0, 0, side}), 0, 1e-10) << kernel;
    }
  }
}

TEST(SoftPolygon, DoesNotDependOnWhereItBeginsNorOnItsPlace) {
  Random random(2);
  const std::string other = "polygon S 2 2 0  1 0.5 0  0 2 0  0 0 0  2 0 0\n";
  const std::string turned = "polygon S 0 2 0  1 0.5 0  2 2 0  2 0 0  0 0 0\n";
  const std::string place = "rotate 1 2 3 50\nscale 2 2 2\ntranslate 1 0 -1\n";
  const Affine map =
      Affine::translate({1, 0, -1}) * Affine::scale({2, 2, 2}) * Affine::rotate({1, 2, 3}, 50);
  for (const std::string_view kernel : kKernels) {
    const Part first = part_of(surface(kernel) + kNotch);
    const Part second = part_of(surface(kernel) + other);
    const Part third = part_of(surface(kernel) + turned);
    const Part moved = part_of(surface(kernel) + kNotch + place);
    const Part skewed = part_of(surface(kernel) + kNotch + "scale 1 2 0.5\n");
    for (int i = 0; i < 30; ++i) {
      const Vec3d p = random_point(random);
      const double f = first.surface->value(p), limit = 1e-9 * (1 + std::abs(f));
      EXPECT_NEAR(second.surface->value(p), f, limit) << kernel;
      EXPECT_NEAR(third.surface->value(p), f, limit) << kernel;
      EXPECT_NEAR(moved.surface->value(map(p)), f, limit) << kernel;
      EXPECT_NEAR(skewed.surface->value({p.x, 2 * p.y, 0.5 * p.z}), f, limit) << kernel;
    }
  }
}

TEST(SoftPolygon, ProfilesTakeTheCoordinatesOfItsFirstCorner) {
  // P = V1 + u (V2 - V1) + v (Vn - V1), whichever triangle is asked.
  const std::string textures = "texture T strength x one\n";
  const std::string wide = surface("cauchy", "texture T");
  const Part whole = part_of(textures + wide + "polygon S 0 0 0  2 0 0  2 2 0  0 2 0\n");
  const Part plain = part_of(surface("cauchy") + "polygon S 0 0 0  2 0 0  2 2 0  0 2 0\n");
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Vec3d p = random_point(random);
    const double u = std::clamp(p.x / 2, 0.0, 1.0);
    EXPECT_NEAR(whole.surface->value(p) + 1, u * (plain.surface->value(p) + 1), 1e-12);
  }
}

TEST(SoftPolygon, BoundsHold) {
  Random random(4);
  const std::string textures = "texture T strength sin x scale 2 1 1\n";
  for (const std::string_view kernel : kKernels) {
    for (const bool profile : {false, true}) {
      const Part notch = part_of(textures + surface(kernel, profile ? "texture T" : "") + kNotch);
      for (int trial = 0; trial < 40; ++trial) {
        const double size = std::pow(10.0, random.uniform(-2, 0));
        const Vec3d corner = random_point(random);
        const Aabb box{corner, corner + Vec3d{size, size, size}};
        const Interval range = notch.surface->enclose(box);
        const auto gradient = notch.surface->enclose_gradient(box);
        for (int sample = 0; sample < 8; ++sample) {
          const Vec3d p =
              corner + size * Vec3d{random.uniform(), random.uniform(), random.uniform()};
          const Jet jet = notch.surface->jet(p);
          ASSERT_TRUE(range.contains(jet.value)) << kernel << profile;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_TRUE(gradient[axis].contains(jet.gradient[axis])) << kernel << profile;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace cs2mesh
