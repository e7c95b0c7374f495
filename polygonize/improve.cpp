#include "polygonize/improve.h"

#include <algorithm>
#include <array>
#include <unordered_set>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/editable_mesh.h"
#include "polygonize/far_triangles.h"
#include "polygonize/sagitta.h"
#include "polygonize/triangle_sample.h"
#include "polygonize/triangle_shape.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// Angles below this are not made of better ones, in degrees.
constexpr double kSound = kThinAngle + 0.5;
/// The least cosine between a triangle and the surface at its corners.
constexpr double kTurn = 0.3;
/// What is not worth measuring, in tolerances, by normals.
constexpr double kHopeless = 1.3;

enum class Kind : std::uint8_t { collapse, flip, move };

/// A change to the mesh, and the triangles that it makes: those from `first` on.
struct Proposal {
  Kind kind{};
  HalfEdge edge = 0;
  Vec3d place;  ///< of a moved vertex
  std::size_t first = 0, count = 0;
};

class Improver {
 public:
  Improver(const ImplicitSurface& surface, TriangleMesh mesh, const ImproveOptions& options)
      : surface_(surface), options_(options), mesh_(std::move(mesh)) {
    look_at_vertices();
  }

  void run() {
    constexpr double kFew = 0.002;  // of the triangles
    for (int round = 0; round < options_.most_rounds && !cancelled(options_.progress); ++round) {
      if (options_.progress != nullptr) {
        options_.progress->report("improve", static_cast<double>(round) / options_.most_rounds);
      }
      propose();
      const std::size_t changed = carry_out();
      const auto count = static_cast<double>(mesh_.mesh().triangles.size());
      if (static_cast<double>(changed) < kFew * count) break;
    }
  }
  TriangleMesh take() { return mesh_.take(); }

  ImproveStatistics statistics;

 private:
  using Triangle = std::array<Index, 3>;
  const Vec3d& position(Index v) const { return mesh_.mesh().positions[v]; }
  Index start(HalfEdge h) const { return start_of(mesh_.mesh(), h); }
  Index end(HalfEdge h) const { return end_of(mesh_.mesh(), h); }
  double angle_of(const Triangle& t) const {
    return smallest_angle(position(t[0]), position(t[1]), position(t[2]));
  }

  /// The normal of the surface at each vertex, and its foot there.
  void look_at_vertices() {
    const std::vector<Vec3d>& points = mesh_.mesh().positions;
    normals_.resize(points.size());
    feet_.resize(points.size());
    for_each_neighbourhood(points.size(), [&](std::size_t first, std::size_t last) {
      const std::vector<Jet> jets =
          jets_at_neighbours(surface_, std::span(points).subspan(first, last - first));
      for (std::size_t i = first; i < last; ++i) take_jet(i, points[i], jets[i - first]);
    });
  }
  void take_jet(std::size_t i, const Vec3d& p, const Jet& jet) {
    const double slope = norm_of_any(jet.gradient);
    normals_[i] = slope > 0 ? -1.0 / slope * jet.gradient : Vec3d{};
    feet_[i] = slope > 0 ? p + leveled(jet.value) / slope * normals_[i] : p;
  }

  // ---- What could be better ----

  /// Changes that look promising, no two of which touch the same vertex: what thin triangles need
  /// first, then whatever makes fewer.
  void propose() {
    proposals_.clear();
    made_.clear();
    touched_.assign(mesh_.mesh().positions.size(), false);
    const std::size_t count = mesh_.mesh().triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      if (mesh_.alive(t) && angle_of(mesh_.mesh().triangles[t]) < kSound) propose_for_thin(t);
    }
    for (HalfEdge h = 0; h < 3 * count; ++h) {
      if (mesh_.alive(triangle_of(h))) propose_collapse(h);
    }
  }

  void propose_for_thin(std::size_t triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto h = static_cast<HalfEdge>(3 * triangle + k);
      if (propose_collapse(h) || propose_collapse(mesh_.opposite(h)) || propose_flip(h)) return;
    }
  }

  /// Whether this was tried before in vain, at the same ends.
  bool refused(Kind kind, HalfEdge h) const { return refused_.contains(key(kind, h)); }
  std::uint64_t key(Kind kind, HalfEdge h) const {
    const std::uint64_t ends = (std::uint64_t{start(h)} << 32U) | end(h);
    return 2 * ends + (kind == Kind::flip ? 1 : 0);
  }

  bool propose_collapse(HalfEdge h) {
    const Index a = start(h), b = end(h);
    if (touched_[a] || touched_[b] || refused(Kind::collapse, h)) return false;
    const HalfEdge back = mesh_.opposite(h);
    const std::size_t first = made_.size();
    double now = kSound, then = kSound;
    bool fits = true;
    mesh_.for_ring(h, [&](HalfEdge turn) {
      if (!fits) return;
      const Triangle old{a, end(turn), end(next_in_triangle(turn))};
      now = std::min(now, angle_of(old));
      if (turn == h || triangle_of(turn) == triangle_of(back)) return;
      const Triangle made{b, old[1], old[2]};
      fits = !touched_[old[1]] && !touched_[old[2]] && follows(made) && holds(made, a);
      then = std::min(then, angle_of(made));
      made_.push_back(made);
    });
    if (!fits || (then < kSound && then <= now) || !mesh_.can_collapse(h)) {
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
    if (!(then > now) || !follows(one) || !follows(other) || !mesh_.can_flip(h)) return false;
    const std::size_t first = made_.size();
    made_.push_back(one);
    made_.push_back(other);
    add(Kind::flip, h, first);
    return true;
  }

  void add(Kind kind, HalfEdge h, std::size_t first) {
    proposals_.push_back({kind, h, {}, first, made_.size() - first});
    touched_[start(h)] = true;
    for (std::size_t i = first; i < made_.size(); ++i) {
      for (const Index v : made_[i]) touched_[v] = true;
    }
  }

  /// Whether a triangle faces the way of the surface at its corners, and could be near it.
  bool follows(const Triangle& t) const {
    const auto [a, b, c] = t;
    const Vec3d area = cross(position(b) - position(a), position(c) - position(a));
    const double least = kTurn * norm(area);
    if (!(dot(area, normals_[a]) > least && dot(area, normals_[b]) > least &&
          dot(area, normals_[c]) > least)) {
      return false;
    }
    const auto rise = [&](Index v, Index w) {
      return sagitta(feet_[v], normals_[v], feet_[w], normals_[w]);
    };
    const auto [low, high] = deviation_range(rise(a, b), rise(b, c), rise(c, a));
    return 0.5 * (high - low) <= kHopeless * options_.tolerance;
  }

  /// Whether the plane of a triangle is within the tolerance of the surface at a vertex that goes.
  bool holds(const Triangle& t, Index gone) const {
    const Vec3d area = cross(position(t[1]) - position(t[0]), position(t[2]) - position(t[0]));
    const double height = dot(area, feet_[gone] - position(t[0]));
    return std::abs(height) <= options_.tolerance * norm(area);
  }

  // ---- What is ----

  /// Carries out the proposals none of whose triangles is too far; returns how many.
  std::size_t carry_out() {
    TriangleMesh proposed;
    proposed.positions = mesh_.mesh().positions;
    proposed.triangles = made_;
    std::vector<std::size_t> all(made_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    std::vector<char> far(made_.size(), 0);
    const FarOptions far_options{options_.tolerance, options_.small, 100 * options_.tolerance};
    for_each_neighbourhood(all.size(), [&](std::size_t first, std::size_t last) {
      const auto some = std::span(all).subspan(first, last - first);
      for (const LostPoint& lost : far_triangles(surface_, proposed, some, far_options)) {
        far[lost.triangle] = 1;
      }
    });
    std::size_t changed = 0;
    for (const Proposal& proposal : proposals_) {
      const auto first = far.begin() + static_cast<std::ptrdiff_t>(proposal.first);
      const auto last = first + static_cast<std::ptrdiff_t>(proposal.count);
      if (std::find(first, last, 1) != last) {
        refused_.insert(key(proposal.kind, proposal.edge));
        ++statistics.refused;
      } else if (carry_out(proposal)) {
        ++changed;
      }
    }
    return changed;
  }

  bool carry_out(const Proposal& proposal) {
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
  std::vector<Vec3d> normals_, feet_;  ///< of the surface, for each vertex
  std::vector<Proposal> proposals_;
  std::vector<Triangle> made_;  ///< by the proposals
  std::vector<bool> touched_;   ///< vertices
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
