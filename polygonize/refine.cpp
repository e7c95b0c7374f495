#include "polygonize/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/far_triangles.h"
#include "polygonize/fold.h"
#include "polygonize/half_edges.h"
#include "polygonize/near_proof.h"
#include "polygonize/near_root.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// The cosine between the normals of two triangles from which they count as folded onto each other.
constexpr double kSharpest = -0.9;

/// A triangle on its way to being split: corners, and the new vertex of each edge, or kNone.
struct Piece {
  std::array<Index, 3> corner;
  std::array<Index, 3> middle;  ///< of the edge from corner k to corner k + 1
};
constexpr Index kNone = ~Index{0};

class Refiner {
 public:
  Refiner(const ImplicitSurface& surface, TriangleMesh mesh, const RefineOptions& options)
      : surface_(surface),
        mesh_(std::move(mesh)),
        options_(options),
        longest_way_(bounds(mesh_).diagonal()),
        first_new_(options.first_new) {
    if (options.close != nullptr) close_ = *options.close;
  }

  void run() {
    divide_until_near();
    collect_far();
  }
  TriangleMesh take() { return std::move(mesh_); }

  RefineStatistics statistics;

 private:
  using FarTriangle = std::pair<std::array<Index, 3>, LostPoint>;

  void divide_until_near() {
    for (int round = 0; round < options_.most_rounds; ++round) {
      if (mesh_.triangles.size() > options_.max_triangles) return;
      if (cancelled(options_.progress)) return;
      if (options_.progress != nullptr) {
        options_.progress->report("refine", static_cast<double>(round) / options_.most_rounds);
      }
      const std::vector<LostPoint> far = find_far();
      if (far.empty()) {
        statistics.first_unseen = kNone;
        return;
      }
      opposite_ = opposite_half_edges(mesh_);
      split_.assign(opposite_.size(), 0);
      mark(far);
      mark_longest_edges();
      place_middles();
      if (!divide()) {
        statistics.first_unseen = kNone;
        return;
      }
      ++statistics.rounds;
      statistics.first_unseen = first_new_;
    }
  }

  // ---- Where to split ----

  /// Each edge goes by the lower of its half-edges.
  HalfEdge edge_of(HalfEdge h) const { return std::min(h, opposite_[h]); }
  Vec3d start(HalfEdge h) const { return mesh_.positions[start_of(mesh_, h)]; }
  Vec3d end(HalfEdge h) const { return mesh_.positions[end_of(mesh_, h)]; }
  Vec3d middle(HalfEdge h) const { return 0.5 * (start(h) + end(h)); }
  double squared_length(HalfEdge h) const { return squared_norm(end(h) - start(h)); }

  /// Whether the triangle has to be nearer to the surface than others.
  bool is_close(std::size_t triangle) const {
    const auto& corner = mesh_.triangles[triangle];
    return !close_.empty() && close_[corner[0]] && close_[corner[1]] && close_[corner[2]];
  }

  /// Those of these triangles that are too far.
  std::vector<LostPoint> find_far(std::span<const std::size_t> triangles) const {
    std::vector<std::size_t> of_kind[2];
    for (const std::size_t t : triangles) of_kind[is_close(t) ? 1 : 0].push_back(t);
    const FarOptions usual{options_.tolerance, options_.small, longest_way_, ways_out_};
    std::vector<LostPoint> far = far_triangles(surface_, mesh_, of_kind[0], usual);
    if (of_kind[1].empty()) return far;
    const FarOptions closer{options_.closer, options_.small, longest_way_, ways_out_};
    const std::vector<LostPoint> more = far_triangles(surface_, mesh_, of_kind[1], closer);
    far.insert(far.end(), more.begin(), more.end());
    return far;
  }

  HalfEdge longest_edge(std::size_t triangle) const {
    const auto h = static_cast<HalfEdge>(3 * triangle);
    std::array<HalfEdge, 3> edges{edge_of(h), edge_of(h + 1), edge_of(h + 2)};
    // Of equals the same one for both triangles beside it.
    return *std::max_element(edges.begin(), edges.end(), [&](HalfEdge a, HalfEdge b) {
      const double la = squared_length(a), lb = squared_length(b);
      return la != lb ? la < lb : a < b;
    });
  }

  std::vector<std::size_t> triangles_to_look_at() const {
    if (options_.first_looked_at != nullptr && statistics.rounds == 0) {
      return {options_.first_looked_at->begin(), options_.first_looked_at->end()};
    }
    std::vector<std::size_t> fresh;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& corner = mesh_.triangles[t];
      const bool is_new = std::max({corner[0], corner[1], corner[2]}) >= first_new_;
      if (is_new || (statistics.rounds == 0 && is_close(t))) fresh.push_back(t);
    }
    return fresh;
  }

  /// Those of all triangles that are not known to be near.
  std::vector<LostPoint> find_far() {
    const std::vector<std::size_t> fresh = triangles_to_look_at();
    if (!fresh.empty() && surface_.has_cheap_hull_bounds()) ways_out_ = ways_out(mesh_);
    std::vector<std::vector<LostPoint>> far((fresh.size() + kNeighbours - 1) / kNeighbours);
    for_each_neighbourhood(fresh.size(), [&](std::size_t first, std::size_t last) {
      if (cancelled(options_.progress)) return;
      far[first / kNeighbours] = find_far(std::span(fresh).subspan(first, last - first));
    });
    std::vector<LostPoint> all;
    for (const auto& chunk : far) all.insert(all.end(), chunk.begin(), chunk.end());
    return all;
  }

  /// Marks the longest edge of each.
  void mark(std::span<const LostPoint> far) {
    for (const LostPoint& lost : far) {
      split_[longest_edge(lost.triangle)] = 1;
      far_.emplace_back(mesh_.triangles[lost.triangle], lost);
    }
  }

  /// Of what was too far at some time, the triangles that are still there.
  void collect_far() {
    const auto by_corners = [](const FarTriangle& a, const FarTriangle& b) {
      return a.first < b.first;
    };
    std::stable_sort(far_.begin(), far_.end(), by_corners);
    for (std::size_t t = 0; t < mesh_.triangles.size() && !far_.empty(); ++t) {
      const auto at = std::lower_bound(far_.begin(), far_.end(),
                                       FarTriangle{mesh_.triangles[t], {}}, by_corners);
      if (at == far_.end() || at->first != mesh_.triangles[t]) continue;
      if (at->second.distance <= options_.tolerance) continue;  // as near as others have to be
      statistics.far.push_back(at->second);
      statistics.far.back().triangle = static_cast<std::uint32_t>(t);
    }
  }

  /// Marks the longest edge of each triangle that has a marked one, and so on.
  void mark_longest_edges() {
    std::vector<HalfEdge> open;
    for (HalfEdge h = 0; h < split_.size(); ++h) {
      if (split_[h] != 0) open.push_back(h);
    }
    while (!open.empty()) {
      const HalfEdge h = open.back();
      open.pop_back();
      for (const HalfEdge side : {h, opposite_[h]}) {
        const HalfEdge longest = longest_edge(triangle_of(side));
        if (split_[longest] != 0) continue;
        split_[longest] = 1;
        open.push_back(longest);
      }
    }
  }

  // ---- Where to ----

  /// Gives each marked edge a new vertex on the surface: up or down the gradient from its middle,
  /// or, where that would fold the mesh, along the mesh's own normal. Edges for which neither will
  /// do are kept.
  void place_middles() {
    middle_of_.assign(opposite_.size(), kNone);
    first_new_ = static_cast<Index>(mesh_.positions.size());
    std::vector<HalfEdge> edges;
    for (HalfEdge h = 0; h < split_.size(); ++h) {
      if (split_[h] != 0) edges.push_back(h);
    }
    place(edges, [](HalfEdge, const Jet& jet) { return jet.gradient; });
    const std::vector<HalfEdge> folded = take_back_folded();
    place(folded, [this](HalfEdge h, const Jet&) { return normal_at(h); });
    statistics.kept += take_back_folded().size();
    close_gaps(edges);
  }

  /// The sum of the normals of the triangles at an edge, not normalised.
  Vec3d normal_at(HalfEdge h) const {
    return normal(mesh_.triangles[triangle_of(h)]) +
           normal(mesh_.triangles[triangle_of(opposite_[h])]);
  }

  /// Appends a vertex for each of the edges from whose middle a line leads to the surface.
  template <class Direction>
  void place(const std::vector<HalfEdge>& edges, const Direction& direction_of) {
    std::vector<std::optional<Vec3d>> places(edges.size());
    for_each_neighbourhood(edges.size(), [&](std::size_t first, std::size_t last) {
      std::vector<Vec3d> middles;
      for (std::size_t i = first; i < last; ++i) middles.push_back(middle(edges[i]));
      const std::vector<Jet> jets = jets_at_neighbours(surface_, middles);
      std::vector<RootQuery> queries;
      for (std::size_t i = first; i < last; ++i) {
        const Jet& jet = jets[i - first];
        const Vec3d direction = direction_of(edges[i], jet);
        const double limit = std::sqrt(squared_length(edges[i]));
        queries.push_back({middles[i - first], direction / norm(direction),
                           first_order_distance(jet, limit), limit});
      }
      find_near_roots(surface_, queries, std::span(places).subspan(first, last - first));
    });
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (!places[i]) {
        ++statistics.kept;
        continue;
      }
      middle_of_[edges[i]] = static_cast<Index>(mesh_.positions.size());
      mesh_.positions.push_back(*places[i]);
    }
  }

  /// Takes back the new vertices of triangles that would be folded onto a neighbour, until there is
  /// none. Returns their edges.
  std::vector<HalfEdge> take_back_folded() {
    std::vector<HalfEdge> back;
    for (;;) {
      std::vector<char> blamed(mesh_.positions.size() - first_new_, 0);
      if (!blame_folds(blamed)) return back;
      for (HalfEdge h = 0; h < middle_of_.size(); ++h) {
        if (middle_of_[h] == kNone || blamed[middle_of_[h] - first_new_] == 0) continue;
        middle_of_[h] = kNone;
        back.push_back(h);
      }
    }
  }

  /// Marks the new vertices of every two triangles that face each other across an edge. True if
  /// there are any.
  bool blame_folds(std::vector<char>& blamed) const {
    TriangleMesh divided;
    divided.positions = mesh_.positions;
    divided.triangles = parts();
    const std::vector<HalfEdge> opposite = opposite_half_edges(divided);
    bool any = false;
    for (HalfEdge h = 0; h < opposite.size(); ++h) {
      if (h > opposite[h]) continue;
      const auto& one = divided.triangles[triangle_of(h)];
      const auto& other = divided.triangles[triangle_of(opposite[h])];
      const auto is_new = [this](Index v) { return v >= first_new_; };
      if (std::none_of(one.begin(), one.end(), is_new) &&
          std::none_of(other.begin(), other.end(), is_new)) {
        continue;
      }
      if (!folded(surface_, corners(one), corners(other), kSharpest)) continue;
      for (const auto* triangle : {&one, &other}) {
        for (const Index v : *triangle) {
          if (is_new(v)) blamed[v - first_new_] = 1;
        }
      }
      any = true;
    }
    return any;
  }

  /// Removes the vertices that were taken back.
  void close_gaps(const std::vector<HalfEdge>& edges) {
    std::vector<Vec3d> placed;
    for (const HalfEdge h : edges) {
      if (middle_of_[h] == kNone) continue;
      const Vec3d place = mesh_.positions[middle_of_[h]];
      middle_of_[h] = first_new_ + static_cast<Index>(placed.size());
      placed.push_back(place);
    }
    mesh_.positions.resize(first_new_);
    mesh_.positions.insert(mesh_.positions.end(), placed.begin(), placed.end());
  }

  Piece whole(std::size_t t) const {
    Piece piece;
    piece.corner = mesh_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      piece.middle[k] = middle_of_[edge_of(static_cast<HalfEdge>(3 * t + k))];
    }
    return piece;
  }

  TriangleCorners corners(const std::array<Index, 3>& t) const {
    return {mesh_.positions[t[0]], mesh_.positions[t[1]], mesh_.positions[t[2]]};
  }
  Vec3d normal(const std::array<Index, 3>& t) const {
    return cross(mesh_.positions[t[1]] - mesh_.positions[t[0]],
                 mesh_.positions[t[2]] - mesh_.positions[t[0]]);
  }

  // ---- Splitting ----

  /// Cuts a triangle through the middle of its longest marked edge, and the parts likewise.
  template <class F>
  void for_each_part(const Piece& piece, const F& f) const {
    std::size_t longest = 3;
    double length = -1;
    for (std::size_t k = 0; k < 3; ++k) {
      if (piece.middle[k] == kNone) continue;
      const double squared = squared_norm(mesh_.positions[piece.corner[(k + 1) % 3]] -
                                          mesh_.positions[piece.corner[k]]);
      if (squared > length) {
        length = squared;
        longest = k;
      }
    }
    if (longest == 3) return f(piece.corner);
    const std::size_t a = longest, b = (a + 1) % 3, c = (a + 2) % 3;
    const Index m = piece.middle[a];
    for_each_part(Piece{{piece.corner[a], m, piece.corner[c]}, {kNone, kNone, piece.middle[c]}}, f);
    for_each_part(Piece{{m, piece.corner[b], piece.corner[c]}, {kNone, piece.middle[b], kNone}}, f);
  }

  /// The triangles after splitting.
  std::vector<std::array<Index, 3>> parts() const {
    std::vector<std::array<Index, 3>> all;
    all.reserve(mesh_.triangles.size() + 2 * (mesh_.positions.size() - first_new_));
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      for_each_part(whole(t), [&](const std::array<Index, 3>& part) { all.push_back(part); });
    }
    return all;
  }

  /// Replaces the triangles; false if there is nothing to split.
  bool divide() {
    const std::size_t count = mesh_.positions.size() - first_new_;
    if (!close_.empty()) mark_new_close();
    if (count > 0) mesh_.triangles = parts();
    statistics.splits += count;
    return count > 0;
  }

  /// The new vertices of edges between two that are close.
  void mark_new_close() {
    close_.resize(mesh_.positions.size(), false);
    for (HalfEdge h = 0; h < middle_of_.size(); ++h) {
      if (middle_of_[h] == kNone) continue;
      close_[middle_of_[h]] = close_[start_of(mesh_, h)] && close_[end_of(mesh_, h)];
    }
  }

  const ImplicitSurface& surface_;
  TriangleMesh mesh_;
  const RefineOptions& options_;
  std::vector<Vec3d> ways_out_;  ///< by vertex; empty where proofs are dear
  std::vector<bool> close_;      ///< by vertex; empty if none is
  std::vector<HalfEdge> opposite_;
  std::vector<char> split_;       ///< by edge, whether it is to be split
  std::vector<Index> middle_of_;  ///< by edge, the number of its new vertex or kNone
  std::vector<FarTriangle> far_;  ///< by their corners; some may be split by now
  double longest_way_;
  Index first_new_;  ///< of the last round; what has no such vertex is known
};

}  // namespace

TriangleMesh refine(const ImplicitSurface& surface, TriangleMesh mesh, const RefineOptions& options,
                    RefineStatistics* statistics) {
  require(options.tolerance > 0, "refine: the tolerance must be positive");
  Refiner refiner(surface, std::move(mesh), options);
  refiner.run();
  if (statistics != nullptr) *statistics = refiner.statistics;
  return refiner.take();
}

}  // namespace cs2mesh
