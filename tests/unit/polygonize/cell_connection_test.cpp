#include "polygonize/cell_connection.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libfield/base/random.h"
#include "polygonize/cell_table.h"
#include "tests/unit/polygonize/analytic_surfaces.h"

namespace cs2mesh {
namespace {

using namespace analytic;

/// Rods along z around two corners of every face across it, and something around its middle: a rod,
/// thin or as thick as to hold them together, or a plate along the other diagonal.
struct Rods {
  double thickness = 0.2;
  double middle = 0.05;
  double plate = -1.0;
  template <class T>
  static T rod(const Vec3<T>& p, double x, double y, double radius) {
    return T(radius * radius) - square(p.x - T(x)) - square(p.y - T(y));
  }
  template <class T>
  T operator()(const Vec3<T>& p) const {
    const T ends = larger(rod(p, 0, 0, thickness), rod(p, 1, 1, thickness));
    const T between = larger(rod(p, 0.5, 0.5, middle), T(plate) - square(p.x - p.y));
    return larger(ends, between);
  }
  Aabb bounds() const { return cube(2); }
};

std::array<Vec3d, 8> unit_cube(const Vec3d& origin = {}) {
  std::array<Vec3d, 8> corners;
  for (unsigned c = 0; c < 8; ++c) {
    corners[c] = origin + Vec3d{double(c & 1U), double(c >> 1U & 1U), double(c >> 2U & 1U)};
  }
  return corners;
}

unsigned inside_of(const ImplicitSurface& surface, const std::array<Vec3d, 8>& corners) {
  unsigned inside = 0;
  for (unsigned c = 0; c < 8; ++c) inside |= surface.value(corners[c]) >= 0 ? 1U << c : 0U;
  return inside;
}

CellConnection connection_of(const Rods& rods) {
  const Surface<Rods> surface(rods);
  const unsigned inside = inside_of(surface, unit_cube());
  EXPECT_EQ(inside, 0x99U);
  return connect_cell(surface, unit_cube(), inside);
}

TEST(CellConnection, WhatIsInTheMiddleNeedNotHoldTogether) {
  // A rod in the middle, apart from the others: outside it goes around.
  const CellConnection apart = connection_of({0.2, 0.1});
  EXPECT_EQ(apart.joined, 0U);
  EXPECT_EQ(apart.side, false);
  // One thick enough to touch them.
  const CellConnection together = connection_of({0.3, 0.45});
  EXPECT_EQ(together.joined, ambiguous_faces(0x99U));
  EXPECT_EQ(together.side, true);
}

TEST(CellConnection, PlacesAreInTheCellOnItsSide) {
  for (const Rods rods : {Rods{0.2, 0.1}, Rods{0.3, 0.45}}) {
    const Surface<Rods> surface(rods);
    const CellConnection found = connection_of(rods);
    ASSERT_TRUE(found.side);
    ASSERT_FALSE(found.places.empty());
    double last = 0.0;
    for (const Vec3d& p : found.places) {
      EXPECT_EQ(surface.value(p) >= 0, *found.side);
      EXPECT_GT(std::min({p.x, p.y, p.z}), 0.0);
      EXPECT_LT(std::max({p.x, p.y, p.z}), 1.0);
      const double distance = norm(p - Vec3d{0.5, 0.5, 0.5});
      EXPECT_GE(distance, last - 1e-15);
      last = distance;
    }
  }
}

/// Thinner than a cell, along the diagonal of the grid or along the other.
struct Wall {
  double turned = 1.0;
  template <class T>
  T operator()(const Vec3<T>& p) const {
    return T(0.01) - square(p.x - T(turned) * p.y + T(0.5 * turned - 0.5));
  }
  Aabb bounds() const { return cube(2); }
};

TEST(CellConnection, WhatRunsAlongADiagonalIsJoined) {
  for (const double turned : {1.0, -1.0}) {
    for (const Vec3d& shift : {Vec3d{0, 0, 0}, Vec3d{0.02, -0.03, 0.1}}) {
      const Surface<Wall> wall(Wall{turned});
      const auto corners = unit_cube(shift);
      const unsigned inside = inside_of(wall, corners);
      ASSERT_EQ(inside, turned > 0 ? 0x99U : 0x66U);
      const CellConnection found = connect_cell(wall, corners, inside);
      EXPECT_EQ(found.joined, ambiguous_faces(inside));
      EXPECT_EQ(found.side, true);
    }
  }
}

/// The number of the face across an axis, at the upper or the lower end of it.
std::size_t face_across(unsigned axis, bool upper) {
  std::size_t found = 0;
  for (std::size_t f = 0; f < 6; ++f) {
    const auto& face = cube_shape().faces[f];
    const auto lies_there = [&](int c) {
      return ((static_cast<unsigned>(c) >> axis) & 1U) == (upper ? 1U : 0U);
    };
    if (std::all_of(face.begin(), face.end(), lies_there)) found = f;
  }
  return found;
}

TEST(CellConnection, BothCellsAtAFaceSeeTheSame) {
  Random random(1, 1);
  for (unsigned trial = 0; trial < 2000; ++trial) {
    // Two cells side by side along an axis, corners moved, signs at random.
    const unsigned axis = trial % 3, step = 1U << axis;
    const LatticeNoise noise(12, 0.5, 0.1, trial);
    std::array<Vec3d, 8> low = unit_cube(), high = low;
    unsigned low_inside = 0, high_inside = 0;
    for (unsigned c = 0; c < 8; ++c) {
      const Vec3d move{random.uniform(), random.uniform(), random.uniform()};
      low[c] = Vec3d{2.3, 3.1, 2.7} + 3.0 * (low[c] + 0.3 * move);
      high[c] = low[c];
      high[c][axis] += 3.0;
      low_inside |= random.bits() % 2 == 0 ? 1U << c : 0U;
      high_inside |= random.bits() % 2 == 0 ? 1U << c : 0U;
    }
    for (unsigned c = 0; c < 8; ++c) {
      if ((c & step) != 0) continue;
      high[c] = low[c | step];
      high_inside = (high_inside & ~(1U << c)) | ((low_inside >> (c | step)) & 1U) << c;
    }
    const unsigned first = connect_cell(noise, low, low_inside).joined;
    const unsigned second = connect_cell(noise, high, high_inside).joined;
    EXPECT_EQ((first >> face_across(axis, true)) & 1U, (second >> face_across(axis, false)) & 1U);
  }
}

}  // namespace
}  // namespace cs2mesh
