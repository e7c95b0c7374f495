// Laws of the compiled field: bounds contain, restrictions agree to the bit, the budget is kept.
#include "libfield/field/field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libfield/field/make_term.h"
#include "tests/unit/field/random_scene.h"

namespace cs2mesh {
namespace {

using testing::random_point;
using testing::random_scene;
using testing::SceneKind;

std::shared_ptr<const Field> field_of(const Scene& scene, double budget = 1e-9) {
  const Result<CompiledScene> compiled = compile(scene, {budget});
  EXPECT_TRUE(compiled) << (compiled ? "" : to_string(compiled.diagnostics()[0]));
  return std::dynamic_pointer_cast<const Field>(compiled->parts.at(0).surface);
}

Aabb random_box(Random& random, double reach) {
  const Vec3d center = random_point(random, reach);
  const double size = std::pow(10.0, random.uniform(-3, 0));
  Aabb box{center, center};
  box.include(center +
              Vec3d{size * random.uniform(), size * random.uniform(), size * random.uniform()});
  return box;
}

Vec3d point_in(Random& random, const Aabb& box) {
  return {random.uniform(box.min.x, box.max.x), random.uniform(box.min.y, box.max.y),
          random.uniform(box.min.z, box.max.z)};
}

const SceneKind kKinds[] = {{false, false, false, true},
                            {true, false, false},
                            {false, true, false},
                            {true, true, true, true}};

TEST(Field, EnclosuresContainWhatIsSampled) {
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    const auto field = field_of(random_scene(seed, 9, kKinds[seed % 4]));
    Random random(seed, 1);
    for (int trial = 0; trial < 60; ++trial) {
      const Aabb box = random_box(random, 1.5);
      const Interval range = field->enclose(box);
      const auto gradient = field->enclose_gradient(box);
      const double lipschitz = field->derivative_bound(1, box);
      for (int sample = 0; sample < 20; ++sample) {
        const Vec3d p = sample < 8 ? box.corner(sample) : point_in(random, box);
        const Jet jet = field->jet(p);
        ASSERT_TRUE(range.contains(jet.value))
            << "seed " << seed << ": " << jet.value << " not in " << range.lo << ", " << range.hi;
        EXPECT_LE(norm(jet.gradient), lipschitz * (1 + 1e-9));
        for (std::size_t axis = 0; axis < 3; ++axis) {
          ASSERT_TRUE(widened(gradient[axis], 1e-9 * (1 + lipschitz)).contains(jet.gradient[axis]))
              << "seed " << seed << " axis " << axis;
        }
      }
    }
  }
}

TEST(Field, EnclosuresOfSmallBoxesAreHardlyWiderThanTheLinearRange) {
  const auto field = field_of(random_scene(3, 9));
  const Vec3d p{0.3, 0.2, 0.1};
  const Jet jet = field->jet(p);
  for (const double half : {1e-2, 1e-3, 1e-4}) {
    const Aabb box{p - Vec3d{half, half, half}, p + Vec3d{half, half, half}};
    const double linear =
        2 * half * (std::abs(jet.gradient.x) + std::abs(jet.gradient.y) + std::abs(jet.gradient.z));
    EXPECT_LT(field->enclose(box).width(), 1.5 * linear) << half;
  }
}

TEST(Field, SecondDerivativeBoundHoldsForDifferencesOfGradients) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto field = field_of(random_scene(seed, 9, kKinds[2 * (seed % 2)]));
    Random random(seed, 2);
    for (int trial = 0; trial < 50; ++trial) {
      const Aabb box = random_box(random, 1.5);
      const double bound = field->derivative_bound(2, box);
      const Vec3d p = point_in(random, box);
      const Vec3d q = point_in(random, box);
      EXPECT_LE(norm(field->jet(p).gradient - field->jet(q).gradient),
                bound * norm(p - q) * (1 + 1e-9) + 1e-9);
    }
  }
}

TEST(Field, GradientMatchesDifferences) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto field = field_of(random_scene(seed, 9, kKinds[2 * (seed % 2)]));
    Random random(seed, 3);
    for (int trial = 0; trial < 50; ++trial) {
      const Vec3d p = random_point(random, 1.5);
      const Jet jet = field->jet(p);
      const double h = 1e-5;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Vec3d step{};
        step[axis] = h;
        const double difference = (field->value(p + step) - field->value(p - step)) / (2 * h);
        EXPECT_NEAR(difference, jet.gradient[axis], 1e-4 * (1 + norm(jet.gradient)));
      }
    }
  }
}

TEST(Field, RestrictionsReturnTheSameBits) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const auto field = field_of(random_scene(seed, 40, kKinds[seed % 4]), 1e-6);
    Random random(seed, 4);
    for (int trial = 0; trial < 30; ++trial) {
      const Aabb box = random_box(random, 1.2);
      const auto part = field->restrict_to(box);
      const auto nested = part->restrict_to({box.center(), box.max});
      for (int sample = 0; sample < 20; ++sample) {
        const Vec3d p = sample < 8 ? box.corner(sample) : point_in(random, box);
        EXPECT_EQ(field->jet(p), part->jet(p));
        if (Aabb{box.center(), box.max}.contains(p)) {
          EXPECT_EQ(field->jet(p), nested->jet(p));
        }
      }
    }
  }
}

/// Of thousands of terms those that reach a point count, also in the air around.
TEST(Field, OfManyTermsRestrictionsReturnTheSameBitsBeyondTheBounds) {
  constexpr double kBudget = 1e-6;
  const auto field = field_of(random_scene(3, 8000, kKinds[0]), kBudget);
  const Aabb bounds = field->bounds();
  Random random(3, 4);
  for (int trial = 0; trial < 12; ++trial) {
    const Vec3d corner = bounds.corner(trial % 8);
    const Vec3d size = random.uniform(0.01, 1) * bounds.extent();
    const Aabb box{corner - size, corner + size};
    const auto part = field->restrict_to(box);
    const auto nested = part->restrict_to({box.center(), box.max});
    for (int sample = 0; sample < 12; ++sample) {
      const Vec3d p = sample < 8 ? box.corner(sample) : point_in(random, box);
      const Jet jet = field->jet(p);
      EXPECT_EQ(jet, part->jet(p));
      if (Aabb{box.center(), box.max}.contains(p)) {
        EXPECT_EQ(jet, nested->jet(p));
      }
      Jet full;
      field->full_jets({&p, 1}, {&full, 1});
      EXPECT_NEAR(jet.value, full.value - 1, kBudget);
    }
  }
}

TEST(Field, ResultsDoNotDependOnTheCompanyOfAPoint) {
  const auto field = field_of(random_scene(5, 60), 1e-5);
  Random random(5, 5);
  std::vector<Vec3d> points;
  for (int i = 0; i < 500; ++i) points.push_back(random_point(random, 2));
  std::vector<Jet> together(points.size());
  std::vector<double> values(points.size());
  field->jets(points, together);
  field->values(points, values);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(together[i], field->jet(points[i]));
    EXPECT_EQ(values[i], together[i].value);
  }
}

TEST(Field, LeavesOutNoMoreThanTheBudget) {
  for (const double budget : {1e-9, 1e-4}) {
    const auto field = field_of(random_scene(6, 200), budget);
    Random random(6, 6);
    for (int i = 0; i < 2000; ++i) {
      const Vec3d p = random_point(random, 3);
      Jet full;
      field->full_jets({&p, 1}, {&full, 1});
      EXPECT_NEAR(field->value(p), full.value - 1, budget + 1e-13);
    }
  }
}

/// A plane in coordinates of its own, which are turned and stretched.
Field turned_plane() {
  Term term;
  term.kernel = Metaball{1.0, 1.5};
  term.primitive = Plane{{0, 0, 0}, {0, 0, 1}};
  term.frame = frame_of(term.primitive);
  const Affine to_world = Affine::rotate({1, 0, 0}, 50) * Affine::scale({1, 2, 0.5});
  term.to_local = std::make_shared<Affine>(inverse(to_world));
  return Field({term}, 1e-9);
}

TEST(Field, EnclosesPlanesThatAreTurnedWhereverTheyAre) {
  const Field field = turned_plane();
  const double angle = 50 * std::numbers::pi / 180;
  const Vec3d along{0, std::cos(angle), std::sin(angle)};
  const double middle = field.value({});
  for (const double t : {-30.0, -1.0, 0.3, 2.0, 100.0}) {
    EXPECT_NEAR(field.value(t * along), middle, 1e-9) << t;
    const Aabb box = Aabb{t * along, t * along}.grown(1e-3);
    EXPECT_GE(field.enclose(box).hi, middle - 1e-9) << t;
  }
}

TEST(Field, EnclosesPlanesInFiniteIntervals) {
  const Field field = turned_plane();
  Random random(7, 7);
  for (int i = 0; i < 200; ++i) {
    const Aabb box = random_box(random, 1);
    const Interval range = field.enclose(box);
    EXPECT_TRUE(range.contains(field.value(point_in(random, box))));
    EXPECT_LT(range.width(), 10.0);
  }
}

TEST(Field, BoundsHoldTheWholeInside) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const auto field = field_of(random_scene(seed, 9, kKinds[seed % 4]));
    const Aabb box = field->bounds();
    ASSERT_TRUE(box.finite());
    Random random(seed, 7);
    for (int i = 0; i < 500; ++i) {
      const Vec3d p = box.center() + random.uniform(0.5, 2) * box.diagonal() * random.direction();
      if (!box.contains(p)) {
        EXPECT_LT(field->value(p), 0);
      }
    }
  }
}

TEST(Field, SimilaritiesMoveTheSurfaceAlong) {
  // F(M^-1 p) of the scene at rest equals F(p) of the moved scene.
  const Scene rest = random_scene(9, 12, {true, false, false});
  Scene moved = rest;
  const Affine map = Affine::translate({1, -2, 3}) * Affine::rotate({1, 2, 3}, 77) *
                     Affine::scale({0.25, 0.25, -0.25});
  for (Element& element : moved.elements) element.transform = map;
  const auto before = field_of(rest);
  const auto after = field_of(moved);
  Random random(9, 9);
  for (int i = 0; i < 300; ++i) {
    const Vec3d p = random_point(random, 1.5);
    const double expected = before->value(p);
    EXPECT_NEAR(after->value(map(p)), expected, 1e-9 * (1 + std::abs(expected)));
  }
}

TEST(Field, SharesSumToOne) {
  const auto field = field_of(random_scene(4, 20, {false, false, true}));
  Random random(4, 10);
  std::vector<MaterialShare> shares;
  for (int i = 0; i < 200; ++i) {
    field->shares(random_point(random, 2), shares);
    double sum = 0;
    for (const MaterialShare& share : shares) {
      EXPECT_GE(share.share, 0);
      sum += share.share;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

TEST(Field, StiffFieldsStayFinite) {
  // e^1000 overflows, exponents do not.
  Scene scene = random_scene(1, 3);
  for (Material& material : scene.materials) {
    material.kernel = KernelKind::gaussian;
    material.blobbiness = -1000;
  }
  scene.elements.resize(2);
  const auto field = field_of(scene);
  Random random(1, 11);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d p = random_point(random, 3);
    const Jet jet = field->jet(p);
    EXPECT_FALSE(std::isnan(jet.value));
    EXPECT_FALSE(std::isnan(norm(jet.gradient)));
  }
}

}  // namespace
}  // namespace cs2mesh
