#include "polygonize/remesh_rules.h"

#include <cmath>
#include <utility>

#include "polygonize/spread_error.h"

namespace cs2mesh {

/// A triangle that is to be, with what several rules ask of it.
struct RemeshRules::Seen {
  Index a = 0, b = 0, c = 0;
  Vec3d area;  ///< twice, along its normal
  double length = 0.0;
};

RemeshRules::Seen RemeshRules::seen(Index a, Index b, Index c) const {
  const Vec3d area = cross(position(b) - position(a), position(c) - position(a));
  return {a, b, c, area, norm(area)};
}

bool RemeshRules::faces_outward(const Seen& t) const {
  const auto& n = at_.normals;
  const double most = kTurn * t.length;
  return dot(t.area, n[t.a]) > most && dot(t.area, n[t.b]) > most && dot(t.area, n[t.c]) > most;
}

double RemeshRules::slack_of(Index a, Index b, Index c, double most) const {
  constexpr double kRough = 0.6;
  const auto& n = at_.normals;
  const bool smooth =
      dot(n[a], n[b]) > kSmooth && dot(n[b], n[c]) > kSmooth && dot(n[c], n[a]) > kSmooth;
  return smooth ? most : std::min(most, kRough);
}

/// Whether a triangle is near the surface, and its plane passes within as much of a vertex that is
/// to go, along its normal.
bool RemeshRules::is_near(const Seen& t, Index gone, double most) const {
  const double slack = slack_of(t.a, t.b, t.c, most);
  const double least = std::min({allowed(t.a, slack), allowed(t.b, slack), allowed(t.c, slack)});
  if (!(deviation_of(t.a, t.b, t.c) <= least)) return false;
  const double height = dot(t.area, position(gone) - position(t.a));
  return std::abs(height) <= (1 + lift(gone)) * allowed(gone, slack) * t.length;
}

namespace {

/// The ends of the edges from a vertex, in their order around it.
class Ring {
 public:
  static constexpr std::size_t kMost = EditableMesh::kMostValence;
  Ring(const EditableMesh& mesh, HalfEdge h) {
    HalfEdge turn = h;
    do {
      if (size_ < kMost) ends_[size_] = end_of(mesh.mesh(), turn);
      ++size_;
      turn = mesh.opposite(before_in_triangle(turn));
    } while (turn != h);
  }
  std::size_t size() const { return size_; }
  TriangleMesh::Index operator[](std::size_t i) const { return ends_[i]; }

 private:
  std::array<TriangleMesh::Index, kMost> ends_;
  std::size_t size_ = 0;
};

}  // namespace

bool RemeshRules::may_collapse(HalfEdge h, double slack) const {
  constexpr double kShape = 0.35;
  const Index a = start(h), b = end(h);
  if (!(dot(at_.normals[a], at_.normals[b]) > kTurn)) return false;
  const Ring ring(mesh_, h);
  const std::size_t n = ring.size();
  // Of three neighbours one triangle would be left, which in grooves often crosses others.
  if (n <= 3 || n > Ring::kMost) return false;
  const auto worst_now = [&](const auto& of_triangle) {
    double worst = HUGE_VAL;
    for (std::size_t i = 0; i < n; ++i) {
      worst = std::min(worst, of_triangle(a, ring[i], ring[i + 1 < n ? i + 1 : 0]));
    }
    return worst;
  };
  const auto angle = [&](Index u, Index v, Index w) { return angle_of(u, v, w); };
  const auto shape = [&](Index u, Index v, Index w) { return quality(u, v, w); };
  // Bounds become those of the triangles there are once it matters how these are shaped.
  double least_angle = sound_, least_shape = kShape;
  bool angles_known = false, shapes_known = false;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const Seen t = seen(b, ring[i], ring[i + 1]);
    if (!faces_outward(t)) return false;
    const double thin = angle(t.a, t.b, t.c);
    if (thin < least_angle && !std::exchange(angles_known, true)) least_angle = worst_now(angle);
    if (thin < std::min(least_angle, sound_) || !is_near(t, a, slack)) return false;
    const double poor = shape(t.a, t.b, t.c);
    if (poor <= least_shape && !std::exchange(shapes_known, true)) least_shape = worst_now(shape);
    if (poor <= std::min(least_shape, kShape)) return false;
  }
  return mesh_.can_collapse(h);
}

bool RemeshRules::should_flip(HalfEdge h) const {
  const HalfEdge back = mesh_.opposite(h);
  const Index a = start(h), b = end(h);
  const Index c = end(next_in_triangle(h)), d = end(next_in_triangle(back));
  if (c == d) return false;
  const Symmetric3 form = form_of(a, b, c) + at_.metrics[d].form;
  const MeasuredTriangle one = measured(form, c, a, b), other = measured(form, d, b, a);
  if (!one.is_obtuse() && !other.is_obtuse()) return false;
  if (!(one.cotangent() + other.cotangent() < -1e-9)) return false;
  if (!faces_outward(seen(d, c, a)) || !faces_outward(seen(c, d, b))) return false;
  const double angle = std::min(angle_of(d, c, a), angle_of(c, d, b));
  if (angle < sound_ && angle < std::min(angle_of(a, b, c), angle_of(b, a, d))) return false;
  const double then = std::max(deviation_of(d, c, a), deviation_of(c, d, b));
  return !(then > kFit * tolerance_ &&
           then > std::max(deviation_of(a, b, c), deviation_of(b, a, d)));
}

bool RemeshRules::is_worse(const std::array<Index, 3>& t, std::span<const Vec3d> points) const {
  if (!faces_outward(seen(t[0], t[1], t[2]))) return true;
  if (deviation_of(t[0], t[1], t[2]) > slack_of(t[0], t[1], t[2], kSlack) * tolerance_) return true;
  const double angle = angle_of(t[0], t[1], t[2]);
  return angle < sound_ &&
         angle < tangent_of_smallest_angle(points[t[0]], points[t[1]], points[t[2]]);
}

}  // namespace cs2mesh
