// The moments of the nodes of a source tree against sums over their elements.

#include "libfield/field/source_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libfield/base/random.h"
#include "libfield/integral/gauss_legendre.h"
#include "tests/unit/simd/every_isa.h"

namespace cs2mesh {
namespace {

/// Points, segments and, if wished, triangles of both signs, from much shorter than a leaf to as
/// long as the whole.
std::vector<FarElement> mixed_elements(std::size_t count, bool same_tau, bool triangles = false) {
  std::vector<FarElement> elements;
  for (std::uint32_t i = 0; i < count; ++i) {
    Random random(21, i);
    FarElement element;
    element.a = 4.0 * Vec3d{random.uniform(), random.uniform(), random.uniform()};
    element.b = element.a;
    if (i % 3 != 0) {
      element.length = std::pow(10.0, random.uniform(-3.0, 0.5));
      element.b = element.a + element.length * random.direction();
    }
    if (triangles && i % 3 == 1) {
      const Vec3d across = cross(element.b - element.a, random.direction());
      element.apex = element.b + across;
      element.area = 0.5 * norm(cross(element.b - element.a, across));
      element.length = norm(element.apex - element.a);
    }
    element.weight = random.uniform(-0.3, 1.0);
    element.tau = same_tau ? 0.5 : random.uniform(0.1, 0.9);
    element.term = i;
    elements.push_back(element);
  }
  return elements;
}

/// w t^j (-q)^k / k! of a place.
long double part(const SourceNode& node, const Vec3d& place, double t, int j, const int (&k)[3]) {
  long double product = std::pow(static_cast<long double>(t), j);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const long double q = (static_cast<long double>(place[axis]) - node.center[axis]) / node.radius;
    for (int n = 1; n <= k[axis]; ++n) product *= -q / n;
  }
  return product;
}

/// Sixteen nodes are exact for the powers that eight are exact for.
long double summed(const SourceTree& tree, const SourceNode& node, int j, const int (&k)[3]) {
  constexpr const UnitRule<16>& rule = kUnitRule<16>;
  long double sum = 0.0L;
  for (std::uint32_t e = node.first; e < node.first + node.count; ++e) {
    const FarElement& element = tree.elements()[e];
    const double t = node.tau_spread > 0 ? (element.tau - node.tau) / node.tau_spread : 0.0;
    if (!(element.length > 0)) {
      sum += element.weight * part(node, element.a, t, j, k);
      continue;
    }
    for (std::size_t i = 0; i < 16 && element.is_triangle(); ++i) {
      const Vec3d base = element.a + rule.node[i] * (element.b - element.a);
      for (std::size_t m = 0; m < 16; ++m) {
        const Vec3d place = element.apex + rule.node[m] * (base - element.apex);
        sum += 2 * element.weight * element.area * rule.weight[i] * rule.weight[m] * rule.node[m] *
               part(node, place, t, j, k);
      }
    }
    for (std::size_t i = 0; i < 16 && !element.is_triangle(); ++i) {
      const Vec3d place = element.a + rule.node[i] * (element.b - element.a);
      sum += element.weight * element.length * rule.weight[i] * part(node, place, t, j, k);
    }
  }
  return sum;
}

void expect_moments(const SourceTree& tree, std::uint32_t index) {
  const SourceNode& node = tree.node(index);
  for (int j = 0; j < (node.tau_spread > 0 ? kTauOrders : 1); ++j) {
    visit_powers([&](int a, int b, int c) {
      if ((a + 2 * b + 3 * c + j) % 5 != 0) return;  // some of them
      const int k[3] = {a, b, c};
      const double factorials = std::tgamma(a + 1) * std::tgamma(b + 1) * std::tgamma(c + 1);
      EXPECT_NEAR(tree.moments(index, j)[series_index(a, b, c)],
                  static_cast<double>(summed(tree, node, j, k)), 1e-14 * node.mass / factorials)
          << "node " << index << ", j " << j << ", k " << a << " " << b << " " << c;
    });
  }
}

TEST(SourceTree, HasTheMomentsOfItsElementsInEveryNode) {
  testing::with_every_isa([](Isa) {
    for (const bool same_tau : {true, false}) {
      const SourceTree tree(mixed_elements(150, same_tau));
      ASSERT_NE(tree.node(0).right, 0U);
      for (const std::uint32_t index : {0U, 1U, tree.node(0).right}) expect_moments(tree, index);
      EXPECT_FALSE(tree.has_moments(2));  // of a few elements
    }
  });
}

TEST(SourceTree, HasTheMomentsOfTriangles) {
  for (const bool same_tau : {true, false}) {
    const SourceTree tree(mixed_elements(90, same_tau, true));
    ASSERT_NE(tree.node(0).right, 0U);
    EXPECT_EQ(tree.node(0).triangles, 30U);
    EXPECT_TRUE(tree.has_moments(1));  // of few elements that take long
    for (const std::uint32_t index : {0U, 1U, tree.node(0).right}) expect_moments(tree, index);
  }
}

TEST(SourceTree, OfPointsAloneOrSegmentsAloneHasTheirMoments) {
  for (const std::uint32_t rest : {0U, 1U}) {
    std::vector<FarElement> elements;
    for (const FarElement& element : mixed_elements(60, false)) {
      if ((element.length > 0 ? 1U : 0U) == rest) elements.push_back(element);
    }
    expect_moments(SourceTree(elements), 0);
  }
}

}  // namespace
}  // namespace cs2mesh
