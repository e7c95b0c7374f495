// Which triangles of a mesh are too far from its surface, as measured at points of each.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "libfield/field/implicit_surface.h"
#include "polygonize/lost_point.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

struct FarOptions {
  double tolerance = 0.0;  ///< scene units, > 0
  /// Triangles smaller than this are looked at in more places; scene units.
  double small = 0.0;
  /// No surface is looked for farther away; scene units.
  double longest_way = std::numeric_limits<double>::infinity();
  /// If given, for each vertex the way out (near_proof.h): triangles that are proven to be near are
  /// not measured.
  std::span<const Vec3d> directions{};
};

/// Of each of these triangles of the mesh that is too far, a point where it is. What is proven to
/// be near is not looked at, nor what is as near to corners that are on the surface. Else it looks
/// at the point where one with its corners on a sphere is farthest from it and at the middles of
/// its edges; at more unless the surface is there where normals at the corners say that it is
/// (told_heights.h), and that is near all over. Distances are those of find_foot(). The triangles
/// are best near each other, as F is restricted to the box around them, and points of several
/// triangles are looked at once. Some three jets a triangle; up to 17 and as many values where that
/// leaves it in doubt. Not promised: that none of the others is too far somewhere else.
std::vector<LostPoint> far_triangles(const ImplicitSurface& surface, const TriangleMesh& mesh,
                                     std::span<const std::size_t> triangles,
                                     const FarOptions& options);

/// The jets at points that are near each other.
std::vector<Jet> jets_at_neighbours(const ImplicitSurface& surface, std::span<const Vec3d> points);

/// Neighbours in a mesh's order that are worth a restriction of F.
inline constexpr std::size_t kNeighbours = 256;

/// Runs f(first, last) for ranges of at most kNeighbours in parallel.
template <class F>
void for_each_neighbourhood(std::size_t count, const F& f) {
  tbb::parallel_for(std::size_t{0}, (count + kNeighbours - 1) / kNeighbours, [&](std::size_t i) {
    f(kNeighbours * i, std::min(kNeighbours * (i + 1), count));
  });
}

}  // namespace cs2mesh
