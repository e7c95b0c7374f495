// What a ball cuts out of a primitive lies as far ahead as is said, and hardly farther.
#include "libfield/field/part_in_sight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libfield/base/random.h"
#include "tests/property/random_primitives.h"

namespace cs2mesh {
namespace {

Vec3d point_of(const Segment& segment, Random& random) {
  return segment.a + random.uniform() * (segment.b - segment.a);
}
Vec3d point_of(const Arc& arc, Random& random) {
  const double t = arc.sweep * random.uniform(-0.5, 0.5);
  return arc.center + arc.radius * (std::cos(t) * arc.ex + std::sin(t) * arc.ey);
}
Vec3d point_of(const Triangle& triangle, Random& random) {
  const double u = random.uniform(), v = random.uniform() * (1 - u);
  const auto& corner = triangle.vertex;
  return corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]);
}
Vec3d point_of(const Point& point, Random& /*random*/) {
  return point.position;
}

struct Seen {
  int points = 0;        ///< of primitives, in sight
  double widest = -1e9;  ///< by how much the least of them lies farther ahead than was said
};

template <class P>
Seen look(std::size_t kind, int rounds) {
  Random random(17, kind);
  Seen seen;
  for (int round = 0; round < rounds; ++round) {
    const Primitive primitive = testing::random_primitive(random, kind, 1.0);
    const P& element = std::get<P>(primitive);
    const Vec3d p = 1.5 * random.uniform() * random.direction();
    const double sight = distance(element, p) + random.uniform(0.01, 0.5);
    const Vec3d direction = random.uniform(0.5, 2) * random.direction();
    const double said = least_ahead(element, p, direction, sight);
    double least = HUGE_VAL;
    for (int k = 0; k < 2000; ++k) {
      const Vec3d at = point_of(element, random);
      if (norm(at - p) > sight) continue;
      ++seen.points;
      least = std::min(least, dot(direction, at - p));
    }
    EXPECT_GE(least, said - 1e-12) << "primitive " << kind << ", round " << round;
    if (least < HUGE_VAL) seen.widest = std::max(seen.widest, least - said);
  }
  return seen;
}

TEST(PartInSight, HoldsEveryElement) {
  EXPECT_GT(look<Point>(0, 100).points, 1000);
  const Seen segments = look<Segment>(1, 300), arcs = look<Arc>(2, 300);
  EXPECT_GT(segments.points, 1000);
  EXPECT_GT(arcs.points, 1000);
  EXPECT_LT(segments.widest, 0.05);
  EXPECT_LT(arcs.widest, 0.05);
  EXPECT_GT(look<Triangle>(3, 300).points, 1000);
}

TEST(PartInSight, IsAheadWhereThereIsNone) {
  const Arc arc = make_arc({0, 0, 0}, 1.0, {0, 0, 1}, 0.0, 360.0);
  EXPECT_GT(least_ahead(arc, {3, 0, 0}, {1, 0, 0}, 0.5), 0.0);
  EXPECT_GT(least_ahead(Segment{{0, 0, 0}, {1, 0, 0}}, {3, 0, 0}, {1, 0, 0}, 0.5), 0.0);
  const Triangle triangle{{Vec3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  EXPECT_GT(least_ahead(triangle, {0, 0, 3}, {0, 0, 1}, 0.5), 0.0);
}

TEST(PartInSight, OfRingsIsTheNearSideAlone) {
  const Arc ring = make_arc({0, 0, 0}, 1.0, {0, 0, 1}, 0.0, 360.0);
  for (const double angle : {0.0, 1.0, 3.14159265, -2.0}) {
    const Vec3d out{std::cos(angle), std::sin(angle), 0};
    EXPECT_GT(least_ahead(ring, 0.8 * out, out, 0.3), 0.1) << angle;
    EXPECT_GT(least_ahead(ring, 1.2 * out, -1.0 * out, 0.3), 0.1) << angle;
  }
}

}  // namespace
}  // namespace cs2mesh
