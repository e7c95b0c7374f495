// What of a mesh is proven to be the surface.
//
// Around the mesh lies a shell: every vertex v gets an outer place v + o and an inner one v - i,
// and with barycentric coordinates a triangle spans a prism of segments from its inner to its outer
// triangle. Proven of a triangle is:
//   distance: F < 0 on all of the outer triangle and F > 0 on the inner one, so that the surface
//     crosses each segment; o and i are no longer than the tolerance, so every point of the
//     triangle has surface that near;
//   fold: all over the prism F falls along all of its segments and along the normals of all the
//     triangles between inner and outer. So the surface crosses each segment once; and a layer that
//     moves from the mesh to the shell's outside or inside can touch neither the mesh nor itself,
//     for where it did, both sides would have -grad F on their outer side. The shell of a mesh that
//     does not cross itself is then embedded, the surface is a section of it, and the two are
//     isotopic by moving along the segments.
// No surface crosses the shell's boundary, so a component of the surface lies in the shell or has
// nothing to do with it. That there is none of the latter kind is for TopologyProof to say: space
// has no more regions than the mesh parts it in, but perhaps for what is in open leaves.
//
// The bounds are those of bent_triangle.h: a few values a triangle, and more where that leaves it
// open.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "libfield/base/progress.h"
#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/topology_proof.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Why something is not certified; its name() is a promise to scripts.
enum class Doubt : std::uint8_t {
  none,
  distance,  ///< the surface may be farther than the tolerance
  fold,      ///< it may cross the shell more than once, or the shell itself
  topology,  ///< there may be more of it in a cell, or around one, than the mesh has
  crease,    ///< it bends without bound, as at creases and jumps of strength profiles
};
std::string_view name(Doubt doubt);

struct UncertifiedPlace {
  Vec3d position;
  Doubt doubt = Doubt::none;
  double area = 0.0;  ///< of the mesh; 0 where it is a cell
  Aabb box;           ///< of the triangle or the cell
};

struct Certificate {
  double area = 0.0, certified_area = 0.0;  ///< of the mesh
  /// For each triangle; those that reach into an open leaf of the topology are in doubt as well.
  std::vector<Doubt> doubts;
  /// First the triangles in doubt, by number; then cells, in regions that the mesh does not account
  /// for, and open leaves that no triangle reaches into.
  std::vector<UncertifiedPlace> places;
  std::size_t values = 0, gradients = 0;  ///< evaluations; a jet is one of each
  std::size_t bounds = 0;                 ///< HullBounds asked for

  /// The certified part of the area, 0..1; 1 of an empty mesh.
  double share() const { return area > 0 ? certified_area / area : 1.0; }
};

struct CertifyOptions {
  double tolerance = 0.0;  ///< scene units, > 0
  Progress* progress = nullptr;
};

/// `topology` is a proof for this surface. The mesh is closed, oriented, 2-manifold and does not
/// cross itself (see check.h): that is taken for granted. Errors: Failure::interrupted. The same
/// certificate for any number of threads. Some 35 values and 25 gradients a triangle, of which 7
/// tell how thick the shell is to be.
///
/// Not promised: that what is in doubt is wrong. The proof is of the sum F itself, from which
/// evaluations differ by rounding and the field's error budget; gradients are taken to be good to
/// Tangent::kSlack; coordinates are those of the mesh, before a format rounds them.
Result<Certificate> certify(const ImplicitSurface& surface, const TriangleMesh& mesh,
                            const TopologyProof& topology, const CertifyOptions& options);

}  // namespace cs2mesh
