// The nearest point of a mesh, and the crossings of a ray with it: a tree of boxes over triangles.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// The point of triangle abc nearest to p. A thin triangle, whose normal is mostly rounding, can
/// only make the distance too large, by no more than its width.
Vec3d nearest_on_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& p);

/// Queries are in double precision, safe from any number of threads, and depend on the mesh alone.
/// The tree keeps what it needs of the mesh. Building takes O(n log n).
class ClosestPoint {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  explicit ClosestPoint(const TriangleMesh& mesh);

  struct Hit {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = kNone;  ///< index in the mesh
    Vec3d point;                     ///< on the triangle, to rounding
  };

  /// The nearest point that is closer to `p` than `upper_bound`; triangle kNone and infinite
  /// distance if there is none. Exact to rounding of the coordinates, also for triangles without
  /// area. O(log n) near the surface; a good bound makes it faster.
  Hit nearest(const Vec3d& p, double upper_bound = std::numeric_limits<double>::infinity()) const;

  /// Calls f(i, nearest(points[i])) in order. Points that follow each other are best near each
  /// other: the last nearest point bounds the next distance.
  template <class F>
  void nearest_each(std::span<const Vec3d> points, const F& f) const {
    Hit last;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double bound = last.triangle == kNone ? std::numeric_limits<double>::infinity()
                                                  : norm(points[i] - last.point) * (1 + 1e-9);
      Hit hit = nearest(points[i], bound);
      if (hit.triangle == kNone) hit = nearest(points[i]);
      last = hit;
      f(i, hit);
    }
  }

  /// All t in [t0, t1] where origin + t direction meets a triangle, ascending, by the watertight
  /// test of Woop, Benthin and Wald (2013): a ray cannot slip between two triangles that share an
  /// edge, but one through the edge itself may give t twice. Triangles seen edge-on are missed.
  std::vector<double> all_hits(const Vec3d& origin, const Vec3d& direction, double t0,
                               double t1) const;
  /// The smallest of them; infinity if there is none.
  double first_hit(const Vec3d& origin, const Vec3d& direction, double t0, double t1) const;

  /// The triangles so that neighbours in the list are near each other in space.
  std::span<const std::uint32_t> spatial_order() const { return triangle_of_; }

 private:
  struct Corners {
    Vec3d a, b, c;
  };
  /// Two children each; a child is a leaf of `count` triangles from `first`, or node `first`.
  struct Child {
    Aabb box;
    std::uint32_t first = 0;
    std::uint32_t count = 0;  ///< 0 for a node
  };
  struct Node {
    Child child[2];
  };
  class Builder;
  class RayWalk;

  std::vector<Node> nodes_;
  Child root_;
  std::vector<Corners> corners_;            ///< in the order of leaves
  std::vector<std::uint32_t> triangle_of_;  ///< index in the mesh, in the same order
};

}  // namespace cs2mesh
