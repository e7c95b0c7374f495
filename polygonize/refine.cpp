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
#include "polygonize/longest_edge_cuts.h"
#include "polygonize/near_proof.h"
#include "polygonize/near_root.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// The cosine between the normals of two triangles from which they count as folded onto each other.
constexpr double kSharpest = -0.9;

constexpr Index kNone = LongestEdgeCuts::kNone;

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
      cuts_.emplace(mesh_);
      mark(far);
      place_middles(cuts_->close());
      if (!divide()) {
        statistics.first_unseen = kNone;
        return;
      }
      ++statistics.rounds;
      statistics.first_unseen = first_new_;
    }
  }

  // ---- Where to split ----

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
      cuts_->mark(cuts_->longest_edge(lost.triangle));
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

  // ---- Where to ----

  /// Gives each marked edge a new vertex on the surface: up or down the gradient from its middle,
  /// or, where that would fold the mesh, along the mesh's own normal. Edges for which neither will
  /// do are kept.
  void place_middles(const std::vector<HalfEdge>& edges) {
    first_new_ = static_cast<Index>(mesh_.positions.size());
    place(edges, [](HalfEdge, const Jet& jet) { return jet.gradient; });
    const std::vector<HalfEdge> folded = take_back_folded();
    place(folded, [this](HalfEdge h, const Jet&) { return normal_at(h); });
    statistics.kept += take_back_folded().size();
    close_gaps(edges);
  }

  /// The sum of the normals of the triangles at an edge, not normalised.
  Vec3d normal_at(HalfEdge h) const {
    return normal(mesh_.triangles[triangle_of(h)]) +
           normal(mesh_.triangles[triangle_of(cuts_->opposite(h))]);
  }

  /// Appends a vertex for each of the edges from whose middle a line leads to the surface.
  template <class Direction>
  void place(const std::vector<HalfEdge>& edges, const Direction& direction_of) {
    std::vector<std::optional<Vec3d>> places(edges.size());
    for_each_neighbourhood(edges.size(), [&](std::size_t first, std::size_t last) {
      std::vector<Vec3d> middles;
      for (std::size_t i = first; i < last; ++i) middles.push_back(cuts_->middle(edges[i]));
      const std::vector<Jet> jets = jets_at_neighbours(surface_, middles);
      std::vector<RootQuery> queries;
      for (std::size_t i = first; i < last; ++i) {
        const Jet& jet = jets[i - first];
        const Vec3d direction = direction_of(edges[i], jet);
        const double limit = std::sqrt(cuts_->squared_length(edges[i]));
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
      cuts_->middle_of[edges[i]] = static_cast<Index>(mesh_.positions.size());
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
      for (HalfEdge h = 0; h < cuts_->middle_of.size(); ++h) {
        if (cuts_->middle_of[h] == kNone || blamed[cuts_->middle_of[h] - first_new_] == 0) continue;
        cuts_->middle_of[h] = kNone;
        back.push_back(h);
      }
    }
  }

  /// Marks the new vertices of every two triangles that face each other across an edge. True if
  /// there are any.
  bool blame_folds(std::vector<char>& blamed) const {
    TriangleMesh divided;
    divided.positions = mesh_.positions;
    divided.triangles = cuts_->parts();
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
      if (cuts_->middle_of[h] == kNone) continue;
      const Vec3d place = mesh_.positions[cuts_->middle_of[h]];
      cuts_->middle_of[h] = first_new_ + static_cast<Index>(placed.size());
      placed.push_back(place);
    }
    mesh_.positions.resize(first_new_);
    mesh_.positions.insert(mesh_.positions.end(), placed.begin(), placed.end());
  }

  TriangleCorners corners(const std::array<Index, 3>& t) const {
    return {mesh_.positions[t[0]], mesh_.positions[t[1]], mesh_.positions[t[2]]};
  }
  Vec3d normal(const std::array<Index, 3>& t) const {
    return cross(mesh_.positions[t[1]] - mesh_.positions[t[0]],
                 mesh_.positions[t[2]] - mesh_.positions[t[0]]);
  }

  // ---- Splitting ----

  /// Replaces the triangles; false if there is nothing to split.
  bool divide() {
    const std::size_t count = mesh_.positions.size() - first_new_;
    if (!close_.empty()) mark_new_close();
    if (count > 0) mesh_.triangles = cuts_->parts();
    statistics.splits += count;
    return count > 0;
  }

  /// The new vertices of edges between two that are close.
  void mark_new_close() {
    close_.resize(mesh_.positions.size(), false);
    for (HalfEdge h = 0; h < cuts_->middle_of.size(); ++h) {
      if (cuts_->middle_of[h] == kNone) continue;
      close_[cuts_->middle_of[h]] = close_[start_of(mesh_, h)] && close_[end_of(mesh_, h)];
    }
  }

  const ImplicitSurface& surface_;
  TriangleMesh mesh_;
  const RefineOptions& options_;
  std::vector<Vec3d> ways_out_;          ///< by vertex; empty where proofs are dear
  std::vector<bool> close_;              ///< by vertex; empty if none is
  std::optional<LongestEdgeCuts> cuts_;  ///< of the round
  std::vector<FarTriangle> far_;         ///< by their corners; some may be split by now
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
