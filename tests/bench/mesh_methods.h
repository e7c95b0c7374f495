// The ways of making a mesh that the benchmarks compare: our meshers and the peers that are built
// in.
#pragma once

#include <span>
#include <string_view>

#include "libfield/field/compile.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh::bench {

struct MeshMethod {
  std::string_view name;
  bool ours = false;
  /// Of ours `size` is the tolerance. A peer promises no distance: its size is that of its cells,
  /// or CGAL's bound at the middle of a facet, and is to be searched for. Empty where it fails.
  TriangleMesh (*mesh)(const Part& part, double size);
  /// The first size to try, in tolerances.
  double first_size = 1.0;
  /// Bytes of memory for each cell of the bounds; 0 where that is no matter.
  double bytes_a_cell = 0.0;
};

/// Ours first, in the order of meshers().
std::span<const MeshMethod> mesh_methods();
/// Null if there is none of that name.
const MeshMethod* find_mesh_method(std::string_view name);

}  // namespace cs2mesh::bench
