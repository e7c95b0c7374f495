// Pairs of triangles that meet where a closed surface must not.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct SelfIntersections {
  std::size_t count = 0;
  /// Some of them, sorted; in each the lower triangle first. The same for any number of threads.
  std::vector<std::array<TriangleMesh::Index, 2>> pairs;
};

/// All pairs of triangles that have a point in common which is not on a vertex or an edge that they
/// share by index: crossing, touching and overlapping count. Exact for the coordinates given.
/// Degenerate triangles are left out. Requires indices in range and finite coordinates.
/// O(n log n + pairs of overlapping boxes), in parallel. At most `most_pairs` pairs are listed, all
/// counted.
///
/// No answer from a build without CGAL.
std::optional<SelfIntersections> find_self_intersections(const TriangleMesh& mesh,
                                                         std::size_t most_pairs);

}  // namespace cs2mesh
