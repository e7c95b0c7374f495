// What of a mesh is proven to be the surface.
//
// Around the mesh lies a shell: every vertex v gets an outer place v + o and an inner one v - i,
// and with barycentric coordinates a triangle spans a prism of segments from its inner to its outer
// triangle. Proven of a triangle is:
//   distance: F < 0 on all of the outer triangle and F > 0 on the inner one, so that the surface
//     crosses each segment; o and i are no longer than the tolerance, so every point of the
//     triangle has surface that near;
//   fold: in the prism F grows inwards along its segments wherever it vanishes, so that the surface
//     crosses each of them once; and the prism meets no others, or if it may, then F falls all over
//     it along its segments and the normals of all of its layers. The shell of a mesh that does not
//     cross itself is then embedded (see offset_shell.h): layers that move outwards come to touch
//     only where their outer sides face each other, and that is not so where both have -grad F on
//     their outer side. The surface is a section of the shell, and the two are isotopic by moving
//     along the segments.
// Where that cannot be shown of a triangle, it is cut into parts that lie in it. They are the same
// set of points, but each new vertex has a direction and lengths of its own, so that the shell
// follows the surface more closely; what is proven of all parts is proven of the triangle.
//
// No surface crosses the shell's boundary, so a component of the surface lies in the shell or has
// nothing to do with it. That there is none of the latter kind is for TopologyProof to say: space
// has no more regions than the mesh parts it in, but perhaps for what is in open leaves.
//
// The bounds are those of bent_triangle.h: a few values a triangle, and more where that leaves it
// open. Where F has kinks they are those of its slopes: F is continuous and its one-sided slopes
// lie within bounds, which is all that the signs and the growth along segments need.
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
  crease,    ///< either, where it bends without bound, as at creases and corners of profiles
  profile,   ///< F may jump, as at jumps of strength profiles
};
std::string_view name(Doubt doubt);
/// Whether there may be none of parts of a triangle.
inline bool may_be_cut(Doubt doubt) {
  return doubt == Doubt::distance || doubt == Doubt::fold || doubt == Doubt::crease;
}

struct UncertifiedPlace {
  Vec3d position;
  Doubt doubt = Doubt::none;
  double area = 0.0;  ///< of what is in doubt of the triangle; 0 where it is a cell
  Aabb box;           ///< of that, or of the cell
};

struct Certificate {
  double area = 0.0, certified_area = 0.0;  ///< of the mesh; parts of triangles count
  /// For each triangle, the first doubt of its parts; those that reach into an open leaf of the
  /// topology are in doubt as well.
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
  /// certify_refined() cuts no more once that share is certified, nothing at all where no more than
  /// the share `hopeless` is, and else a few times and then in so many rounds at most.
  double enough = 1.0, hopeless = 0.0;
  /// It keeps the first cuts, and in the end all of them, if they leave less than this part of the
  /// area in doubt that was before.
  double worth = 1.0;
  int rounds = 16;
  Progress* progress = nullptr;
};

/// `topology` is a proof for this surface. The mesh is closed, oriented, 2-manifold and does not
/// cross itself (see check.h): that is taken for granted. Errors: Failure::interrupted. The same
/// certificate for any number of threads. Some 20 to 60 values and 10 to 30 gradients a triangle of
/// sums of Gaussians, of which 7 tell how thick the shell is to be; several times as many of other
/// kernels over lengths. Parts are looked at anew as long as that leaves less area in doubt, at
/// most four times as many as triangles and 10,000 more.
///
/// Not promised: that what is in doubt is wrong. The proof is of the sum F itself, from which
/// evaluations differ by rounding and the field's error budget; gradients are taken to be good to
/// Tangent::kSlack; coordinates are those of the mesh, before a format rounds them.
Result<Certificate> certify(const ImplicitSurface& surface, const TriangleMesh& mesh,
                            const TopologyProof& topology, const CertifyOptions& options);

/// As certify(), but where the distance or a fold is in doubt cuts triangles of the mesh through
/// the middle of their longest edges, and flips edges where triangles turn their back on the
/// surface; then looks again, as long as that leaves less area in doubt; at most to four times as
/// many triangles. Of those that stay what they are is not asked again. Vertices stay where they
/// are, new ones lie on the surface; the mesh stays closed, oriented and 2-manifold, and triangles
/// that are new do not cross others, also not when rounded to floats.
///
/// Not promised: that all is certified in the end. What is singular is not, as where sheets touch.
Result<Certificate> certify_refined(const ImplicitSurface& surface, TriangleMesh& mesh,
                                    const TopologyProof& topology, const CertifyOptions& options);

}  // namespace cs2mesh
