#include "polygonize/improve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <unordered_set>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/closest_point.h"
#include "polygonize/editable_mesh.h"
#include "polygonize/far_triangles.h"
#include "polygonize/fold.h"
#include "polygonize/sagitta.h"
#include "polygonize/shape_operator.h"
#include "polygonize/triangle_sample.h"
#include "polygonize/triangle_set.h"
#include "polygonize/triangle_shape.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// The least cosine between a triangle and the surface at its corners.
constexpr double kTurn = 0.3;
/// What is not worth measuring, in tolerances, by normals.
constexpr double kHopeless = 1.3;

enum class Kind : std::uint8_t { collapse, flip, move };

/// A change to the mesh, and the triangles that it makes: those from `first` on.
struct Proposal {
  Kind kind{};
  HalfEdge edge = 0;
  Index place = 0;  ///< where a moved vertex would be: a number beyond those of the mesh
  std::size_t first = 0, count = 0;
};

class Improver {
 public:
  Improver(const ImplicitSurface& surface, TriangleMesh mesh, const ImproveOptions& options)
      : surface_(surface), options_(options), mesh_(std::move(mesh)) {
    look_at_vertices();
  }

  void run() {
    constexpr double kFew = 0.0002;  // of the triangles
    const auto count = static_cast<double>(mesh_.mesh().triangles.size());
    for (int round = 0; round < options_.most_rounds; ++round) {
      propose_for_all_thin();
      propose_collapses();
      if (static_cast<double>(carry_out(round)) < kFew * count) break;
    }
    for (int round = 0; round < options_.most_rounds; ++round) {
      propose_for_all_thin();
      if (carry_out(round) == 0) break;
    }
  }
  TriangleMesh take() { return mesh_.take(); }

  ImproveStatistics statistics;

 private:
  using Triangle = std::array<Index, 3>;
  /// The tangent of the angle below which none is made of better ones.
  const double sound_ = tangent_of(kThinAngle + 0.5);
  const Vec3d& position(Index v) const { return positions_[v]; }
  Index start(HalfEdge h) const { return start_of(mesh_.mesh(), h); }
  Index end(HalfEdge h) const { return end_of(mesh_.mesh(), h); }
  /// The tangent of the smallest angle.
  double angle_of(const Triangle& t) const {
    return tangent_of_smallest_angle(position(t[0]), position(t[1]), position(t[2]));
  }

  /// The normal of the surface at each vertex, and its foot there.
  void look_at_vertices() {
    positions_ = mesh_.mesh().positions;
    normals_.resize(positions_.size());
    feet_.resize(positions_.size());
    changed_.assign(positions_.size(), true);
    std::vector<Index> all(positions_.size());
    std::iota(all.begin(), all.end(), Index{0});
    look_at(all);
  }
  void look_at(std::span<const Index> vertices) {
    for_each_neighbourhood(vertices.size(), [&](std::size_t first, std::size_t last) {
      std::vector<Vec3d> points;
      for (std::size_t i = first; i < last; ++i) points.push_back(position(vertices[i]));
      const std::vector<Jet> jets = jets_at_neighbours(surface_, points);
      for (std::size_t i = first; i < last; ++i) {
        const Jet& jet = jets[i - first];
        const double slope = norm_of_any(jet.gradient);
        const Vec3d normal = slope > 0 ? -1.0 / slope * jet.gradient : Vec3d{};
        normals_[vertices[i]] = normal;
        feet_[vertices[i]] = points[i - first];
        if (slope > 0) feet_[vertices[i]] += leveled(jet.value) / slope * normal;
      }
    });
  }

  // ---- What could be better ----

  /// Changes that look promising, no two of which touch the same vertex: what thin triangles need.
  void propose_for_all_thin() {
    proposals_.clear();
    made_.clear();
    touched_.assign(mesh_.mesh().positions.size(), false);
    // Without the places of the last round.
    positions_.resize(touched_.size());
    normals_.resize(touched_.size());
    feet_.resize(touched_.size());
    shapes_ = shape_operators(mesh_.mesh(), normals_);
    const std::size_t count = mesh_.mesh().triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      if (mesh_.alive(t) && angle_of(mesh_.mesh().triangles[t]) < sound_) propose_for_thin(t);
    }
  }

  void propose_for_thin(std::size_t triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto h = static_cast<HalfEdge>(3 * triangle + k), back = mesh_.opposite(h);
      if (propose_collapse(h, least_turn(h)) || propose_collapse(back, least_turn(back)) ||
          propose_flip(h)) {
        return;
      }
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (propose_move(static_cast<HalfEdge>(3 * triangle + k))) return;
    }
  }

  /// Whether this was tried before in vain, at the same ends.
  bool refused(Kind kind, HalfEdge h) const { return refused_.contains(key(kind, h)); }
  std::uint64_t key(Kind kind, HalfEdge h) const {
    const std::uint64_t ends = (std::uint64_t{start(h)} << 32U) | end(h);
    return 4 * ends + static_cast<std::uint64_t>(kind);
  }

  /// The cosine between triangles that replace those around the start of h and the surface: in a
  /// groove, where normals at the corners of one are far apart, no worse than it was.
  double least_turn(HalfEdge h) const {
    double least = kTurn;
    mesh_.for_ring(h, [&](HalfEdge turn) {
      least = std::min(least, facing(mesh_.mesh().triangles[triangle_of(turn)]));
    });
    return least;
  }
  /// The least cosine between a triangle and the normals at its corners.
  double facing(const Triangle& t) const {
    const Vec3d area = area_of(t);
    double least = 1.0;
    for (const Index v : t) least = std::min(least, dot(area, normals_[v]) / norm(area));
    return least;
  }
  Vec3d area_of(const Triangle& t) const {
    return cross(position(t[1]) - position(t[0]), position(t[2]) - position(t[0]));
  }

  /// Of all edges but those that could not be collapsed before, nothing about which has changed.
  void propose_collapses() {
    hopeless_.resize(3 * mesh_.mesh().triangles.size(), false);
    find_stale();
    for (HalfEdge h = 0; h < hopeless_.size(); ++h) {
      if (!mesh_.alive(triangle_of(h)) || (hopeless_[h] && !stale_[start(h)])) continue;
      hopeless_[h] = !propose_collapse(h, kTurn) && !blocked_;
    }
  }

  /// Vertices of changed triangles, and their neighbours, whose edges may be collapsed for all that
  /// is known.
  void find_stale() {
    stale_.assign(positions_.size(), false);
    for (std::size_t t = 0; t < mesh_.mesh().triangles.size(); ++t) {
      if (!mesh_.alive(t)) continue;
      const Triangle& corners = mesh_.mesh().triangles[t];
      const auto changed = [this](Index v) { return changed_[v]; };
      if (std::none_of(corners.begin(), corners.end(), changed)) continue;
      for (const Index v : corners) stale_[v] = true;
    }
    changed_.assign(positions_.size(), false);
  }

  /// Takes out the start of h, so that triangles are of that cosine with the surface at least.
  bool propose_collapse(HalfEdge h, double turn_least) {
    const Index a = start(h), b = end(h);
    blocked_ = touched_[a] || touched_[b];
    if (blocked_ || refused(Kind::collapse, h)) return false;
    const HalfEdge back = mesh_.opposite(h);
    const std::size_t first = made_.size();
    double now = sound_, then = sound_;
    bool fits = true;
    mesh_.for_ring(h, [&](HalfEdge turn) {
      if (!fits) return;
      const Triangle old{a, end(turn), end(next_in_triangle(turn))};
      now = std::min(now, angle_of(old));
      if (turn == h || triangle_of(turn) == triangle_of(back)) return;
      const Triangle made{b, old[1], old[2]};
      blocked_ = blocked_ || touched_[old[1]] || touched_[old[2]];
      fits = !blocked_ && follows(made, turn_least, area_of(old));
      then = std::min(then, angle_of(made));
      made_.push_back(made);
    });
    if (!fits || (then < sound_ && then <= now) || !mesh_.can_collapse(h) ||
        !covers(std::span(made_).subspan(first), h)) {
      made_.resize(first);
      return false;
    }
    add(Kind::collapse, h, first);
    return true;
  }

  bool propose_flip(HalfEdge h) {
    const HalfEdge back = mesh_.opposite(h);
    const Index a = start(h), b = end(h);
    const Index c = end(next_in_triangle(h)), d = end(next_in_triangle(back));
    if (touched_[a] || touched_[b] || touched_[c] || touched_[d]) return false;
    if (refused(Kind::flip, h)) return false;
    const Triangle one{d, c, a}, other{c, d, b};
    const double now = std::min(angle_of({a, b, c}), angle_of({b, a, d}));
    const double then = std::min(angle_of(one), angle_of(other));
    if (!(then > now)) return false;
    const Triangle here{a, b, c}, there{b, a, d};
    const double least = std::min({kTurn, facing(here), facing(there)});
    const Vec3d area = area_of(here) + area_of(there);
    if (!follows(one, least, area) || !follows(other, least, area) || !mesh_.can_flip(h)) {
      return false;
    }
    const std::size_t first = made_.size();
    made_.push_back(one);
    made_.push_back(other);
    add(Kind::flip, h, first);
    return true;
  }

  /// Moves the start of h to the best of some places about it: on the way to the mean of its
  /// neighbours, and all around.
  bool propose_move(HalfEdge h) {
    const Index v = start(h);
    if (touched_[v] || refused(Kind::move, h)) return false;
    Vec3d sum{};
    double count = 0, now = sound_, shortest = HUGE_VAL;
    bool free = true;
    mesh_.for_ring(h, [&](HalfEdge turn) {
      const Vec3d way = position(end(turn)) - position(v);
      free = free && !touched_[end(turn)];
      sum += way;
      count += 1;
      shortest = std::min(shortest, norm(way));
      now = std::min(now, angle_of({v, end(turn), end(next_in_triangle(turn))}));
    });
    if (!free) return false;
    const double least = least_turn(h);
    std::optional<Vec3d> best;
    for (const Vec3d& way : ways_from(v, sum / count, shortest)) {
      const Index place = add_place(v, way);
      double then = sound_;
      mesh_.for_ring(h, [&](HalfEdge turn) {
        if (!(then > now)) return;
        const Index b = end(turn), c = end(next_in_triangle(turn));
        const Triangle made{place, b, c};
        then = follows(made, least, area_of({v, b, c})) ? std::min(then, angle_of(made)) : 0.0;
      });
      if (then > now) {
        now = then;
        best = way;
      }
      positions_.pop_back(), normals_.pop_back(), feet_.pop_back();
    }
    if (!best) return false;
    const Index place = add_place(v, *best);
    const std::size_t first = made_.size();
    mesh_.for_ring(h, [&](HalfEdge turn) {
      made_.push_back({place, end(turn), end(next_in_triangle(turn))});
    });
    add(Kind::move, h, first);
    proposals_.back().place = place;
    return true;
  }

  /// Ways along the surface that a vertex may go by.
  std::vector<Vec3d> ways_from(Index v, const Vec3d& to_mean, double shortest) const {
    constexpr int kDirections = 12;
    std::vector<Vec3d> ways;
    for (const double share : {0.8, 0.4, 0.2}) ways.push_back(share * to_mean);
    const Vec3d& n = normals_[v];
    const Vec3d side = std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d u = normalized(cross(n, side)), w = cross(n, u);
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2 * std::numbers::pi * i / kDirections;
      const Vec3d direction = std::cos(angle) * u + std::sin(angle) * w;
      for (const double share : {0.5, 0.25, 0.1}) ways.push_back(share * shortest * direction);
    }
    return ways;
  }

  /// Where a vertex would be that goes along the surface by the part of `way` that does, no farther
  /// from the surface than it is.
  Index add_place(Index v, const Vec3d& way) {
    const Vec3d step = way - dot(way, normals_[v]) * normals_[v];
    const Vec3d turn = shapes_[v] * step;
    const Vec3d along = step - 0.5 * dot(step, turn) * normals_[v];
    positions_.push_back(positions_[v] + along);
    normals_.push_back(normalized(normals_[v] + turn));
    feet_.push_back(feet_[v] + along);
    return static_cast<Index>(positions_.size() - 1);
  }

  void add(Kind kind, HalfEdge h, std::size_t first) {
    proposals_.push_back({kind, h, {}, first, made_.size() - first});
    touched_[start(h)] = true;
    for (std::size_t i = first; i < made_.size(); ++i) {
      for (const Index v : made_[i]) {
        if (v < touched_.size()) touched_[v] = true;
      }
    }
  }

  /// Whether a triangle faces the way of the surface at its corners, by that cosine at least, and
  /// could be near it. Where normals tell little, it is to face the way of what it replaces.
  bool follows(const Triangle& t, double least, const Vec3d& replaced) const {
    const auto [a, b, c] = t;
    if (least < kTurn) {
      const Vec3d area = area_of(t);
      return facing(t) >= least && dot(area, replaced) > kTurn * norm(area) * norm(replaced);
    }
    if (!faces_normals(positions_, normals_, t, kTurn)) return false;
    const auto [low, high] = deviation_range(rise(a, b), rise(b, c), rise(c, a));
    return 0.5 * (high - low) <= kHopeless * options_.tolerance;
  }

  /// Of the surface above the chord between its feet at two vertices.
  double rise(Index v, Index w) const {
    return sagitta(feet_[v], normals_[v], feet_[w], normals_[w]);
  }

  /// Whether these triangles are near the surface around the start of h, as the normals tell it: at
  /// the vertex itself, half way to its neighbours and in the middle of its triangles.
  bool covers(std::span<const Triangle> made, HalfEdge h) const {
    constexpr double kShare = 0.92;  // of the tolerance, as there is surface between those points
    const Index a = start(h);
    const double most = kShare * options_.tolerance;
    const auto near = [&](const Vec3d& p) {
      return std::any_of(made.begin(), made.end(), [&](const Triangle& t) {
        const Vec3d q = nearest_on_triangle(position(t[0]), position(t[1]), position(t[2]), p);
        return squared_norm(p - q) <= most * most;
      });
    };
    bool all = near(feet_[a]);
    mesh_.for_ring(h, [&](HalfEdge turn) {
      if (!all) return;
      const Index b = end(turn), c = end(next_in_triangle(turn));
      const double ab = rise(a, b), bc = rise(b, c), ca = rise(c, a);
      const Vec3d n = normals_[a] + normals_[b] + normals_[c];
      const Vec3d half = 0.5 * (feet_[a] + feet_[b]);
      const Vec3d middle = (feet_[a] + feet_[b] + feet_[c]) / 3.0;
      all = near(half + (ab / norm(normals_[a] + normals_[b])) * (normals_[a] + normals_[b])) &&
            near(middle + (4.0 / 9 * (ab + bc + ca) / norm(n)) * n);
    });
    return all;
  }

  // ---- What is ----

  /// Carries out the proposals none of whose triangles is too far; returns how many.
  std::size_t carry_out(int round) {
    if (cancelled(options_.progress)) return 0;
    if (options_.progress != nullptr) {
      options_.progress->report("improve", static_cast<double>(round) / options_.most_rounds);
    }
    TriangleMesh proposed;
    proposed.positions = positions_;
    proposed.triangles = made_;
    std::vector<std::size_t> all(made_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::vector<char> far(made_.size(), 0);
    FarOptions far_options{options_.tolerance, options_.small, 100 * options_.tolerance};
    if (surface_.has_cheap_hull_bounds()) far_options.directions = normals_;
    for_each_neighbourhood(all.size(), [&](std::size_t first, std::size_t last) {
      const auto some = std::span(all).subspan(first, last - first);
      for (const LostPoint& lost : far_triangles(surface_, proposed, some, far_options)) {
        far[lost.triangle] = 1;
      }
    });
    std::size_t changed = 0;
    std::vector<Index> moved;
    for (const Proposal& proposal : proposals_) {
      const auto first = far.begin() + static_cast<std::ptrdiff_t>(proposal.first);
      const auto last = first + static_cast<std::ptrdiff_t>(proposal.count);
      if (std::find(first, last, 1) != last) {
        refused_.insert(key(proposal.kind, proposal.edge));
        ++statistics.refused;
      } else if (carry_out(proposal)) {
        ++changed;
        note_changes(proposal);
        if (proposal.kind == Kind::move) {
          moved.push_back(start(proposal.edge));
          continue;
        }
        for (std::size_t i = 0; i < proposal.count; ++i) {
          statistics.near.push_back(triangle_key(proposed, proposal.first + i));
        }
      }
    }
    bring_back(moved);
    return changed;
  }

  void note_changes(const Proposal& proposal) {
    if (proposal.kind == Kind::move) changed_[start(proposal.edge)] = true;
    for (std::size_t i = proposal.first; i < proposal.first + proposal.count; ++i) {
      for (const Index v : made_[i]) {
        if (v < changed_.size()) changed_[v] = true;
      }
    }
  }

  /// Vertices that were moved, to the height above the surface that they had.
  void bring_back(std::span<const Index> moved) {
    std::vector<double> height;
    for (const Index v : moved) height.push_back(dot(position(v) - feet_[v], normals_[v]));
    look_at(moved);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const Index v = moved[i];
      positions_[v] = feet_[v] + height[i] * normals_[v];
      mesh_.move_vertex(v, positions_[v]);
    }
  }

  bool carry_out(const Proposal& proposal) {
    if (proposal.kind == Kind::move) {
      const Index v = start(proposal.edge);
      positions_[v] = positions_[proposal.place];
      normals_[v] = normals_[proposal.place];
      feet_[v] = feet_[proposal.place];
      ++statistics.moves;
      return true;
    }
    if (proposal.kind == Kind::flip) {
      if (!mesh_.flip_edge(proposal.edge)) return false;
      ++statistics.flips;
      return true;
    }
    // A neighbour's change may have taken the edges that hold it.
    if (!mesh_.can_collapse(proposal.edge)) return false;
    mesh_.collapse_edge(proposal.edge);
    ++statistics.collapses;
    return true;
  }

  const ImplicitSurface& surface_;
  const ImproveOptions& options_;
  EditableMesh mesh_;
  /// For each vertex, and then for each place that one may move to: it, and of the surface there
  /// the normal and the foot.
  std::vector<Vec3d> positions_, normals_, feet_;
  std::vector<Symmetric3> shapes_;
  std::vector<Proposal> proposals_;
  std::vector<Triangle> made_;  ///< by the proposals
  std::vector<bool> touched_;   ///< vertices
  bool blocked_ = false;        ///< whether a proposal failed as something else was proposed nearby
  /// Half-edges that cannot be collapsed as long as nothing changes about their starts; vertices
  /// about which something has, and vertices of triangles that have changed since.
  std::vector<bool> hopeless_, stale_, changed_;
  std::unordered_set<std::uint64_t> refused_;
};

}  // namespace

TriangleMesh improve(const ImplicitSurface& surface, TriangleMesh mesh,
                     const ImproveOptions& options, ImproveStatistics* statistics) {
  require(options.tolerance > 0, "improve: the tolerance must be positive");
  Improver improver(surface, std::move(mesh), options);
  improver.run();
  if (statistics != nullptr) *statistics = improver.statistics;
  return improver.take();
}

}  // namespace cs2mesh
