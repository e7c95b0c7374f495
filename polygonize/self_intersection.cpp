// Candidates by overlapping boxes, then triangle tests by CGAL's exact predicates.
#include "polygonize/self_intersection.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <tbb/parallel_for.h>

#include <algorithm>

#include "polygonize/box_pairs.h"

namespace cs2mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = std::array<TriangleMesh::Index, 3>;

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
  std::vector<TriangleMesh::Index> proper;
  std::vector<Aabb> boxes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    if (degenerate(mesh, triangle)) continue;
    proper.push_back(static_cast<TriangleMesh::Index>(t));
    Aabb& box = boxes.emplace_back();
    for (const TriangleMesh::Index v : triangle) box.include(mesh.positions[v]);
  }

  const BoxPairs candidates(boxes);
  std::vector<SelfIntersections> found_by_group(candidates.group_count());
  tbb::parallel_for(std::size_t{0}, candidates.group_count(), [&](std::size_t group) {
    candidates.for_each_pair(group, [&](std::uint32_t i, std::uint32_t j) {
      const TriangleMesh::Index low = proper[std::min(i, j)];
      const TriangleMesh::Index high = proper[std::max(i, j)];
      if (!intersect(mesh, mesh.triangles[low], mesh.triangles[high])) return;
      SelfIntersections& found = found_by_group[group];
      if (found.count++ < most_pairs) found.pairs.push_back({low, high});
    });
  });

  SelfIntersections found;
  for (const SelfIntersections& part : found_by_group) {
    found.count += part.count;
    found.pairs.insert(found.pairs.end(), part.pairs.begin(), part.pairs.end());
  }
  std::sort(found.pairs.begin(), found.pairs.end());
  if (found.pairs.size() > most_pairs) found.pairs.resize(most_pairs);
  return found;
}

}  // namespace cs2mesh
