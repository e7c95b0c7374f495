#include "libfield/primitive/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libfield/primitive/nearest_point.h"

namespace cs2mesh {
namespace {

/// Half the sum of cross products, from the first vertex: normal times area (Newell).
Vec3d vector_area(const std::vector<Vec3d>& vertex) {
  Vec3d sum;
  for (std::size_t i = 2; i < vertex.size(); ++i) {
    sum += cross(vertex[i - 1] - vertex[0], vertex[i] - vertex[0]);
  }
  return 0.5 * sum;
}

/// Twice the signed area of a, b, c as seen from the tip of the normal.
double turn(const Vec3d& normal, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return dot(normal, cross(b - a, c - a));
}

/// Whether p, on the line through a and b, lies between them.
bool is_between(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
  return dot(p - a, p - b) <= 0;
}

/// Whether two segments of the plane have a point in common.
bool meet(const Vec3d& normal, const Segment& s, const Segment& t) {
  const double sa = turn(normal, t.a, t.b, s.a), sb = turn(normal, t.a, t.b, s.b);
  const double ta = turn(normal, s.a, s.b, t.a), tb = turn(normal, s.a, s.b, t.b);
  if (sa * sb < 0 && ta * tb < 0) return true;
  return (sa == 0 && is_between(t.a, t.b, s.a)) || (sb == 0 && is_between(t.a, t.b, s.b)) ||
         (ta == 0 && is_between(s.a, s.b, t.a)) || (tb == 0 && is_between(s.a, s.b, t.b));
}

/// The first vertex whose edge to the next meets an earlier one elsewhere than at a common end;
/// the number of vertices if there is none.
std::size_t first_crossing(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 1; i < n; ++i) {
    const Segment edge = polygon.edge(i);
    const Vec3d& before = polygon.vertex[i - 1];
    const bool folds_back = turn(polygon.normal, before, edge.a, edge.b) == 0 &&
                            dot(before - edge.a, edge.b - edge.a) > 0;
    if (folds_back) return i;
    for (std::size_t j = 0; j + 1 < i; ++j) {
      if (i + 1 == n && j == 0) continue;  // neighbours as well
      if (meet(polygon.normal, edge, polygon.edge(j))) return i;
    }
  }
  return n;
}

/// Whether the triangle of a corner and its neighbours holds no other vertex of those left.
bool is_ear(const Vec3d& normal, const std::vector<Vec3d>& left, std::size_t i) {
  const std::size_t n = left.size();
  const Vec3d& a = left[(i + n - 1) % n];
  const Vec3d& b = left[i];
  const Vec3d& c = left[(i + 1) % n];
  if (!(turn(normal, a, b, c) > 0)) return false;
  return std::none_of(left.begin(), left.end(), [&](const Vec3d& p) {
    return p != a && p != b && p != c && turn(normal, a, b, p) >= 0 && turn(normal, b, c, p) >= 0 &&
           turn(normal, c, a, p) >= 0;
  });
}

/// False if ears ran out early, which rounding alone can do to a simple polygon.
bool cut_ears(Polygon& polygon) {
  std::vector<Vec3d> left = polygon.vertex;
  while (left.size() > 2) {
    const std::size_t n = left.size();
    std::size_t best = n;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3d& before = left[(i + n - 1) % n];
      const Vec3d& after = left[(i + 1) % n];
      const double length = squared_norm(after - before);
      if (length < shortest && is_ear(polygon.normal, left, i)) {
        best = i;
        shortest = length;
      }
    }
    if (best == n) {
      // What is left has no area: its vertices are on a line.
      return norm(vector_area(left)) <= 1e-12 * measure(polygon);
    }
    const Triangle ear{{left[(best + n - 1) % n], left[best], left[(best + 1) % n]}};
    if (measure(ear) > 1e-14 * measure(polygon)) polygon.pieces.push_back(ear);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return true;
}

}  // namespace

std::variant<Polygon, PolygonFault> make_polygon(std::vector<Vec3d> vertices) {
  const std::size_t n = vertices.size();
  if (n < 3) return PolygonFault{"fewer than three vertices", 0};
  for (std::size_t i = 0; i < n; ++i) {
    if (vertices[i] == vertices[(i + n - 1) % n]) {
      return PolygonFault{"a vertex like the one before it", i == 0 ? n - 1 : i};
    }
  }
  Polygon polygon;
  polygon.vertex = std::move(vertices);
  const double size = bounds(polygon).diagonal();
  const Vec3d area = vector_area(polygon.vertex);
  if (!(norm(area) > 1e-12 * size * size)) return PolygonFault{"a polygon without area", 0};
  polygon.normal = normalized(area);

  // Into the plane through the mean of the vertices.
  Vec3d mean;
  for (const Vec3d& v : polygon.vertex) mean += (v - polygon.vertex[0]) / static_cast<double>(n);
  mean += polygon.vertex[0];
  for (std::size_t i = 0; i < n; ++i) {
    const double height = dot(polygon.vertex[i] - mean, polygon.normal);
    if (!(std::abs(height) <= 1e-6 * size)) {
      return PolygonFault{"a vertex off the plane of the others", i};
    }
    if (std::abs(height) > 1e-14 * size) polygon.vertex[i] -= height * polygon.normal;
  }
  const std::size_t crossing = first_crossing(polygon);
  if (crossing < n) return PolygonFault{"edges that meet", (crossing + 1) % n};
  if (!cut_ears(polygon)) return PolygonFault{"edges that nearly meet", 0};
  return polygon;
}

double measure(const Polygon& polygon) {
  return norm(vector_area(polygon.vertex));
}

Vec3d middle(const Polygon& polygon) {
  const Vec3d& origin = polygon.vertex[0];
  Vec3d sum;
  double area = 0;
  for (const Triangle& piece : polygon.pieces) {
    sum += measure(piece) * (middle(piece) - origin);
    area += measure(piece);
  }
  return origin + sum / area;
}

Aabb bounds(const Polygon& polygon) {
  Aabb box;
  for (const Vec3d& vertex : polygon.vertex) box.include(vertex);
  return box;
}

bool is_reflex(const Polygon& polygon, std::size_t i) {
  const std::size_t n = polygon.size();
  return turn(polygon.normal, polygon.vertex[(i + n - 1) % n], polygon.vertex[i],
              polygon.vertex[(i + 1) % n]) < 0;
}

bool is_convex(const Polygon& polygon) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (is_reflex(polygon, i)) return false;
  }
  return true;
}

/// The number of edges that a ray in the plane crosses on its way out is odd.
bool is_above(const Polygon& polygon, const Vec3d& p) {
  const Vec3d x = reference_axis(polygon.normal);
  const Vec3d y = cross(polygon.normal, x);
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Segment edge = polygon.edge(i);
    const double ya = dot(edge.a - p, y), yb = dot(edge.b - p, y);
    if ((ya > 0) == (yb > 0)) continue;
    const double xa = dot(edge.a - p, x), xb = dot(edge.b - p, x);
    if (xa + (xb - xa) * (ya / (ya - yb)) > 0) inside = !inside;
  }
  return inside;
}

Segment nearest_edge(const Polygon& polygon, const Vec3d& p) {
  Segment best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Segment edge = polygon.edge(i);
    const double squared = squared_norm(nearest_point(edge, p) - p);
    if (squared < least) {
      least = squared;
      best = edge;
    }
  }
  return best;
}

Vec3d nearest_point(const Polygon& polygon, const Vec3d& p) {
  if (!is_above(polygon, p)) return nearest_point(nearest_edge(polygon, p), p);
  return p - dot(p - polygon.vertex[0], polygon.normal) * polygon.normal;
}

}  // namespace cs2mesh
