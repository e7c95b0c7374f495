// The promises of a mesh, as code: checks ordered from cheap to slow, each defect with its place.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libfield/base/progress.h"
#include "polygonize/triangle_mesh.h"
#include "polygonize/triangle_shape.h"

namespace cs2mesh {

enum class DefectKind {
  index_out_of_range,        ///< a triangle names a vertex that is not there
  not_finite,                ///< a vertex with a coordinate that is not a finite number
  duplicate_vertex,          ///< equal coordinates, another index
  degenerate_triangle,       ///< of area exactly zero
  open_edge,                 ///< with one triangle
  nonmanifold_edge,          ///< with more than two triangles
  inconsistent_orientation,  ///< two triangles run along an edge in the same direction
  nonmanifold_vertex,        ///< whose triangles are more than one fan
  inward_component,          ///< an outer component wound inwards
  self_intersection,         ///< two triangles meet where they must not
};
inline constexpr std::size_t kDefectKinds = 10;

/// Words for people, in the singular: "open edge".
std::string_view name(DefectKind kind);

struct Defect {
  DefectKind kind{};
  Vec3d where;  ///< a vertex, the middle of an edge, or the centroid of the (first) triangle
  /// The triangles concerned; for a vertex without one, none.
  std::vector<TriangleMesh::Index> triangles;
};

struct CheckOptions {
  bool self_intersections = true;
  std::size_t max_defects = 1000;  ///< listed of each kind; all are counted
  Progress* progress = nullptr;    ///< if cancelled, self-intersections are left unchecked
};

struct MeshReport {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t components = 0;  ///< connected through edges
  std::size_t voids = 0;       ///< components wound inwards, inside another (by their boxes)
  /// Of the closed components together; each is (2 - V + E - F) / 2.
  long long genus = 0;
  bool closed = false;  ///< no open edge
  bool manifold_edges = false;
  bool manifold_vertices = false;
  bool oriented = false;
  bool outward = false;
  /// Absent if not checked: no CGAL in the build, not asked for, cancelled, or impossible because
  /// of indices out of range or coordinates not finite.
  std::optional<std::size_t> self_intersections;
  double area = 0.0;
  double volume = 0.0;
  TriangleShapes shapes;
  std::array<std::size_t, kDefectKinds> counts{};
  std::vector<Defect> defects;

  std::size_t count(DefectKind kind) const { return counts[static_cast<std::size_t>(kind)]; }
  /// No defect found. (Whether self-intersections were looked for is for the caller to ask.)
  bool ok() const;
};

/// Looks at everything; throws for no mesh, however broken. Triangles with an index out of range
/// are left out of all later checks. O(n) but for the self-intersections, see
/// find_self_intersections().
MeshReport check(const TriangleMesh& mesh, const CheckOptions& options = {});

struct PartReport {
  std::string name;
  MeshReport report;
};

/// Each part by itself: parts may intersect one another.
std::vector<PartReport> check(const Model& model, const CheckOptions& options = {});

/// The mesh as a file of 32-bit floats would hold it. Vertices are rounded, not merged.
TriangleMesh rounded_to_float(const TriangleMesh& mesh);

/// Whether the triangle's area is exactly zero: decided without rounding error (barring overflow
/// and underflow of products of coordinates).
bool is_degenerate(const Vec3d& a, const Vec3d& b, const Vec3d& c);

}  // namespace cs2mesh
