// Box tests by CGAL's streamed segment trees (Zomorodian and Edelsbrunner 2002), triangle tests by
// its exact predicates.
#include "polygonize/self_intersection.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>

namespace cs2mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = std::array<TriangleMesh::Index, 3>;

/// The box of one triangle, as box_self_intersection_d wants it.
class TriangleBox {
 public:
  using NT = double;
  using ID = std::size_t;
  TriangleBox() = default;
  TriangleBox(const TriangleMesh& mesh, std::size_t triangle) : triangle_(triangle) {
    for (const TriangleMesh::Index v : mesh.triangles[triangle]) box_.include(mesh.positions[v]);
  }
  static int dimension() { return 3; }
  ID id() const { return triangle_; }
  NT min_coord(int d) const { return box_.min[static_cast<std::size_t>(d)]; }
  NT max_coord(int d) const { return box_.max[static_cast<std::size_t>(d)]; }

 private:
  Aabb box_;
  std::size_t triangle_ = 0;
};

Point point(const TriangleMesh& mesh, TriangleMesh::Index vertex) {
  const Vec3d& p = mesh.positions[vertex];
  return {p.x, p.y, p.z};
}

bool degenerate(const TriangleMesh& mesh, const Triangle& t) {
  return CGAL::collinear(point(mesh, t[0]), point(mesh, t[1]), point(mesh, t[2]));
}

/// Rotates `t` so that its vertices shared with `other` come first; returns how many there are.
int shared_first(Triangle& t, const Triangle& other) {
  const auto shared = [&](TriangleMesh::Index v) {
    return std::find(other.begin(), other.end(), v) != other.end();
  };
  const int count = static_cast<int>(std::count_if(t.begin(), t.end(), shared));
  if (count == 1) {
    while (!shared(t[0])) std::rotate(t.begin(), t.begin() + 1, t.end());
  } else if (count == 2) {
    while (shared(t[2])) std::rotate(t.begin(), t.begin() + 1, t.end());
  }
  return count;
}

bool meets_opposite_edge(const TriangleMesh& mesh, const Triangle& t, const Triangle& other) {
  const Kernel::Triangle_3 triangle(point(mesh, t[0]), point(mesh, t[1]), point(mesh, t[2]));
  const Kernel::Segment_3 segment(point(mesh, other[1]), point(mesh, other[2]));
  return CGAL::do_intersect(triangle, segment);
}

bool intersect(const TriangleMesh& mesh, Triangle a, Triangle b) {
  const Triangle original_a = a;
  const int shared = shared_first(a, b);
  shared_first(b, original_a);
  switch (shared) {
    case 0: {
      const Kernel::Triangle_3 ta(point(mesh, a[0]), point(mesh, a[1]), point(mesh, a[2]));
      const Kernel::Triangle_3 tb(point(mesh, b[0]), point(mesh, b[1]), point(mesh, b[2]));
      return CGAL::do_intersect(ta, tb);
    }
    case 1:
      // What they have in common beyond the vertex runs to where it leaves one of the two, across
      // the edge opposite to the vertex.
      return meets_opposite_edge(mesh, a, b) || meets_opposite_edge(mesh, b, a);
    case 2: {
      // Folded flat onto each other: the third vertices on the same side of the shared edge.
      const Point p = point(mesh, a[0]);
      const Point q = point(mesh, a[1]);
      const Point r = point(mesh, a[2]);
      const Point s = point(mesh, b[2]);
      return CGAL::coplanar(p, q, r, s) && CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
    }
    default:
      return true;  // the same three vertices
  }
}

}  // namespace

std::optional<SelfIntersections> find_self_intersections(const TriangleMesh& mesh,
                                                         std::size_t most_pairs) {
  std::vector<TriangleBox> boxes;
  boxes.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!degenerate(mesh, mesh.triangles[t])) boxes.emplace_back(mesh, t);
  }
  std::vector<const TriangleBox*> pointers;
  pointers.reserve(boxes.size());
  for (const TriangleBox& box : boxes) pointers.push_back(&box);

  SelfIntersections found;
  const auto test = [&](const TriangleBox* a, const TriangleBox* b) {
    if (!intersect(mesh, mesh.triangles[a->id()], mesh.triangles[b->id()])) return;
    const auto low = std::min(a->id(), b->id());
    const auto high = std::max(a->id(), b->id());
    found.pairs.push_back(
        {static_cast<TriangleMesh::Index>(low), static_cast<TriangleMesh::Index>(high)});
  };
  CGAL::box_self_intersection_d(pointers.begin(), pointers.end(), test);
  found.count = found.pairs.size();
  std::sort(found.pairs.begin(), found.pairs.end());
  if (found.pairs.size() > most_pairs) found.pairs.resize(most_pairs);
  return found;
}

}  // namespace cs2mesh
