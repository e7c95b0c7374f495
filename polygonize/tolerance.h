// A mesh to a tolerance: a mesh on cells that suit the shape, refined where it is too far
// from the surface, measured, and made anew on smaller cells if need be.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "libfield/base/result.h"
#include "libfield/field/implicit_surface.h"
#include "polygonize/lattice_mesher.h"
#include "polygonize/mesher.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// How far a mesh is from its surface.
class DistanceEstimate {
 public:
  virtual ~DistanceEstimate() = default;
  /// An estimate of the largest distance, in scene units.
  virtual double largest_distance(const ImplicitSurface& surface,
                                  const TriangleMesh& mesh) const = 0;
};

/// Looks from the mesh at the surface: |F| / |grad F| at one point of every triangle, where a
/// triangle with its corners on a sphere is farthest from it, and at seven more where that is more
/// than `closer` and at all of triangles smaller than `small`; at the farthest of them the distance
/// proper. One gradient a triangle or a little more. Blind to pieces of surface that the mesh
/// misses. Distances up to `enough` count as that, so that no more needs to be known of them:
/// beside walls the first order says little. Cancelled, it tells of what it has seen.
class GradientEstimate final : public DistanceEstimate {
 public:
  explicit GradientEstimate(double closer = std::numeric_limits<double>::infinity(),
                            double small = 0.0, double enough = 0.0, Progress* progress = nullptr)
      : closer_(closer), small_(small), enough_(enough), progress_(progress) {}
  double largest_distance(const ImplicitSurface& surface, const TriangleMesh& mesh) const override;

 private:
  double closer_, small_, enough_;
  Progress* progress_;
};

/// A way to make few triangles of many.
class Coarsener {
 public:
  virtual ~Coarsener() = default;
  struct Coarse {
    TriangleMesh mesh;
    double error = 0.0;  ///< measured both ways, scene units; infinite where triangles cross
  };
  /// A mesh of the topology of `dense`, which is on cells of that side near the surface.
  virtual Coarse coarsen(const TriangleMesh& dense, double cell) = 0;
};

/// A way of meshing a surface on cells of one size; as mesh_lattice(), but that it may also fail
/// with Failure::check_failed, where the cell does not suit the surface.
using CellMesher = Result<TriangleMesh> (*)(const ImplicitSurface& surface,
                                            const LatticeOptions& options,
                                            LatticeStatistics* statistics);

struct ToleranceOptions {
  Vec3d origin{};  ///< a node of the lattice
  std::size_t max_nodes = 400'000'000;
  std::size_t max_triangles = 50'000'000;
  /// Lattices tried at most, and how many of them are left out, from the first on.
  int most_attempts = 4, left_out = 0;
  CellMesher mesh_cells = mesh_lattice;
  /// Whether those meshes have an edge along each crease, so that it does not limit the cell.
  bool follows_creases = false;
  /// Samples of the surface, found without the mesh, from which its lost pieces are looked for;
  /// there are nine times as many around those that are far.
  std::size_t surface_samples = 100'000;
  /// From the mesh at the surface; GradientEstimate if null.
  const DistanceEstimate* estimate = nullptr;
  /// If not null, meshes that nothing is missing from are coarsened, unless that leads too far from
  /// the surface.
  Coarsener* coarsener = nullptr;
  Progress* progress = nullptr;
};

struct ToleranceAttempt {
  double cell = 0.0;
  double error = 0.0;  ///< measured, scene units
  std::size_t triangles = 0;
};

struct ToleranceMesh {
  TriangleMesh mesh;
  double cell = 0.0;
  /// Measured, the larger of both ways, or 0.8 of the tolerance if that is more.
  double error = 0.0;
  bool reached = false;  ///< error <= tolerance
  std::vector<ToleranceAttempt> attempts;
  LatticeStatistics statistics;  ///< of the mesh returned
};

/// The warning of a mesher whose best mesh is that far from the surface; infinite where it is none.
Diagnostic tolerance_missed(double tolerance, double error, double cell);

/// The cell with which the lattice mesher is expected to stay within `tolerance` of a surface whose
/// smallest radius of curvature is `radius`, and to follow its shape: a triangle of circumradius c
/// with its corners on a sphere is c^2 / (2 radius) off, and cells of side h have triangles up to
/// about c = 0.77 h. With creases, which the lattice cuts off, the error is a share of the cell.
double expected_cell(double radius, bool creased, double tolerance);

/// Meshes `surface` so that no point of the mesh is farther than `tolerance` from it, as measured
/// by options.estimate. `thinnest_radius` is the smallest radius of its elements, > 0 (else
/// ContractViolation), in scene units.
///
/// The first cell is somewhat larger than a mesh on cells of the whole surface would need; refine()
/// makes up for that where it matters. Then the mesh is looked at from both sides, and where there
/// is surface too far from it, points of that are inserted, a few times. If that is not enough, all
/// is done again on a smaller cell. A mesh is taken when its estimate is within 0.96 of the
/// tolerance. If the tolerance is not reached, the mesh of the smallest error comes with a warning
/// of Failure::tolerance and reached == false. Errors: those of options.mesh_cells,
/// Failure::check_failed if that befalls every cell; but where a retry runs into a limit, the best
/// mesh before it is returned, with the limit's message as a warning.
Result<ToleranceMesh> mesh_to_tolerance(const ImplicitSurface& surface, double thinnest_radius,
                                        bool creased, double tolerance,
                                        const ToleranceOptions& options = {});

/// The same as meshers() are asked and answer (mesher.h); their limits replace those of `options`.
Result<MesherResult> mesh_on_cells(const ImplicitSurface& surface, const MesherRequest& request,
                                   ToleranceOptions options);
/// With the lattice mesher, on up to seven lattices: beside walls and kinks of F triangles cross
/// until cells are as small as what is between those, and there is no other way.
Result<MesherResult> mesh_by_lattice(const ImplicitSurface& surface, const MesherRequest& request);
/// What that asks of mesh_on_cells(), without the first `left_out` of the lattices.
ToleranceOptions many_lattices(int left_out = 0);

}  // namespace cs2mesh
