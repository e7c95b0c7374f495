#include "polygonize/spread_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/sagitta.h"
#include "polygonize/triangle_shape.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Of lengths: the shortest edge at a vertex, of which it goes so much to see what that does, and
/// so much at most.
constexpr double kLook = 0.06, kMostStep = 0.25;
constexpr double kLessEnough = 0.999;  ///< of costs, for an edge to be flipped
constexpr double kTurn = 0.2;          ///< least cosine between a triangle and its normals

/// A corner of a triangle, as it is or as it would be.
struct Corner {
  Vec3d p, n;
  double allowed, lift;
};

/// The distance of a triangle in parts of what is allowed, to the eighth power, and what it costs
/// beside that to be thin; infinite for one that is turned away. `rise_bc` is the sagitta from b to
/// c, which those who move a know.
double cost(const Corner& a, const Corner& b, const Corner& c, double rise_bc) {
  const Vec3d area = cross(b.p - a.p, c.p - a.p);
  const double least = kTurn * norm(area);
  if (!(dot(area, a.n) > least && dot(area, b.n) > least && dot(area, c.n) > least)) {
    return kInfinity;
  }
  const DeviationRange range =
      deviation_range(sagitta(a.p, a.n, b.p, b.n), rise_bc, sagitta(c.p, c.n, a.p, a.n));
  const double share = distance_from(range, (a.lift + b.lift + c.lift) / 3) /
                       std::min({a.allowed, b.allowed, c.allowed});
  const double squared = share * share, fourth = squared * squared;
  // Somewhat above the angle that is called thin, since costs give way to each other.
  constexpr double kThin = 20.0;
  static const double good = tangent_of(kThinAngle + 7);
  const double thin = std::max(1 - tangent_of_smallest_angle(a.p, b.p, c.p) / good, 0.0);
  return fourth * fourth + kThin * thin * thin;
}

bool is_smooth(const Corner& a, const Corner& b) {
  return dot(a.n, b.n) > kSmooth;
}

class Spreader {
 public:
  Spreader(EditableMesh& mesh, std::vector<Vec3d>& normals, std::span<const SpreadVertex> vertices)
      : mesh_(mesh), normals_(normals), vertices_(vertices) {}

  void flip_edges() {
    const std::size_t count = 3 * mesh_.mesh().triangles.size();
    for (HalfEdge h = 0; h < count; ++h) {
      if (!mesh_.alive(triangle_of(h)) || mesh_.opposite(h) < h) continue;
      if (should_flip(h)) mesh_.flip_edge(h);
    }
  }

  void move_vertices() {
    constexpr HalfEdge kNone = ~HalfEdge{0};
    std::vector<HalfEdge> from(normals_.size(), kNone);
    const std::size_t count = 3 * mesh_.mesh().triangles.size();
    for (HalfEdge h = 0; h < count; ++h) {
      if (mesh_.alive(triangle_of(h)) && from[start(h)] == kNone) from[start(h)] = h;
    }
    for (const HalfEdge h : from) {
      if (h != kNone && look_around(h)) move(start(h));
    }
  }

 private:
  Index start(HalfEdge h) const { return start_of(mesh_.mesh(), h); }
  Index end(HalfEdge h) const { return end_of(mesh_.mesh(), h); }
  Corner corner(Index v) const {
    return {mesh_.mesh().positions[v], normals_[v], vertices_[v].allowed, vertices_[v].lift};
  }

  // ---- Flipping ----

  bool should_flip(HalfEdge h) const {
    const HalfEdge back = mesh_.opposite(h);
    const Corner a = corner(start(h)), b = corner(end(h));
    const Corner c = corner(end(next_in_triangle(h))), d = corner(end(next_in_triangle(back)));
    if (!is_smooth(a, b) || !is_smooth(c, d) || !is_smooth(a, c) || !is_smooth(b, d)) return false;
    const double ab = sagitta(a.p, a.n, b.p, b.n), cd = sagitta(c.p, c.n, d.p, d.n);
    return cost(a, d, c, cd) + cost(b, c, d, cd) <
           kLessEnough * (cost(c, a, b, ab) + cost(d, b, a, ab));
  }

  // ---- Moving ----

  /// Takes in the triangles around the start of h; false if there are too many, or the
  /// surface is not smooth there.
  bool look_around(HalfEdge h) {
    count_ = 0;
    bool fits = true;
    mesh_.for_ring(h, [&](HalfEdge turn) {
      fits = fits && count_ < kMostValence;
      if (fits) around_[count_++] = corner(end(turn));
      fits = fits && is_smooth(corner(start(h)), around_[count_ - 1]);
    });
    for (std::size_t i = 0; i < count_; ++i) {
      const Corner &b = around_[i], &c = around_[after(i)];
      rise_[i] = sagitta(b.p, b.n, c.p, c.n);
    }
    return fits;
  }
  std::size_t after(std::size_t i) const { return i + 1 < count_ ? i + 1 : 0; }

  /// Of the triangles around, with that corner in their middle.
  double cost_with(const Corner& middle) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < count_; ++i) {
      sum += cost(middle, around_[i], around_[after(i)], rise_[i]);
    }
    return sum;
  }

  /// The vertex where it would be after a step along the surface.
  Corner moved(Index v, const Vec3d& step) const {
    Corner there = corner(v);
    const Vec3d turn = vertices_[v].shape * step;
    there.p += step - 0.5 * dot(step, turn) * there.n;
    there.n = normalized(there.n + turn);
    return there;
  }

  /// Moves a vertex by Newton's method, for either direction by itself, or less far.
  void move(Index v) {
    const Corner here = corner(v);
    const double now = cost_with(here);
    if (!(now < kInfinity)) return;
    double shortest = kInfinity;
    for (std::size_t i = 0; i < count_; ++i) {
      shortest = std::min(shortest, squared_norm(around_[i].p - here.p));
    }
    const double length = std::sqrt(shortest);
    const auto way = [&](const Vec3d& axis) {
      const double look = kLook * length;
      const double up = cost_with(moved(v, look * axis)), down = cost_with(moved(v, -look * axis));
      const double slope = up - down, bend = up - 2 * now + down;
      if (!(std::abs(slope) < kInfinity)) return 0.0;
      if (!(bend > 0)) return slope > 0 ? -look : look;
      return std::clamp(-0.5 * slope / bend * look, -kMostStep * length, kMostStep * length);
    };
    const Vec3d side = std::abs(here.n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d u = normalized(cross(here.n, side)), w = cross(here.n, u);
    const Vec3d step = way(u) * u + way(w) * w;
    for (const double share : {1.0, 0.4, 0.16}) {
      const Corner there = moved(v, share * step);
      if (!(cost_with(there) < now)) continue;
      mesh_.move_vertex(v, there.p);
      normals_[v] = there.n;
      return;
    }
  }

  EditableMesh& mesh_;
  std::vector<Vec3d>& normals_;
  std::span<const SpreadVertex> vertices_;
  /// Around the vertex that is to be moved: its neighbours, and the sagitta from each to the next.
  static constexpr std::size_t kMostValence = 24;
  std::size_t count_ = 0;
  std::array<Corner, kMostValence> around_{};
  std::array<double, kMostValence> rise_{};
};

}  // namespace

double smooth_share(const EditableMesh& mesh, std::span<const Vec3d> normals) {
  std::size_t smooth = 0, all = 0;
  for (HalfEdge h = 0; h < 3 * mesh.mesh().triangles.size(); ++h) {
    if (!mesh.alive(triangle_of(h))) continue;
    ++all;
    const Vec3d &a = normals[start_of(mesh.mesh(), h)], &b = normals[end_of(mesh.mesh(), h)];
    if (dot(a, b) > kSmooth) ++smooth;
  }
  return all > 0 ? static_cast<double>(smooth) / static_cast<double>(all) : 1.0;
}

void spread_error(EditableMesh& mesh, std::vector<Vec3d>& normals,
                  std::span<const SpreadVertex> vertices, int sweeps) {
  require(normals.size() == mesh.mesh().positions.size() && vertices.size() == normals.size(),
          "spread_error: one normal and one SpreadVertex a vertex");
  Spreader spreader(mesh, normals, vertices);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    spreader.flip_edges();
    spreader.move_vertices();
  }
  spreader.flip_edges();
}

}  // namespace cs2mesh
