// What remeshing may do to a mesh: which edges it may collapse and flip, and which triangles it may
// leave, by the normals at the vertices and how the surface bends there alone.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "polygonize/editable_mesh.h"
#include "polygonize/measured_triangle.h"
#include "polygonize/sagitta.h"
#include "polygonize/shape_operator.h"
#include "polygonize/triangle_shape.h"

namespace cs2mesh {

/// What is known of the surface at each vertex of a mesh.
struct SurfaceAtVertices {
  std::vector<Vec3d> normals;       ///< of length 1, outward
  std::vector<double> cells;        ///< the side of the octree's cell there; scene units
  std::vector<Symmetric3> shapes;   ///< how the surface bends (shape_operator.h)
  std::vector<BendMetric> metrics;  ///< the lengths that suit that
};

/// Looks at `mesh` and `at` as they are when it is asked; both outlive it. All is O(valence).
class RemeshRules {
 public:
  using Index = TriangleMesh::Index;

  static constexpr double kSlack = 1.6;  ///< times what collapsing aims at, while vertices move
  static constexpr double kFit = 0.86;   ///< of the tolerance, which collapsing aims at
  static constexpr double kTurn = 0.2;   ///< least cosine between a triangle and its normals

  /// `tolerance` in scene units, > 0; `balance` as RemeshOptions has it.
  RemeshRules(const EditableMesh& mesh, const SurfaceAtVertices& at, double tolerance, bool balance)
      : mesh_(mesh), at_(at), tolerance_(tolerance), balance_(balance) {}

  /// No angle below this, in degrees, is made of better ones.
  void set_sound_angle(double degrees) { sound_ = tangent_of(degrees); }

  /// The part of the tolerance that a triangle at v would have to be lifted by to be as far above
  /// the surface as below, as of distance_from(): over saddles it is so anyway.
  double lift(Index v) const {
    constexpr double kSteep = 4.0;
    return balance_ ? std::clamp(1 + kSteep * at_.metrics[v].ratio, 0.0, 1.0) : 0.0;
  }
  double sagitta_of(Index a, Index b) const {
    return sagitta(position(a), at_.normals[a], position(b), at_.normals[b]);
  }
  /// How far a triangle is from the surface; balanced, how far it would be if it were lifted.
  double deviation_of(Index a, Index b, Index c) const {
    return distance_from(deviation_range(sagitta_of(a, b), sagitta_of(b, c), sagitta_of(c, a)),
                         (lift(a) + lift(b) + lift(c)) / 3);
  }
  /// How far triangles at a vertex may be from the surface: where cells are small, other sheets may
  /// be near.
  double allowed(Index v, double slack = 1.0) const {
    constexpr double kCellShare = 0.5;
    return std::min(slack * kFit * tolerance_, kCellShare * at_.cells[v]);
  }
  /// Where the surface is smooth, moving spreads the error: triangles may be farther at first.
  double slack_of(Index a, Index b, Index c, double most) const;
  /// The squared length of an edge, 1 where it is what suits the curvature.
  double length_of(HalfEdge h) const {
    const Index a = start(h), b = end(h);
    const Vec3d edge = position(b) - position(a);
    const auto at = [&](Index v) {
      // Where the principal curvatures differ, a triangle is nearer than on a sphere of the
      // greater.
      const BendMetric& metric = at_.metrics[v];
      const double gain = 1 + (1 - std::max(metric.ratio, 0.0)) / 3;
      return dot(edge, metric.form * edge) / (6 * gain * (1 + lift(v)) * kFit * tolerance_);
    };
    return std::max(at(a), at(b));
  }

  /// Whether the triangles that stay around the start of h would be near the surface, face its way,
  /// and be shaped no worse than is tolerable or than they were.
  bool may_collapse(HalfEdge h, double slack) const;
  /// Whether the other diagonal is better: Delaunay, as the surface measures it, and no farther
  /// from the surface.
  bool should_flip(HalfEdge h) const;
  /// Whether a triangle should not be as it is, after its corners were moved from these points.
  bool is_worse(const std::array<Index, 3>& t, std::span<const Vec3d> points) const;

  /// A triangle, seen from a, as the surface measures it at its corners together.
  MeasuredTriangle measured(Index a, Index b, Index c) const {
    return measured(form_of(a, b, c), a, b, c);
  }

 private:
  struct Seen;

  const Vec3d& position(Index v) const { return mesh_.mesh().positions[v]; }
  Index start(HalfEdge h) const { return start_of(mesh_.mesh(), h); }
  Index end(HalfEdge h) const { return end_of(mesh_.mesh(), h); }
  Seen seen(Index a, Index b, Index c) const;
  bool faces_outward(const Seen& t) const;
  bool is_near(const Seen& t, Index gone, double most) const;
  Symmetric3 form_of(Index a, Index b, Index c) const {
    return at_.metrics[a].form + at_.metrics[b].form + at_.metrics[c].form;
  }
  MeasuredTriangle measured(const Symmetric3& form, Index a, Index b, Index c) const {
    return {form, position(b) - position(a), position(c) - position(a)};
  }
  double quality(Index a, Index b, Index c) const { return measured(a, b, c).quality(); }
  /// The tangent of the smallest angle.
  double angle_of(Index a, Index b, Index c) const {
    return tangent_of_smallest_angle(position(a), position(b), position(c));
  }

  const EditableMesh& mesh_;
  const SurfaceAtVertices& at_;
  double tolerance_;
  bool balance_;
  /// The tangent of the angle below which none is made of better ones.
  double sound_ = tangent_of(kThinAngle);
};

}  // namespace cs2mesh
