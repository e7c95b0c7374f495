// F near the leaves of an octree, by their own restrictions of it.
#pragma once

#include <span>

#include "polygonize/surface_octree.h"

namespace cs2mesh {

/// The jets at points, each near the leaf of the same number, whose restriction of F it is asked of
/// where the box of that holds the point and those beside it in the list; else `surface`, which the
/// tree was built over. Points whose leaves share a restriction are best next to each other. Spans
/// are of equal length. In parallel; the same jets for any number of threads.
void leaf_jets(const ImplicitSurface& surface, const SurfaceOctree& tree,
               std::span<const Octree::Index> leaves, std::span<const Vec3d> points,
               std::span<Jet> jets);

}  // namespace cs2mesh
