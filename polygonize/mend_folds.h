// Triangles that face away from the surface, collapsed or flipped.
#pragma once

#include <cstddef>
#include <span>

#include "polygonize/editable_mesh.h"

namespace cs2mesh {

struct FoldsMended {
  std::size_t collapses = 0, flips = 0;
};

/// Gets rid of triangles that do not face the way of the surface at one of their corners, as
/// faces_normals() has it with a cosine of `least`, by collapsing or flipping one of their edges
/// where that leaves fewer of them around. `normals`, one a vertex, are those of the surface,
/// outward and of length 1. Not promised: that every such triangle can be helped.
FoldsMended mend_folds(EditableMesh& mesh, std::span<const Vec3d> normals, double least);

}  // namespace cs2mesh
