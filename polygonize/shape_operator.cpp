#include "polygonize/shape_operator.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/base/check.h"
#include "polygonize/mesh_blocks.h"

namespace cs2mesh {
namespace {

/// Two directions of length 1 that complete a unit vector to a right-handed frame.
struct TangentFrame {
  explicit TangentFrame(const Vec3d& n) {
    const Vec3d side = std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    u = normalized(cross(n, side));
    v = cross(n, u);
  }
  Vec3d u, v;
};

/// The sums of the least squares at a vertex: of edges (x, y) and what normals turn by along them.
struct Fit {
  double xx = 0, xy = 0, yy = 0;       ///< products of edges
  double x_x = 0, mixed = 0, y_y = 0;  ///< x dx, x dy + y dx, y dy

  void add(double x, double y, double dx, double dy, double weight) {
    xx += weight * x * x, xy += weight * x * y, yy += weight * y * y;
    x_x += weight * x * dx, mixed += weight * (x * dy + y * dx), y_y += weight * y * dy;
  }
  /// The S that makes the sum of |S e - de|^2 least.
  Symmetric3 solve(const TangentFrame& frame) const {
    constexpr double kLeast = 1e-6;  // of directions that differ
    if (!(xx > 0 && yy > 0 && xx * yy - xy * xy > kLeast * (xx + yy) * (xx + yy))) return {};
    const double across =
        (mixed - xy * (x_x / xx + y_y / yy)) / ((xx + yy) - xy * xy * (1 / xx + 1 / yy));
    const double along_x = (x_x - across * xy) / xx, along_y = (y_y - across * xy) / yy;
    return along_x * squared(frame.u) + along_y * squared(frame.v) +
           across * symmetric_product(frame.u, frame.v);
  }
};

}  // namespace

std::vector<Symmetric3> shape_operators(const TriangleMesh& mesh, std::span<const Vec3d> normals) {
  require(normals.size() == mesh.positions.size(), "shape_operators: one normal a vertex");
  std::vector<Fit> fits(normals.size());
  MeshBlocks(mesh).for_each_triangle(Depth::inner, [&](std::size_t triangle) {
    const auto& t = mesh.triangles[triangle];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = t[k], b = t[(k + 1) % 3];
      const Vec3d edge = mesh.positions[b] - mesh.positions[a], turn = normals[b] - normals[a];
      const double length = squared_norm(edge);
      if (!(length > 0)) continue;
      const TangentFrame frame(normals[a]);
      fits[a].add(dot(edge, frame.u), dot(edge, frame.v), dot(turn, frame.u), dot(turn, frame.v),
                  1 / length);
    }
  });
  std::vector<Symmetric3> shapes(normals.size());
  tbb::parallel_for(std::size_t{0}, shapes.size(),
                    [&](std::size_t v) { shapes[v] = fits[v].solve(TangentFrame(normals[v])); });
  return shapes;
}

BendMetric bend_metric(const Symmetric3& shape, const Vec3d& normal, double stretch) {
  const Symmetric3 across = squared(normal), along = multiple_of_unit(1.0) - across;
  const double mean = 0.5 * trace(shape), size = norm(shape);
  const double radius = std::sqrt(std::max(0.5 * size * size - mean * mean, 0.0));
  const double k1 = mean + radius, k2 = mean - radius;
  const double greater = std::max(std::abs(k1), std::abs(k2));
  const double least = greater / stretch;
  const double m1 = std::max(std::abs(k1), least), m2 = std::max(std::abs(k2), least);
  // What has m1 where the shape has k1, and m2 where it has k2.
  const double factor = radius > 0 ? (m1 - m2) / (k1 - k2) : 0.0;
  BendMetric metric;
  metric.form = factor * shape + (m1 - factor * k1) * along + greater * across;
  metric.density = std::sqrt(m1 * m2);
  if (greater > 0) metric.ratio = std::abs(k1) >= std::abs(k2) ? k2 / k1 : k1 / k2;
  return metric;
}

double triangles_needed(const TriangleMesh& mesh, double tolerance) {
  constexpr double kStretch = 4.0;
  std::vector<Vec3d> normals(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const auto v : mesh.triangles[t]) normals[v] += area_vector(mesh, t);
  }
  for (Vec3d& normal : normals) {
    const double length = norm(normal);
    normal = length > 0 ? normal / length : Vec3d{0, 0, 1};
  }
  const std::vector<Symmetric3> shapes = shape_operators(mesh, normals);
  std::vector<double> densities(normals.size());
  for (std::size_t v = 0; v < normals.size(); ++v) {
    densities[v] = bend_metric(shapes[v], normals[v], kStretch).density;
  }
  // An equilateral triangle of side s is s^2 / 6 off a sphere of radius 1.
  const double unit = 6 * tolerance * std::sqrt(3.0) / 4;
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    sum += norm(area_vector(mesh, t)) * (densities[a] + densities[b] + densities[c]) / 3;
  }
  return sum / unit;
}

}  // namespace cs2mesh
