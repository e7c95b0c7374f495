// Second derivatives of terms, fields and solids against differences of their gradients.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/field/field.h"
#include "libfield/solid/make_solid.h"
#include "tests/unit/field/random_scene.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

using testing::plain_term;
using testing::random_point;
using testing::random_scene;
using testing::SceneKind;

Symmetric3 symmetric_part(const std::array<Vec3d, 3>& row) {
  return {row[0].x,
          row[1].y,
          row[2].z,
          0.5 * (row[0].y + row[1].x),
          0.5 * (row[0].z + row[2].x),
          0.5 * (row[1].z + row[2].y)};
}

/// Central differences of the gradient over +- step.
template <class Gradient>
Symmetric3 differences(const Gradient& gradient, const Vec3d& p, double step) {
  std::array<Vec3d, 3> row;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3d before = p, after = p;
    before[axis] -= step, after[axis] += step;
    row[axis] = (gradient(after) - gradient(before)) / (after[axis] - before[axis]);
  }
  return symmetric_part(row);
}

/// How often second derivatives were compared, and how often a corner was too close to.
struct Compared {
  int smooth = 0, cornered = 0;

  template <class Gradient>
  void expect(const Symmetric3& hessian, const Gradient& gradient, const Vec3d& p, double step) {
    const Symmetric3 fine = differences(gradient, p, 0.5 * step);
    const Symmetric3 coarse = differences(gradient, p, step);
    const Symmetric3 best = fine + (1.0 / 3.0) * (fine - coarse);
    const double size = norm(best) + norm(gradient(p));
    const double doubt = norm(fine - coarse);
    if (doubt > 1e-3 * size) {
      ++cornered;
      return;
    }
    ++smooth;
    EXPECT_LE(norm(hessian - best), 1e-2 * doubt + 1e-8 * size)
        << "at " << p.x << ", " << p.y << ", " << p.z << ", norm " << norm(hessian);
  }
};

TEST(SecondJet, OfTermsWithProfilesAndTransformationsAreTheirGradientsSlopes) {
  const Arc arc = make_arc({0.1, 0, 0}, 0.8, {0, 0.6, 0.8}, 20, 250);
  const Primitive primitives[] = {Point{{0.1, 0.2, 0.3}}, Segment{{-1, 0, 0.2}, {0.8, 0.3, 0}}, arc,
                                  Triangle{{Vec3d{-1, 0, 0}, {0.9, 0.2, 0.1}, {0, 1, 0.3}}},
                                  Plane{{0, 0, 0.1}, {0, 0.6, 0.8}}};
  const Affine shear{{{Vec3d{1, 0.3, 0}, {0, 0.7, -0.4}, {0.2, 0, -1.3}}}, {0.1, -0.2, 0.05}};
  StrengthProfile wave{ProfileFunction::sin_squared, ProfileFunction::sin};
  wave.scale_v = 2.0, wave.translate_v = 0.2;
  StrengthProfile slope{ProfileFunction::cos, ProfileFunction::cos_squared};
  slope.scale_u = 0.7, slope.times = 1.5, slope.lower = -0.8, slope.upper = 1.1;
  Compared compared;
  for (const Primitive& primitive : primitives) {
    for (const bool transformed : {false, true}) {
      for (const KernelKind kind : {KernelKind::cauchy, KernelKind::gaussian}) {
        Term term = plain_term(make_kernel(kind, 1.3, 0.7, -0.3, 0.0), primitive);
        term.sign = -1.0;
        term.profiles = {wave, slope};
        if (transformed) term.to_local = std::make_shared<Affine>(shear);
        Random random(5, primitive.index());
        const auto gradient = [&](const Vec3d& at) {
          Jet jet;
          accumulate(term, {&at, 1}, {&jet, 1});
          return jet.gradient;
        };
        for (int i = 0; i < 40; ++i) {
          const Vec3d p = random_point(random, 1.5);
          Symmetric3 hessian;
          accumulate(term, {&p, 1}, {&hessian, 1});
          compared.expect(hessian, gradient, p, 2e-4);
        }
      }
    }
  }
  EXPECT_GT(compared.smooth, 10 * compared.cornered);
}

TEST(SecondJet, OfFieldsAreTheirGradientsSlopes) {
  const SceneKind kinds[] = {{false, false, false}, {true, false, false}, {true, true, true}};
  Compared compared;
  for (std::uint64_t seed = 0; seed < 9; ++seed) {
    const auto compiled = compile(random_scene(seed, 9, kinds[seed % 3]), {1e-9});
    ASSERT_TRUE(compiled);
    const auto& field = *compiled->parts.at(0).surface;
    Random random(seed, 1);
    for (int i = 0; i < 30; ++i) {
      const Vec3d p = random_point(random, 1.2);
      const Jet2 jet = field.second_jet(p);
      EXPECT_EQ((Jet{jet.value, jet.gradient}), field.jet(p));
      compared.expect(
          jet.hessian, [&](const Vec3d& at) { return field.jet(at).gradient; }, p, 1e-4);
    }
  }
  EXPECT_GT(compared.smooth, 10 * compared.cornered);
}

TEST(SecondJet, OfRestrictionsAreTheSameBits) {
  const auto compiled = compile(random_scene(3, 9), {1e-9});
  ASSERT_TRUE(compiled);
  const auto& field = *compiled->parts.at(0).surface;
  const Aabb box{{-0.3, -0.3, -0.3}, {0.4, 0.4, 0.4}};
  const auto part = field.restrict_to(box);
  Random random(8);
  for (int i = 0; i < 50; ++i) {
    const Vec3d p = box.clamp(random_point(random, 0.4));
    EXPECT_EQ(part->second_jet(p), field.second_jet(p));
  }
}

TEST(SecondJet, OfSolidsAreTheirGradientsSlopes) {
  const Primitive skeletons[] = {Point{{0.1, 0, 0}},
                                 Segment{{0, 0, 0}, {0.5, 0.2, 2}},
                                 make_arc({0, 0, 0}, 1.1, {0.6, 0, 0.8}, 0, 200),
                                 Triangle{{Vec3d{-1, 0, 0}, {1, 0.2, 0.1}, {0, 1, 0.3}}},
                                 Plane{{0, 0, 0.1}, {0, 0.6, 0.8}},
                                 Segment{{0, 0, -1}, {0.2, 0, 1}},
                                 Segment{{-1, -0.5, -0.7}, {1, 1, 0.5}},
                                 Point{},
                                 Point{}};
  const ElementKind kinds[] = {ElementKind::sphere,   ElementKind::cylinder, ElementKind::arc,
                               ElementKind::triangle, ElementKind::plane,    ElementKind::cone,
                               ElementKind::box,      ElementKind::polygon,  ElementKind::quadric};
  Compared compared;
  for (std::size_t k = 0; k < std::size(kinds); ++k) {
    for (const bool offset : {false, true}) {
      const bool flat = kinds[k] == ElementKind::triangle || kinds[k] == ElementKind::polygon;
      if (flat && !offset) continue;
      Scene scene;
      scene.polygons.push_back(std::get<Polygon>(
          make_polygon({{-1, 0, 0}, {1, 0, 0}, {1, 1.2, 0}, {0, 0.3, 0}, {-1, 1.2, 0}})));
      scene.quadrics.push_back({{1, 3, -0.5, 0.2, 0, 0.1}, {0.1, 0, 0.3}, -0.5, std::nullopt});
      scene.materials.push_back({});
      scene.materials[0].radius = 0.3;
      Element element;
      element.kind = kinds[k];
      element.skeleton = skeletons[k];
      element.shape = 0;
      if (kinds[k] == ElementKind::cone) element.own_radius = 0.9, element.apex_radius = 0.3;
      element.transform = Affine::rotate({1, 2, 3}, 40) * Affine::scale({1, 0.6, 1.5});
      scene.elements.push_back(element);
      const auto made = make_solid(scene, scene.elements[0], offset);
      ASSERT_TRUE(made);
      const ImplicitSurface& solid = *made->surface;
      Random random(k);
      for (int i = 0; i < 60; ++i) {
        const Vec3d p = random_point(random, 1.5);
        const Jet2 jet = solid.second_jet(p);
        EXPECT_EQ((Jet{jet.value, jet.gradient}), solid.jet(p));
        compared.expect(
            jet.hessian, [&](const Vec3d& at) { return solid.jet(at).gradient; }, p, 1e-4);
      }
    }
  }
  EXPECT_GT(compared.smooth, 10 * compared.cornered);
}

/// F = sin(x) cos(2y) exp(z / 3), which says nothing of its second derivative.
class Waves final : public ImplicitSurface {
 public:
  void values(std::span<const Vec3d> points, std::span<double> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = at(points[i]).value;
  }
  void jets(std::span<const Vec3d> points, std::span<Jet> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = at(points[i]);
  }
  Interval enclose(const Aabb&) const override { return Interval::everything(); }
  std::array<Interval, 3> enclose_gradient(const Aabb&) const override { return {}; }
  double derivative_bound(int, const Aabb&) const override { return HUGE_VAL; }
  Aabb bounds() const override { return {}; }
  std::unique_ptr<ImplicitSurface> restrict_to(const Aabb&) const override {
    return std::make_unique<Waves>();
  }

 private:
  static Jet at(const Vec3d& p) {
    const double s = std::sin(p.x), c = std::cos(2 * p.y), e = std::exp(p.z / 3);
    return {s * c * e, {std::cos(p.x) * c * e, -2 * s * std::sin(2 * p.y) * e, s * c * e / 3}};
  }
};

TEST(SecondJet, OfShapesThatDoNotSayComeFromDifferences) {
  const Vec3d p{0.4, -0.3, 0.8};
  const double s = std::sin(p.x), c = std::cos(2 * p.y), e = std::exp(p.z / 3);
  const double sy = -2 * std::sin(2 * p.y), cx = std::cos(p.x);
  const Symmetric3 exact{-s * c * e,  -4 * s * c * e, s * c * e / 9,
                         cx * sy * e, cx * c * e / 3, s * sy * e / 3};
  EXPECT_LE(norm(Waves().second_jet(p).hessian - exact), 1e-9);
}

}  // namespace
}  // namespace cs2mesh
