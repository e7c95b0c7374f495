#include "polygonize/remesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/collapse_crossings.h"
#include "polygonize/editable_mesh.h"
#include "polygonize/sagitta.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// 1 for an equilateral triangle, 0 for one without area.
double quality(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double sides = squared_norm(b - a) + squared_norm(c - b) + squared_norm(a - c);
  return 2 * std::sqrt(3.0) * norm(cross(b - a, c - a)) / sides;
}

class Remesher {
 public:
  Remesher(const ImplicitSurface& surface, const SurfaceOctree& tree, TriangleMesh mesh,
           std::span<const Octree::Index> leaf_of, const RemeshOptions& options)
      : surface_(surface),
        tree_(tree),
        options_(options),
        leaf_of_(leaf_of),
        mesh_(std::move(mesh)),
        normals_(leaf_of.size()),
        last_step_(leaf_of.size(), 0.0),
        used_(leaf_of.size(), true) {
    sort_by_place();
  }

  TriangleMesh run() {
    project(2);
    for (const Index v : order_) {
      if (last_step_[v] <= 0.01 * options_.tolerance) statistics.on_surface.push_back(position(v));
    }
    unfold();
    untangle();
    for (int round = 0; round < options_.rounds && !cancelled(options_.progress); ++round) {
      if (options_.progress != nullptr) {
        options_.progress->report("remesh", static_cast<double>(round) / options_.rounds);
      }
      find_lengths();
      for (const double share : {0.4, 0.6, kShortest}) collapse_short(share);
      flip_edges();
      relax();
      flip_edges();
    }
    for (int round = 0; round < kSmoothing; ++round) {
      relax();
      flip_edges();
    }
    settle();
    untangle();
    return mesh_.take();
  }

  RemeshStatistics statistics;

 private:
  /// The vertices that are left, all the way to the surface.
  void settle() {
    constexpr int kMostSteps = 12;
    find_used();
    project(kMostSteps);
    unfold();
  }

  void untangle() {
    constexpr int kMostRounds = 8;
    for (int round = 0; options_.untangle && round < kMostRounds; ++round) {
      if (collapse_crossings(mesh_) == 0) return;
    }
  }

  /// Which vertices are those of a triangle.
  void find_used() {
    used_.assign(normals_.size(), false);
    for (std::size_t t = 0; t < mesh_.mesh().triangles.size(); ++t) {
      if (!mesh_.alive(t)) continue;
      for (const Index v : mesh_.mesh().triangles[t]) used_[v] = true;
    }
  }

  const Vec3d& position(Index v) const { return mesh_.mesh().positions[v]; }
  Index start(HalfEdge h) const { return start_of(mesh_.mesh(), h); }
  Index end(HalfEdge h) const { return end_of(mesh_.mesh(), h); }
  std::size_t half_edge_count() const { return 3 * mesh_.mesh().triangles.size(); }

  // ---- Vertices and the surface ----

  /// Vertices in an order in which those near one restriction of F follow each other.
  void sort_by_place() {
    order_.resize(leaf_of_.size());
    std::iota(order_.begin(), order_.end(), Index{0});
    std::stable_sort(order_.begin(), order_.end(), [&](Index a, Index b) {
      return tree_.surface_number(leaf_of_[a]) < tree_.surface_number(leaf_of_[b]);
    });
  }

  /// The jets at points, one for each vertex of `vertices`.
  void evaluate(std::span<const Index> vertices, std::span<const Vec3d> points,
                std::span<Jet> jets) {
    statistics.jets += points.size();
    std::vector<std::pair<std::size_t, std::size_t>> runs;
    for (std::size_t first = 0; first < vertices.size();) {
      const std::uint32_t number = tree_.surface_number(leaf_of_[vertices[first]]);
      std::size_t last = first + 1;
      while (last < vertices.size() && tree_.surface_number(leaf_of_[vertices[last]]) == number) {
        ++last;
      }
      runs.emplace_back(first, last);
      first = last;
    }
    tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
      const auto [first, last] = runs[i];
      const Octree::Index leaf = leaf_of_[vertices[first]];
      const Aabb& box = tree_.surface_box(leaf);
      const auto run = points.subspan(first, last - first);
      const bool inside =
          std::all_of(run.begin(), run.end(), [&](const Vec3d& p) { return box.contains(p); });
      (inside ? tree_.surface_at(leaf) : surface_).jets(run, jets.subspan(first, last - first));
    });
  }

  /// Brings vertices to the surface along the gradient and takes its direction there, in at most so
  /// many steps.
  void project(int steps) {
    constexpr double kThere = 1e-7;  // of the cell; the last step squares that
    std::vector<Index> open;
    for (const Index v : order_) {
      if (used_[v]) open.push_back(v);
    }
    std::vector<Vec3d> points;
    std::vector<Jet> jets;
    for (int step = 0; step < steps && !open.empty(); ++step) {
      points.clear();
      for (const Index v : open) points.push_back(position(v));
      jets.resize(open.size());
      evaluate(open, points, jets);
      std::size_t kept = 0;
      for (std::size_t i = 0; i < open.size(); ++i) {
        const Index v = open[i];
        last_step_[v] = place(v, points[i], jets[i]);
        if (last_step_[v] > kThere * side_at(v)) open[kept++] = v;
      }
      open.resize(kept);
    }
  }

  /// Puts a vertex where the jet at `point` says that the surface is; returns the length of the
  /// way.
  double place(Index v, const Vec3d& point, const Jet& jet) {
    const double slope = norm_of_any(jet.gradient);
    if (!(slope > 0)) return kInfinity;
    normals_[v] = -1.0 / slope * jet.gradient;
    const Vec3d step = bounded(-leveled(jet.value) / slope * normals_[v], v);
    mesh_.move_vertex(v, point - step);
    return norm(step);
  }

  double side_at(Index v) const { return tree_.octree().side(tree_.octree()[leaf_of_[v]].level); }

  /// A step no longer than a quarter of a cell.
  Vec3d bounded(const Vec3d& step, Index v) const {
    const double most = 0.25 * side_at(v);
    const double length = norm(step);
    return length > most ? most / length * step : step;
  }

  // ---- Edges ----

  double sagitta_of(Index a, Index b) const {
    return sagitta(position(a), normals_[a], position(b), normals_[b]);
  }
  double deviation_of(Index a, Index b, Index c) const {
    return deviation(sagitta_of(a, b), sagitta_of(b, c), sagitta_of(c, a));
  }
  /// How far triangles at a vertex may be from the surface: where cells are small, other sheets may
  /// be near.
  double allowed(Index v, double slack = 1.0) const {
    constexpr double kCellShare = 0.5;
    return std::min(slack * kAim * options_.tolerance, kCellShare * side_at(v));
  }
  /// Where the surface is smooth, triangles may be farther from it at first: flipping and moving
  /// spreads the error.
  double slack_of(Index a, Index b, Index c) const {
    constexpr double kSmooth = 0.9;  // cosine between normals
    constexpr double kSlack = 1.6;
    const bool smooth = dot(normals_[a], normals_[b]) > kSmooth &&
                        dot(normals_[b], normals_[c]) > kSmooth &&
                        dot(normals_[c], normals_[a]) > kSmooth;
    return smooth ? kSlack : 1.0;
  }
  bool is_near(Index a, Index b, Index c) const {
    const double slack = slack_of(a, b, c);
    return deviation_of(a, b, c) <=
           std::min({allowed(a, slack), allowed(b, slack), allowed(c, slack)});
  }

  /// The squared length of edges that suits the curvature at each vertex, graded.
  void find_lengths() {
    lengths_.assign(normals_.size(), kInfinity);
    const double scale = 6 * kAim * options_.tolerance;
    for (HalfEdge h = 0; h < half_edge_count(); ++h) {
      if (!mesh_.alive(triangle_of(h))) continue;
      const Index a = start(h), b = end(h);
      const double length = squared_norm(position(b) - position(a));
      const double rise = 8 * std::abs(sagitta_of(a, b));
      // Of the curvature rise / length, averaged over the edge.
      if (rise > 0) lengths_[a] = std::min(lengths_[a], scale * length / rise);
    }
  }
  double length_at(HalfEdge h) const { return std::min(lengths_[start(h)], lengths_[end(h)]); }

  void collapse_short(double share) {
    for (HalfEdge h = 0; h < half_edge_count(); ++h) {
      if (!mesh_.alive(triangle_of(h))) continue;
      const double length = squared_norm(position(end(h)) - position(start(h)));
      if (!(length < share * share * length_at(h))) continue;
      if (may_collapse(h)) {
        mesh_.collapse_edge(h);
        ++statistics.collapses;
      }
    }
  }

  /// Whether the triangles that stay around the start of h would be near the surface, face its way,
  /// and be shaped no worse than is tolerable or than they were.
  bool may_collapse(HalfEdge h) const {
    constexpr double kShape = 0.35;
    const Index a = start(h), b = end(h);
    const HalfEdge back = mesh_.opposite(h);
    bool fits = dot(normals_[a], normals_[b]) > kTurn;
    double worst = 1.0, worst_now = 1.0;
    mesh_.for_ring(h, [&](HalfEdge turn) {
      if (!fits) return;
      const Index c = end(turn), d = end(next_in_triangle(turn));
      worst_now = std::min(worst_now, quality(position(a), position(c), position(d)));
      if (turn == h || triangle_of(turn) == triangle_of(back)) return;
      fits = faces_outward(b, c, d) && is_near(b, c, d) && near_vertex(a, b, c, d);
      worst = std::min(worst, quality(position(b), position(c), position(d)));
    });
    return fits && (worst > kShape || worst > worst_now) && mesh_.can_collapse(h);
  }

  /// Whether the plane of a triangle passes within the tolerance of a vertex, along its normal.
  bool near_vertex(Index v, Index a, Index b, Index c) const {
    const Vec3d area = cross(position(b) - position(a), position(c) - position(a));
    const double height = dot(area, position(v) - position(a));
    return std::abs(height) <= allowed(v, slack_of(a, b, c)) * norm(area);
  }

  bool faces_outward(Index a, Index b, Index c) const {
    const Vec3d area = cross(position(b) - position(a), position(c) - position(a));
    const double least = kTurn * norm(area);
    return dot(area, normals_[a]) > least && dot(area, normals_[b]) > least &&
           dot(area, normals_[c]) > least;
  }

  /// Makes edges locally Delaunay where that keeps the mesh near the surface.
  void flip_edges() {
    for (int sweep = 0; sweep < 2; ++sweep) {
      std::size_t flipped = 0;
      for (HalfEdge h = 0; h < half_edge_count(); ++h) {
        if (!mesh_.alive(triangle_of(h)) || mesh_.opposite(h) < h) continue;
        if (should_flip(h) && mesh_.flip_edge(h)) ++flipped;
      }
      statistics.flips += flipped;
      if (flipped == 0) break;
    }
  }

  bool should_flip(HalfEdge h) const {
    const HalfEdge back = mesh_.opposite(h);
    const Index a = start(h), b = end(h);
    const Index c = end(next_in_triangle(h)), d = end(next_in_triangle(back));
    if (c == d) return false;
    if (!(cotangent(c, a, b) + cotangent(d, b, a) < -1e-9)) return false;
    if (!faces_outward(d, c, a) || !faces_outward(c, d, b)) return false;
    const double now = std::max(deviation_of(a, b, c), deviation_of(b, a, d));
    const double then = std::max(deviation_of(d, c, a), deviation_of(c, d, b));
    return !(then > now && then > kAim * options_.tolerance);
  }

  /// Of the angle at a.
  double cotangent(Index a, Index b, Index c) const {
    const Vec3d u = position(b) - position(a), v = position(c) - position(a);
    return dot(u, v) / std::max(norm(cross(u, v)), std::numeric_limits<double>::min());
  }

  // ---- Folds ----

  /// Gets rid of triangles that face the wrong way, by collapsing or flipping one of their edges
  /// where that leaves fewer of them around.
  void unfold() {
    constexpr int kMostSweeps = 6;
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
      std::size_t mended = 0;
      for (std::size_t t = 0; t < mesh_.mesh().triangles.size(); ++t) {
        if (mesh_.alive(t) && folded(t) && mend(t)) ++mended;
      }
      if (mended == 0) break;
    }
  }

  bool folded(std::size_t triangle) const {
    const auto& t = mesh_.mesh().triangles[triangle];
    return !faces_outward(t[0], t[1], t[2]);
  }

  bool mend(std::size_t triangle) {
    HalfEdge best = 0;
    int most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto h = static_cast<HalfEdge>(3 * triangle + k);
      for (const HalfEdge way : {h, mesh_.opposite(h)}) {
        const int gain = folds_unmade(way);
        if (gain > most && mesh_.can_collapse(way)) {
          most = gain;
          best = way;
        }
      }
    }
    if (most > 0) {
      mesh_.collapse_edge(best);
      ++statistics.collapses;
      return true;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const auto h = static_cast<HalfEdge>(3 * triangle + k);
      const HalfEdge back = mesh_.opposite(h);
      const Index a = start(h), b = end(h);
      const Index c = end(next_in_triangle(h)), d = end(next_in_triangle(back));
      if (c != d && faces_outward(d, c, a) && faces_outward(c, d, b) && mesh_.flip_edge(h)) {
        ++statistics.flips;
        return true;
      }
    }
    return false;
  }

  /// How many folded triangles a collapse would leave fewer.
  int folds_unmade(HalfEdge h) const {
    const Index b = end(h);
    const HalfEdge back = mesh_.opposite(h);
    int before = 0, after = 0;
    mesh_.for_ring(h, [&](HalfEdge turn) {
      const Index c = end(turn), d = end(next_in_triangle(turn));
      if (folded(triangle_of(turn))) ++before;
      if (turn == h || triangle_of(turn) == triangle_of(back)) return;
      if (!faces_outward(b, c, d)) ++after;
    });
    return before - after;
  }

  // ---- Moving ----

  /// Moves every vertex towards the middle of its triangles, along the surface, where no triangle
  /// turns over for it.
  void relax() {
    const auto& triangles = mesh_.mesh().triangles;
    std::vector<Vec3d> sum(normals_.size(), Vec3d{});
    std::vector<double> weight(normals_.size(), 0.0);
    for (const auto& t : triangles) {
      if (t[0] == t[1]) continue;
      const Vec3d middle = (position(t[0]) + position(t[1]) + position(t[2])) / 3.0;
      const double area =
          norm(cross(position(t[1]) - position(t[0]), position(t[2]) - position(t[0])));
      for (const Index v : t) {
        sum[v] += area * middle;
        weight[v] += area;
      }
    }
    std::vector<Index> moved;
    std::vector<Vec3d> points;
    for (const Index v : order_) {
      if (!(weight[v] > 0)) continue;
      const Vec3d step = sum[v] / weight[v] - position(v);
      points.push_back(position(v) + (step - dot(step, normals_[v]) * normals_[v]));
      moved.push_back(v);
    }
    move(moved, points);
  }

  void move(std::span<const Index> vertices, std::span<Vec3d> points) {
    std::vector<Jet> jets(points.size());
    std::vector<Vec3d> old_points(vertices.size()), old_normals(vertices.size());
    evaluate(vertices, points, jets);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const Index v = vertices[i];
      old_points[i] = position(v), old_normals[i] = normals_[v];
      place(v, points[i], jets[i]);
    }
    take_back(vertices, old_points, old_normals);
  }

  /// Returns the vertices of triangles that turned over, until there are none or all are back.
  void take_back(std::span<const Index> vertices, std::span<const Vec3d> points,
                 std::span<const Vec3d> normals) {
    std::vector<Index> place(normals_.size(), 0);
    for (std::size_t i = 0; i < vertices.size(); ++i) place[vertices[i]] = static_cast<Index>(i);
    std::vector<bool> back(vertices.size(), false);
    constexpr int kMostRounds = 8;
    for (int round = 0; round < kMostRounds; ++round) {
      bool any = false;
      for (const auto& t : mesh_.mesh().triangles) {
        if (t[0] == t[1] ||
            (faces_outward(t[0], t[1], t[2]) &&
             deviation_of(t[0], t[1], t[2]) <= slack_of(t[0], t[1], t[2]) * options_.tolerance)) {
          continue;
        }
        for (const Index v : t) {
          const Index i = place[v];
          if (back[i]) continue;
          back[i] = any = true;
          mesh_.move_vertex(v, points[i]);
          normals_[v] = normals[i];
        }
      }
      if (!any) break;
    }
  }

  static constexpr double kAim = 0.72;  ///< of the tolerance
  /// Edges are collapsed below this share of the length that suits the curvature.
  static constexpr int kSmoothing = 3;  ///< rounds of moving and flipping alone, at the end
  static constexpr double kShortest = 0.8;
  static constexpr double kTurn = 0.2;  ///< least cosine between a triangle and its normals

  const ImplicitSurface& surface_;
  const SurfaceOctree& tree_;
  const RemeshOptions& options_;
  std::span<const Octree::Index> leaf_of_;
  EditableMesh mesh_;
  std::vector<Vec3d> normals_;
  std::vector<double> lengths_;
  std::vector<double> last_step_;  ///< on the way to the surface
  std::vector<Index> order_;
  std::vector<bool> used_;
};

}  // namespace

TriangleMesh remesh(const ImplicitSurface& surface, const SurfaceOctree& tree, TriangleMesh mesh,
                    std::span<const Octree::Index> leaf_of, const RemeshOptions& options,
                    RemeshStatistics* statistics) {
  require(options.tolerance > 0, "remesh: the tolerance must be positive");
  require(leaf_of.size() == mesh.positions.size(), "remesh: one leaf a vertex");
  Remesher remesher(surface, tree, std::move(mesh), leaf_of, options);
  TriangleMesh result = remesher.run();
  if (statistics != nullptr) *statistics = std::move(remesher.statistics);
  return result;
}

}  // namespace cs2mesh
