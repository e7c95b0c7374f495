// Triangles as chords against their fields, and against the bound of what they are off by.

#include "libfield/field/far_chords.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/integral/integral.h"
#include "libfield/primitive/nearest_point.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

TEST(ChordRule, IsExactUpToItsDegree) {
  for (std::size_t which = 0; which < kChordCounts.size(); ++which) {
    const int n = kChordCounts[which];
    for (int degree = 0; degree <= 2 * n; ++degree) {
      double sum = 0.0;
      for (const Chord& chord : chord_rule(which)) sum += chord.part * std::pow(chord.at, degree);
      const double exact = 2.0 / (degree + 2);
      if (degree < 2 * n) {
        EXPECT_NEAR(sum, exact, 4e-16) << n << " chords, degree " << degree;
      } else if (n < 10) {
        // What is missing is the error of f = u^2n, whose derivative is (2n)!.
        EXPECT_NEAR((exact - sum) / chord_factor(1.0, n), 1.0, 1e-4) << n << " chords";
      }
    }
  }
}

/// The integral of a chord, as exactly as double allows.
double chord_field(const Kernel& kernel, const SegmentSource& source, double mass, const Vec3d& p) {
  const Segment segment{source.middle - source.half, source.middle + source.half};
  const double mean =
      std::visit([&](const auto& k) { return integral(k, segment, p).value; }, kernel) /
      norm(segment.b - segment.a);
  return mass * mean;
}

TEST(FarChords, AreOffByNoMoreThanTheirBound) {
  Random random(17);
  double nearest = 0.0;
  for (int i = 0; i < 400; ++i) {
    const double height = i % 4 == 0 ? random.uniform(0.01, 0.1) : random.uniform(0.2, 1.0);
    const Vec3d along = random.direction();
    const Vec3d up = normalized(cross(along, random.direction()));
    const Vec3d corner = random.direction();
    const Triangle triangle{
        {corner, corner + along, corner + random.uniform(-0.2, 1.2) * along + height * up}};
    const auto kind = std::array{KernelKind::cauchy, KernelKind::inverse,
                                 KernelKind::squared}[static_cast<std::size_t>(i % 3)];
    const Term term =
        testing::plain_term(make_kernel(kind, random.uniform(0.3, 20.0), 1.0, 0.0, 1e-9), triangle);
    const std::optional<FarElement> element = far_element(term, 0);
    ASSERT_TRUE(element);
    EXPECT_NEAR(element->area, measure(triangle), 1e-12 * element->area);
    const double two_nu = *far_exponent(term.kernel);
    const Vec3d p = triangle.vertex[static_cast<std::size_t>(i % 2)] +
                    random.uniform(0.5, 4.0) * random.direction();
    const double s = squared_norm(p - nearest_point(triangle, p)) + element->tau;
    Jet exact;
    accumulate(term, {&p, 1}, std::span(&exact, 1));
    for (std::size_t which = 0; which < kChordCounts.size(); ++which) {
      double sum = 0.0;
      for (const Chord& chord : chord_rule(which)) {
        const SegmentSource source = chord_source(*element, chord);
        EXPECT_NEAR(source.weight, chord.part * element->mass(), 1e-15 * element->mass());
        sum += chord_field(term.kernel, source, chord.part * element->area, p);
      }
      const double ratio = element->length * element->length / s;
      const double bound = element->mass() * std::pow(s, -0.5 * two_nu) *
                           chord_factor(two_nu, kChordCounts[which]) *
                           std::pow(ratio, kChordCounts[which]);
      const double error = std::abs(sum - exact.value);
      EXPECT_LE(error, bound + 1e-13 * exact.value)
          << "triangle " << i << ", " << kChordCounts[which] << " chords";
      if (bound < 1.0 && bound > 1e-11 * exact.value) nearest = std::max(nearest, error / bound);
    }
  }
  EXPECT_GT(nearest, 0.02);  // the bound is not far off
}

TEST(FarChords, SliversAndTransformedTrianglesHaveNoElement) {
  const auto element_of = [](const Triangle& triangle) {
    return far_element(testing::plain_term(Cauchy{3.0}, triangle), 0);
  };
  EXPECT_TRUE(element_of({{Vec3d{0, 0, 0}, {1, 0, 0}, {0.5, 1e-3, 0}}}));
  EXPECT_FALSE(element_of({{Vec3d{0, 0, 0}, {1, 0, 0}, {0.5, 1e-6, 0}}}));
  EXPECT_FALSE(element_of({{Vec3d{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}}));
  EXPECT_FALSE(element_of({{Vec3d{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}));
}

}  // namespace
}  // namespace cs2mesh
