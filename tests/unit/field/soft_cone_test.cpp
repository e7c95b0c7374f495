// Soft cones: f = S I / I_line(r(u)), the laws that follow, and bounds that contain.
#include <gtest/gtest.h>

#include <cmath>

#include "../art/art_testing.h"
#include "libfield/base/random.h"
#include "libfield/field/compile.h"
#include "libfield/integral/integral.h"
#include "libfield/integral/isolation.h"
#include "libfield/integral/line_field.h"

namespace cs2mesh {
namespace {

constexpr std::string_view kKernels[] = {"cauchy",   "gaussian", "squared",
                                         "metaball", "soft",     "quartic"};

std::shared_ptr<const ImplicitSurface> field_of(const std::string& text) {
  const Result<CompiledScene> compiled = compile(scene_of(text));
  EXPECT_TRUE(compiled);
  EXPECT_EQ(compiled->parts.size(), 1u);
  return compiled->parts.at(0).surface;
}

std::string surface(std::string_view kernel, const std::string& more = "") {
  return "surface S { blobbiness -3 kernel " + std::string(kernel) + " " + more + " }\n";
}

/// F + T, which is what the language calls f.
double sum_at(const ImplicitSurface& field, const Vec3d& p) {
  return field.value(p) + 1;
}

Vec3d random_point(Random& random) {
  return {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-1, 5)};
}

TEST(SoftCone, HasItsRadiusAlongALongAxis) {
  for (const std::string_view kernel : kKernels) {
    if (kernel == "squared") continue;  // it reaches too far for an axis to be long
    const auto cone = field_of(surface(kernel) + "cone S 0.02 0 0 0 0.01 0 0 40\n");
    for (const double z : {10.0, 20.0, 30.0}) {
      const double radius = 0.02 - 0.01 * z / 40;
      EXPECT_NEAR(cone->value({0, radius, z}), 0, 1e-5) << kernel << " " << z;
    }
  }
}

TEST(SoftCone, IsTheAxisOverTheFieldOfItsLine) {
  Random random(4);
  const Segment axis{{0, 0, 0}, {0, 0, 4}};
  for (const KernelKind kind : {KernelKind::cauchy, KernelKind::gaussian, KernelKind::squared,
                                KernelKind::metaball, KernelKind::soft, KernelKind::quartic}) {
    const auto cone =
        field_of(surface(name_of(kind), "strength 1.5") + "cone S 0.25 0 0 0 0.75 0 0 4\n");
    const double width = kernel_width(kind, 0.75, -3);
    const bool inverse_length = kind == KernelKind::cauchy || kind == KernelKind::gaussian;
    const double unit = kind == KernelKind::squared ? 1 : inverse_length ? 1 / width : width;
    const Kernel kernel = make_kernel(kind, width, 1.0, 0.0, 1e-9);
    for (int i = 0; i < 50; ++i) {
      const Vec3d p = random_point(random);
      const double u = std::clamp(p.z / 4, 0.0, 1.0);
      const double line = unit * line_field(kind, (0.25 + 0.5 * u) / unit).value;
      const double alone =
          std::visit([&](const auto& k) { return integral(k, axis, p).value; }, kernel);
      EXPECT_NEAR(sum_at(*cone, p), 1.5 * alone / line, 1e-11 * (1 + alone / line))
          << name_of(kind);
    }
  }
}

TEST(SoftCone, TransformsWithItsPlacement) {
  Random random(5);
  const std::string place = "rotate 1 2 3 50\nscale 2 2 2\ntranslate 1 0 -1\n";
  const Affine map =
      Affine::translate({1, 0, -1}) * Affine::scale({2, 2, 2}) * Affine::rotate({1, 2, 3}, 50);
  const std::string skewed = "scale 1 0.5 2\n";
  for (const std::string_view kernel : kKernels) {
    const std::string text = surface(kernel) + "cone S 0.7 0 0 0 0.2 0 0 3\n";
    const auto plain = field_of(text), moved = field_of(text + place);
    const auto stretched = field_of(text + skewed);
    for (int i = 0; i < 30; ++i) {
      const Vec3d p = random_point(random);
      const double scale = 1 + std::abs(plain->value(p));
      EXPECT_NEAR(moved->value(map(p)), plain->value(p), 1e-11 * scale) << kernel;
      EXPECT_NEAR(stretched->value({p.x, 0.5 * p.y, 2 * p.z}), plain->value(p), 1e-11 * scale);
    }
  }
}

TEST(SoftCone, OfEqualRadiiIsTheLongSegmentsField) {
  // The same kernel, with the strength of the infinite line in place of that of the segment.
  const auto cone = field_of(surface("cauchy") + "cone S 0.5 0 0 0 0.5 0 0 4\n");
  const auto rod = field_of(surface("cauchy") + "cylinder S 0.5 0 0 0 0 0 4\n");
  Random random(6);
  const double ratio = sum_at(*cone, {0.5, 0, 2}) / sum_at(*rod, {0.5, 0, 2});
  EXPECT_NEAR(ratio, 1, 0.05);
  for (int i = 0; i < 50; ++i) {
    const Vec3d p = random_point(random);
    EXPECT_NEAR(sum_at(*cone, p), ratio * sum_at(*rod, p), 1e-13 * (1 + sum_at(*rod, p)));
  }
}

TEST(SoftCone, PlainIntegralsKnowNoRadii) {
  const std::string plain = "surface S { kernel gaussian width 2 }\n";
  const auto cone = field_of(plain + "cone S 0.5 0 0 0 0.1 0 0 4\n");
  const auto rod = field_of(plain + "cylinder S 0.5 0 0 0 0 0 4\n");
  for (const double z : {-0.5, 1.0, 3.9}) {
    EXPECT_EQ(cone->value({0.3, 0.2, z}), rod->value({0.3, 0.2, z}));
  }
}

TEST(SoftCone, FragileOnesTakeTheRadiusOfTheirSurface) {
  const std::string wide = "surface S { blobbiness -3 radius 0.6 }\n";
  const auto fragile = field_of(wide + "fragile cone\ncone S 0.3 0 0 0 0.1 0 0 4\n");
  const auto meant = field_of(wide + "cone S 0.6 0 0 0 0.2 0 0 4\n");
  for (const double z : {-0.5, 1.0, 3.9}) {
    EXPECT_NEAR(fragile->value({0.3, 0.2, z}), meant->value({0.3, 0.2, z}), 1e-14);
  }
}

TEST(SoftCone, WhatCannotBeIsAnError) {
  const auto failure = [](const std::string& text) {
    const Result<CompiledScene> compiled = compile(scene_of(text));
    return compiled ? std::optional<Failure>() : compiled.diagnostics().front().failure;
  };
  const std::string cone = "cone S 0.5 0 0 0 0.1 0 0 4\n";
  EXPECT_EQ(failure(surface("inverse") + cone), Failure::unmeshable);
  EXPECT_EQ(failure("surface S { blobbiness -1000 kernel gaussian }\n" + cone), Failure::bad_input);
  EXPECT_EQ(failure("surface S { radius 1 width 0.4 kernel soft }\n" + cone), Failure::bad_input);
  EXPECT_EQ(failure("surface S { blobbiness -500 kernel gaussian }\n" + cone), std::nullopt);
}

TEST(SoftCone, StiffOnesStayFinite) {
  const auto cone = field_of(
      "surface S { blobbiness -590 kernel gaussian }\n"
      "cone S 0.5 0 0 0 0 0 0 4\n");
  for (const double z : {-1.0, 0.0, 0.01, 2.0, 3.99, 4.0, 5.0}) {
    for (const double x : {0.0, 0.01, 0.1, 0.3, 0.6, 3.0}) {
      const Jet2 jet = cone->second_jet({x, 0, z});
      EXPECT_TRUE(std::isfinite(jet.value)) << x << " " << z;
      EXPECT_TRUE(is_finite(jet.gradient)) << x << " " << z;
      EXPECT_TRUE(std::isfinite(jet.hessian.xx + jet.hessian.zz + jet.hessian.xz)) << x << " " << z;
    }
    EXPECT_LT(cone->value({0.7, 0, z}), 0);
  }
  EXPECT_GT(cone->value({0.1, 0, 2.0}), 0);
  EXPECT_NEAR(cone->value({0.25, 0, 2.0}), 0, 1e-6);
}

TEST(SoftCone, JetsAndBoundsHold) {
  Random random(8);
  for (const std::string_view kernel : kKernels) {
    for (const std::string& place :
         {std::string(), std::string("rotate 1 1 0 70\nscale 1 2 1\n")}) {
      const auto cone = field_of(surface(kernel) + "cone S 0.7 0 0 0 0.1 0 0 3\n" + place);
      for (int trial = 0; trial < 60; ++trial) {
        const double size = std::pow(10.0, random.uniform(-2, 0));
        const Vec3d corner = random_point(random);
        const Aabb box{corner, corner + Vec3d{size, size, size}};
        const Interval range = cone->enclose(box);
        const auto gradient = cone->enclose_gradient(box);
        const double slope = cone->derivative_bound(1, box);
        const auto part = cone->restrict_to(box);
        for (int sample = 0; sample < 8; ++sample) {
          const Vec3d p =
              corner + size * Vec3d{random.uniform(), random.uniform(), random.uniform()};
          const Jet jet = cone->jet(p);
          EXPECT_EQ(part->value(p), cone->value(p));
          ASSERT_TRUE(range.contains(jet.value)) << kernel << place;
          EXPECT_LE(norm(jet.gradient), slope * (1 + 1e-12)) << kernel;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            EXPECT_TRUE(gradient[axis].contains(jet.gradient[axis])) << kernel << place;
          }
          if (jet.value >= 0) {
            EXPECT_TRUE(cone->bounds().contains(p)) << kernel;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace cs2mesh
