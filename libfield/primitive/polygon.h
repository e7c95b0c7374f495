// The flat polygon, convex or not, without holes; its measure is its area.
#pragma once

#include <string_view>
#include <variant>
#include <vector>

#include "libfield/primitive/segment.h"
#include "libfield/primitive/triangle.h"

namespace cs2mesh {

/// What make_polygon() gives: planar to rounding, simple, of some area.
struct Polygon {
  std::vector<Vec3d> vertex;
  Vec3d normal;  ///< unit; counter-clockwise vertices see it point towards them
  /// Triangles that cover it without overlap, each counter-clockwise about the normal and of some
  /// area: one less than it has corners, at most.
  std::vector<Triangle> pieces;

  std::size_t size() const { return vertex.size(); }
  /// The edge from vertex i to the next.
  Segment edge(std::size_t i) const { return {vertex[i], vertex[(i + 1) % size()]}; }
};

/// Why there is no such polygon, and the vertex where that shows, or that ends the edge.
struct PolygonFault {
  std::string_view what;
  std::size_t vertex = 0;
};

/// Vertices may be in either order, and three of them on a line. They are moved into the plane of
/// the polygon, which none may miss by more than 1e-6 of the polygon's size. Faults: fewer than
/// three vertices, one like the next, no area, not planar, edges that meet.
/// The triangles are ears cut off in turn, that with the shortest diagonal first (Meisters 1975). A
/// few ms for 128 vertices, whose number enters with the third power at worst.
std::variant<Polygon, PolygonFault> make_polygon(std::vector<Vec3d> vertices);

/// Area.
double measure(const Polygon& polygon);
/// Centroid of the area.
Vec3d middle(const Polygon& polygon);
/// The smallest box.
Aabb bounds(const Polygon& polygon);
/// Whether the inner angle at vertex i is larger than 180 degrees.
bool is_reflex(const Polygon& polygon, std::size_t i);
/// Whether there is no such vertex.
bool is_convex(const Polygon& polygon);
/// Whether p lies in the prism over the polygon, where the nearest point is the projection;
/// elsewhere it is on the nearest edge.
bool is_above(const Polygon& polygon, const Vec3d& p);
Segment nearest_edge(const Polygon& polygon, const Vec3d& p);
/// The point of the polygon that is nearest to p: one of them where there are several.
Vec3d nearest_point(const Polygon& polygon, const Vec3d& p);

}  // namespace cs2mesh
