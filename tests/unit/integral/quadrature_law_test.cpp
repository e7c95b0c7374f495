// The closed forms against the integrals that define them, by quadrature in 50 digits.

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/expm1.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "libfield/integral/cauchy_arc.h"
#include "libfield/integral/cauchy_segment.h"
#include "libfield/integral/cauchy_triangle.h"
#include "libfield/integral/gaussian_segment.h"

namespace cs2mesh {
namespace {

using Wide = boost::multiprecision::cpp_bin_float_50;
using Rule = boost::math::quadrature::gauss<Wide, 30>;

struct Node {
  Wide at, weight;
};

/// A composite rule on [0, 1].
std::vector<Node> composite(int panels) {
  std::vector<Node> nodes;
  for (int i = 0; i < panels; ++i) {
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k) {
      const Wide x = Rule::abscissa()[k], w = Rule::weights()[k] / (2 * panels);
      nodes.push_back({(i + (1 - x) / 2) / panels, w});
      nodes.push_back({(i + (1 + x) / 2) / panels, w});
    }
  }
  return nodes;
}

/// What a piece of the primitive at q of measure `weight` adds at p.
template <class Kernel>
void add(const Kernel& kernel, const Vec3<Wide>& p, const Vec3<Wide>& q, const Wide& weight,
         JetOf<Wide>& sum) {
  const Vec3<Wide> d = p - q;
  const Wide u = squared_norm(d);
  sum.value += weight * kernel.profile(u);
  sum.gradient += (2 * weight * kernel.slope(u)) * d;
}

/// Panels short against 1 / per_width keep the poles away from each.
int panels_for(double per_width, double size) {
  return static_cast<int>(std::ceil(2.0 * per_width * size)) + 2;
}

template <class Kernel>
JetOf<Wide> defining_integral(const Kernel& kernel, const Segment& segment, const Vec3<Wide>& p) {
  const Vec3<Wide> a(segment.a), axis = Vec3<Wide>(segment.b) - a;
  const Wide length = norm(axis);
  JetOf<Wide> sum;
  for (const Node& n : composite(panels_for(1.0 / kernel.length_scale(), double(length)))) {
    add(kernel, p, a + n.at * axis, n.weight * length, sum);
  }
  return sum;
}

JetOf<Wide> defining_integral(const Cauchy& kernel, const Arc& arc, const Vec3<Wide>& p) {
  const Vec3<Wide> center(arc.center), ex(arc.ex), ey(arc.ey);
  const Wide c = arc.radius, sweep = arc.sweep;
  JetOf<Wide> sum;
  for (const Node& n : composite(panels_for(kernel.s, arc.radius * arc.sweep) + 8)) {
    const Wide angle = sweep * (n.at - Wide(0.5));
    add(kernel, p, center + (c * cos(angle)) * ex + (c * sin(angle)) * ey, n.weight * c * sweep,
        sum);
  }
  return sum;
}

/// The unit square folded onto the triangle: (t, r) -> v0 + t (e1 + r (e2 - e1)).
JetOf<Wide> defining_integral(const Cauchy& kernel, const Triangle& triangle, const Vec3<Wide>& p) {
  const Vec3<Wide> v0(triangle.vertex[0]);
  const Vec3<Wide> e1 = Vec3<Wide>(triangle.vertex[1]) - v0;
  const Vec3<Wide> e2 = Vec3<Wide>(triangle.vertex[2]) - v0;
  const Wide doubled_area = norm(cross(e1, e2));
  const double size = static_cast<double>(norm(e1) + norm(e2));
  const std::vector<Node> nodes = composite(panels_for(kernel.s, size));
  JetOf<Wide> sum;
  for (const Node& t : nodes) {
    for (const Node& r : nodes) {
      add(kernel, p, v0 + t.at * (e1 + r.at * (e2 - e1)), t.weight * r.weight * t.at * doubled_area,
          sum);
    }
  }
  return sum;
}

template <class Kernel, class Primitive>
void expect_defined(const Kernel& kernel, const Primitive& primitive, const Vec3d& point) {
  const Vec3<Wide> p(point);
  const JetOf<Wide> closed = integral(kernel, primitive, p);
  const JetOf<Wide> defined = defining_integral(kernel, primitive, p);
  EXPECT_LT(static_cast<double>(abs(closed.value - defined.value) / defined.value), 1e-25)
      << point.x << ", " << point.y << ", " << point.z;
  EXPECT_LT(static_cast<double>(norm(closed.gradient - defined.gradient) /
                                (norm(defined.gradient) + defined.value)),
            1e-25)
      << point.x << ", " << point.y << ", " << point.z;
}

const Vec3d kPoints[] = {{0.3, 0.2, 0.1},   {0.5, 0.0, 0.0}, {0.0, 0.0, 0.0},  {1.25, 0.0, 0.0},
                         {-0.7, 0.4, 0.25}, {8.0, 3.0, 2.0}, {0.0, -1.0, 0.5}, {-1.0, 0.0, 0.0}};

TEST(DefiningIntegral, Segments) {
  const Segment segment{{0, 0, 0}, {1, 0.25, -0.5}};
  for (const Vec3d& p : kPoints) {
    for (const double width : {0.1, 2.0, 25.0}) expect_defined(Cauchy{width, 1.5}, segment, p);
    for (const double width : {0.1, 1.0, 3.0}) expect_defined(Gaussian{width, 2.0}, segment, p);
  }
}

TEST(DefiningIntegral, Arcs) {
  for (const double sweep : {1e-3, 1.0, 3.5, 6.25}) {
    Arc arc{{0, 0, 0}, 1.0, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, sweep};
    for (const Vec3d& p : kPoints) {
      for (const double width : {0.1, 5.0}) expect_defined(Cauchy{width, 1.5}, arc, p);
    }
    // Mirrored: the angle grows clockwise about the normal.
    arc.normal = {0, 0, -1};
    expect_defined(Cauchy{2.0}, arc, kPoints[0]);
  }
}

TEST(DefiningIntegral, FullCircles) {
  const Arc circle{{0, 0, 0}, 1.0, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, 2.0 * std::numbers::pi};
  for (const Vec3d& p : kPoints) {
    // The double nearest to a turn leaves a gap of 2e-16, in the closed form too.
    for (const double width : {0.1, 5.0}) expect_defined(Cauchy{width}, circle, p);
  }
}

TEST(DefiningIntegral, Triangles) {
  const Triangle triangle{{Vec3d{0, 0, 0}, {1, 0, 0}, {0.25, 0.75, 0.125}}};
  for (const Vec3d& p : kPoints) expect_defined(Cauchy{0.25, 1.5}, triangle, p);
  expect_defined(Cauchy{2.0}, triangle, kPoints[0]);
  expect_defined(Cauchy{2.0}, triangle, kPoints[4]);
}

}  // namespace
}  // namespace cs2mesh
