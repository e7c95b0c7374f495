// Radius in isolation and blobbiness against references of 25 digits, and at extremes.
#include "libfield/integral/isolation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "libfield/integral/integral.h"
#include "tests/oracle/reference.h"

namespace cs2mesh {
namespace {

double number(const std::string& text) {
  return std::strtod(text.c_str(), nullptr);
}

Primitive parse_primitive(const std::vector<std::string>& cell) {
  const auto g = [&](std::size_t i) { return number(cell[5 + i]); };
  const auto v = [&](std::size_t i) { return Vec3d{g(i), g(i + 1), g(i + 2)}; };
  const std::string& name = cell[2];
  if (name == "point") return Point{v(0)};
  if (name == "line") return Segment{v(0), v(3)};
  if (name == "triangle") return Triangle{{v(0), v(3), v(6)}};
  if (name == "plane") return Plane{v(0), normalized(v(3))};
  return make_arc(v(0), g(3), v(4), v(7), g(10), g(11));
}

TEST(Isolation, MatchesTheReferences) {
  const auto rows =
      reference::read_csv(reference::shared_folder() + "/reference/isolation_public.csv");
  ASSERT_EQ(rows.size(), 40U) << "in " << reference::shared_folder();
  for (const auto& cell : rows) {
    const KernelKind kind = *kernel_of(cell[1]);
    const Isolation found = isolate(kind, parse_primitive(cell), number(cell[3]), number(cell[4]));
    const std::string row = "row " + cell[0] + ": " + cell[1] + " " + cell[2];
    const double log_strength = number(cell[19]);
    EXPECT_NEAR(found.log_strength, log_strength, 1e-12 * (1.0 + std::abs(log_strength))) << row;
    const double strength = number(cell[18]);
    EXPECT_NEAR(found.strength, strength, 1e-10 * strength) << row;
    if (cell[17].empty()) {
      EXPECT_EQ(found.width, 0.0) << row;
    } else {
      EXPECT_NEAR(found.width, number(cell[17]), 4e-15 * found.width) << row;
    }
  }
}

TEST(Isolation, SurfaceOfAPointPassesAtItsRadiusWithBlinnsSlope) {
  for (const KernelKind kind : kAllKernels) {
    for (const double blobbiness : {-0.3, -0.5, -2.0, -8.0, -256.0}) {
      const double radius = 0.3;
      const Isolation alone = isolate(kind, Point{}, radius, blobbiness);
      const Kernel kernel = make_kernel(kind, alone.width, alone.strength, alone.log_strength, 0.0);
      const Jet jet = std::visit(
          [&](const auto& k) {
            return integral(k, Point{}, Vec3d{radius, 0.0, 0.0});
          },
          kernel);
      EXPECT_NEAR(jet.value, 1.0, 1e-11) << name_of(kind) << " " << blobbiness;
      const bool has_slope =
          kind != KernelKind::cauchy && kind != KernelKind::inverse && kind != KernelKind::squared;
      if (has_slope) {
        EXPECT_NEAR(radius * jet.gradient.x / (2.0 * blobbiness), 1.0, 1e-10)
            << name_of(kind) << " " << blobbiness;
      }
    }
  }
}

TEST(Isolation, StiffGaussiansKeepTheirLogarithm) {
  const Segment segment{{-0.5, 0.0, 0.0}, {0.5, 0.0, 0.0}};
  // S = 1 / (e^-b (sqrt(pi) / a) erf(a L / 2)).
  for (const double b : {256.0, 1000.0, 5000.0}) {
    const double radius = 0.025;
    const double a = std::sqrt(b) / radius;
    const double expected = b - std::log(std::sqrt(M_PI) / a * std::erf(0.5 * a));
    const Isolation alone = isolate(KernelKind::gaussian, segment, radius, -b);
    EXPECT_NEAR(alone.log_strength, expected, 1e-12 * expected);
    const Gaussian kernel{alone.width, alone.log_strength};
    const double at_surface = integral(kernel, segment, Vec3d{0.0, radius, 0.0}).value;
    EXPECT_NEAR(at_surface, 1.0, 1e-11);
  }
}

TEST(Isolation, FarFromTheOriginNothingIsLost) {
  const Vec3d offset{1 << 20, -(1 << 19), 1 << 21};
  const Triangle here{{Vec3d{0, 0, 0}, Vec3d{0.5, 0, 0.25}, Vec3d{0.125, 0.75, 0}}};
  Triangle there = here;
  for (Vec3d& vertex : there.vertex) vertex += offset;
  for (const KernelKind kind : kAllKernels) {
    const double near_by = isolate(kind, here, 0.25, -4.0).log_strength;
    EXPECT_NEAR(isolate(kind, there, 0.25, -4.0).log_strength, near_by, 1e-14) << name_of(kind);
  }
}

TEST(Isolation, PlanesOfInverseKernelsHaveNone) {
  EXPECT_EQ(isolate(KernelKind::inverse, Plane{}, 1.0, -1.0).strength, 0.0);
}

TEST(Isolation, WidthTooSmallForTheRadiusGivesNoStrength) {
  EXPECT_TRUE(std::isinf(isolate_at_width(KernelKind::soft, Point{}, 1.0, 0.5).strength));
}

}  // namespace
}  // namespace cs2mesh
