// How a surface bends around the vertices of a mesh on it, told by the normals there, and what
// length an edge has where lengths are measured by that.
#pragma once

#include <span>
#include <vector>

#include "libfield/base/jet2.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// For each vertex the shape operator S that fits its neighbours best: where the vertex goes along
/// the surface by t, its normal turns by S t. Symmetric, and zero along the normal; in 1 / scene
/// units, positive where the surface is convex. Normals are of length 1; triangles whose first two
/// corners are the same are left out. Zero for vertices without two neighbours in two directions.
/// Least squares over the edges, each divided by its length; exact for spheres up to the length of
/// edges squared. O(n).
std::vector<Symmetric3> shape_operators(const TriangleMesh& mesh, std::span<const Vec3d> normals);

/// How a surface bends at a point, as a quadratic form on edges.
struct BendMetric {
  /// |S|, with its lesser principal value raised to 1 / `stretch` of the greater, which it has
  /// along the normal too. e . form e is eight times what the surface rises above the middle of an
  /// edge e, or more.
  Symmetric3 form;
  /// The lesser principal curvature over the greater, in [-1, 1]; 0 where the surface is flat.
  double ratio = 0.0;
  /// The geometric mean of the two principal values of `form` along the surface.
  double density = 0.0;
};

/// `shape` has zero along `normal`, which is of length 1; stretch >= 1.
BendMetric bend_metric(const Symmetric3& shape, const Vec3d& normal, double stretch);

/// How many triangles it takes at least, or nearly, to stay within `tolerance` of the surface that
/// `mesh` is on, with corners on it: by how the normals of its triangles turn, which is less than
/// the surface does within one. Scene units, > 0. O(n).
double triangles_needed(const TriangleMesh& mesh, double tolerance);

}  // namespace cs2mesh
