#include "tests/bench/largest_triangle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "polygonize/sagitta.h"

namespace cs2mesh::bench {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// An edge in the plane.
struct Edge {
  double x, y;
};

/// How far the quadric is from a triangle with these edges, turned by the angle with this cosine
/// and sine.
DeviationRange range_of(const Edge (&edges)[3], double ratio, double c, double s) {
  double rise[3];
  for (int k = 0; k < 3; ++k) {
    const double x = c * edges[k].x - s * edges[k].y, y = s * edges[k].x + c * edges[k].y;
    rise[k] = (x * x + ratio * y * y) / 8;
  }
  return deviation_range(rise[0], rise[1], rise[2]);
}

/// The least distance of a triangle with these edges, however it is turned.
double least_distance(const Edge (&edges)[3], double ratio, bool balanced) {
  double least = HUGE_VAL;
  for (int turn = 0; turn < 180; turn += 2) {
    const auto [low, high] =
        range_of(edges, ratio, std::cos(turn * kDegree), std::sin(turn * kDegree));
    least = std::min(least, balanced ? 0.5 * (high - low) : std::max(-low, high));
  }
  return least;
}

}  // namespace

double largest_triangle(double ratio, double least_angle, bool balanced) {
  double largest = 0.0;
  for (double a = least_angle; 3 * a <= 180; a += 1) {
    for (double b = a; a + 2 * b <= 180; b += 1) {
      // On a base of length 1, between the angles a and b.
      const double side = std::sin(b * kDegree) / std::sin((a + b) * kDegree);
      const double x = side * std::cos(a * kDegree), y = side * std::sin(a * kDegree);
      // Its mirror image is the same over a quadric that is symmetric.
      const Edge edges[3] = {{1, 0}, {x - 1, y}, {-x, -y}};
      largest = std::max(largest, 0.5 * y / least_distance(edges, ratio, balanced));
    }
  }
  return largest;
}

}  // namespace cs2mesh::bench
