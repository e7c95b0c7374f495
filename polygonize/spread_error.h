// The vertices of a mesh moved along its surface, and edges flipped, so that its triangles are
// equally far from it.
//
// How far a triangle is from the surface is told by the normals at its corners (sagitta.h). What is
// made less, edge by edge and vertex by vertex, is the sum of a high power of that, so that those
// that are farthest count, and of what thin triangles cost. Over saddles, where a triangle is as
// far off as the farthest of its edges, that finds better places than making triangles equilateral
// does.
#pragma once

#include <span>
#include <vector>

#include "libfield/base/jet2.h"
#include "polygonize/editable_mesh.h"

namespace cs2mesh {

/// The cosine between two normals of a mesh from which the surface counts as smooth between them:
/// distances are told by normals well there.
inline constexpr double kSmooth = 0.9;

/// Of the edges, the part along which the surface is smooth; 1 if there are none. O(n).
double smooth_share(const EditableMesh& mesh, std::span<const Vec3d> normals);

/// What a vertex is told of the surface around it.
struct SpreadVertex {
  Symmetric3 shape;      ///< of the surface: its normal turns by shape t along t (shape_operator.h)
  double allowed = 1.0;  ///< how far triangles at it may be from the surface; scene units, > 0
  double lift = 0.0;     ///< as of distance_from(); that of a triangle is its corners' mean
};

/// The vertices of `mesh` are on a surface, with the unit normals `normals` there. Vertices and
/// normals are moved as far as these and the shapes tell, that is to the second order: the mesh is
/// to be brought to the surface afterwards. No triangle is turned away from the normals at its
/// corners that was not; where the surface is not smooth all stays as it is. A sweep is over all
/// edges and then all vertices, in their order, a flip or a step only where it makes the sum less;
/// O(n), some 40 distances of triangles a vertex.
void spread_error(EditableMesh& mesh, std::vector<Vec3d>& normals,
                  std::span<const SpreadVertex> vertices, int sweeps);

}  // namespace cs2mesh
