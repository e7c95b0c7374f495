// The shell around a mesh that certificates are about, as a body: a prism for each triangle.
//
// Each vertex has an outer and an inner place; with barycentric coordinates a triangle spans a
// prism of segments from its inner to its outer triangle, and of layers between these. A prism is
// straight if all its layers leave the directions of all its corners on their outer side. The
// straight prisms around a vertex do not meet but on their borders, layer by layer: seen along its
// direction all show their outer side, and they wind around it once, as those of a mesh must that
// does not cross itself (wound twice, one turn would have to be above the other and below it). So
// if all prisms are straight, and those without a common corner are apart, then no layer meets
// itself; moving outwards, each lies outside of those before, and the shell is embedded.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// At each vertex the shell reaches `outer` along the direction and `inner` against it.
struct OffsetShell {
  std::vector<Vec3d> direction;  ///< unit, outwards
  std::vector<double> outer, inner;

  Vec3d outer_place(const TriangleMesh& mesh, TriangleMesh::Index v) const {
    return mesh.positions[v] + outer[v] * direction[v];
  }
  Vec3d inner_place(const TriangleMesh& mesh, TriangleMesh::Index v) const {
    return mesh.positions[v] - inner[v] * direction[v];
  }
};

/// The corners of a triangle's prism, first the outer ones.
std::array<Vec3d, 6> prism_corners(const TriangleMesh& mesh, const OffsetShell& shell,
                                   std::size_t triangle);

/// Six vectors, not unit, between which lie all the normals of a prism's layers.
std::array<Vec3d, 6> layer_normals(const TriangleMesh& mesh, const OffsetShell& shell,
                                   std::size_t triangle);

/// By corner, whether all layers of the triangle's prism leave the direction of the corner on their
/// outer side. The prism is straight if they do so for all three.
std::array<bool, 3> leaves_directions_on_one_side(const TriangleMesh& mesh,
                                                  const OffsetShell& shell, std::size_t triangle);

/// Whether the hulls of the corners of two prisms are shown to have no point in common. False where
/// it could not be decided.
bool are_apart(const std::array<Vec3d, 6>& a, const std::array<Vec3d, 6>& b);

/// Of each triangle, whether its prism may meet another with which it shares no corner. O(n log n),
/// some microseconds a triangle.
std::vector<char> prisms_that_meet(const TriangleMesh& mesh, const OffsetShell& shell);

}  // namespace cs2mesh
