#include "polygonize/remesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/balanced_heights.h"
#include "polygonize/collapse_crossings.h"
#include "polygonize/editable_mesh.h"
#include "polygonize/leaf_jets.h"
#include "polygonize/mend_folds.h"
#include "polygonize/mesh_blocks.h"
#include "polygonize/near_root.h"
#include "polygonize/points_half_way.h"
#include "polygonize/remesh_rules.h"
#include "polygonize/shape_operator.h"
#include "polygonize/spread_error.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
constexpr double kInfinity = HUGE_VAL;

class Remesher {
 public:
  Remesher(const ImplicitSurface& surface, const SurfaceOctree& tree, TriangleMesh mesh,
           std::span<const Octree::Index> leaf_of, const RemeshOptions& options)
      : surface_(surface),
        tree_(tree),
        options_(options),
        leaf_of_(leaf_of.begin(), leaf_of.end()),
        mesh_(std::move(mesh)),
        rules_(mesh_, at_, options.tolerance, options.balance),
        last_step_(leaf_of.size(), 0.0),
        used_(leaf_of.size(), true) {
    at_.normals.resize(leaf_of.size());
    at_.cells.reserve(leaf_of.size());
    for (const Octree::Index leaf : leaf_of_) {
      at_.cells.push_back(tree.octree().side(tree.octree()[leaf].level));
    }
    sort_by_place();
  }

  TriangleMesh run() {
    project_roughly();
    remember_surface();
    mend_folds();
    untangle();
    for (int round = 0; round < options_.rounds && !cancelled(options_.progress); ++round) {
      if (options_.progress != nullptr) {
        options_.progress->report("remesh", static_cast<double>(round) / options_.rounds);
      }
      find_metrics();
      for (const double share : {0.4, 0.6, kShortest}) {
        collapse_short(share);
        close_gaps();
      }
      even_out();
    }
    stretch_ = kLastStretch;
    rules_.set_sound_angle(kThinAngle + 1);
    for (int round = 0; round < kFittings && !cancelled(options_.progress); ++round) {
      find_metrics();
      split_far();
      find_metrics();
      flip_edges();
      collapse_short(kInfinity);
      even_out();
      spread();
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
    search(project(kMostSteps));
    mend_folds();
    if (options_.balance) balance();
  }

  /// Moves vertices off the surface so that it is as far above the triangles at each as below.
  void balance() {
    constexpr double kMost = 0.9;  // of the tolerance
    const auto heights = balanced_heights(mesh_.mesh(), at_.normals, kMost * options_.tolerance);
    for (Index v = 0; v < at_.normals.size(); ++v) {
      if (used_[v]) mesh_.move_vertex(v, position(v) + heights[v] * at_.normals[v]);
    }
  }

  void mend_folds() {
    const FoldsMended mended = cs2mesh::mend_folds(mesh_, at_.normals, RemeshRules::kTurn);
    statistics.collapses += mended.collapses;
    statistics.flips += mended.flips;
  }

  void untangle() {
    constexpr int kMostRounds = 8;
    for (int round = 0; options_.untangle && round < kMostRounds; ++round) {
      if (collapse_crossings(mesh_) == 0) return;
    }
  }

  /// Numbers what is left anew where much of the mesh is gone.
  void close_gaps() {
    constexpr double kMuch = 0.3;
    std::size_t gone = 0;
    for (std::size_t t = 0; t < mesh_.mesh().triangles.size(); ++t) gone += mesh_.alive(t) ? 0 : 1;
    if (static_cast<double>(gone) < kMuch * static_cast<double>(mesh_.mesh().triangles.size())) {
      return;
    }
    const std::vector<Index> former = mesh_.close_gaps();
    const auto keep = [&](auto& of_vertex) {
      for (std::size_t v = 0; v < former.size(); ++v) of_vertex[v] = of_vertex[former[v]];
      of_vertex.resize(former.size());
    };
    keep(at_.normals), keep(at_.cells), keep(at_.shapes), keep(at_.metrics);
    keep(leaf_of_), keep(last_step_), keep(used_);
    sort_by_place();
  }

  /// Which vertices are those of a triangle.
  void find_used() {
    used_.assign(at_.normals.size(), false);
    for (std::size_t t = 0; t < mesh_.mesh().triangles.size(); ++t) {
      if (!mesh_.alive(t)) continue;
      for (const Index v : mesh_.mesh().triangles[t]) used_[v] = true;
    }
  }

  const Vec3d& position(Index v) const { return mesh_.mesh().positions[v]; }
  Index start(HalfEdge h) const { return start_of(mesh_.mesh(), h); }
  Index end(HalfEdge h) const { return end_of(mesh_.mesh(), h); }

  // ---- Vertices and the surface ----

  /// Puts down where the surface is: at the vertices, and where it turns much between two of them
  /// half way too.
  void remember_surface() {
    const double close = 0.01 * options_.tolerance;
    for (const Index v : order_) {
      if (last_step_[v] <= close) statistics.on_surface.push_back(position(v));
    }
    const std::vector<Vec3d> between =
        points_half_way(surface_, tree_, mesh_.mesh(), at_.normals, leaf_of_, close);
    statistics.on_surface.insert(statistics.on_surface.end(), between.begin(), between.end());
    statistics.jets += 2 * between.size();
  }

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
    std::vector<Octree::Index> leaves;
    leaves.reserve(vertices.size());
    for (const Index v : vertices) leaves.push_back(leaf_of_[v]);
    leaf_jets(surface_, tree_, leaves, points, jets);
  }

  /// Brings vertices to the surface along the gradient and takes its direction there; returns those
  /// that are still on their way after so many steps.
  std::vector<Index> project(int steps) {
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
        if (last_step_[v] > kThere * at_.cells[v]) open[kept++] = v;
      }
      open.resize(kept);
    }
    return open;
  }

  /// Brings vertices to the surface but for a small part of the tolerance. Crossings of the octree
  /// are so near it that mostly one step does: the next would be about as long as the square of it,
  /// seen from the cell.
  void project_roughly() {
    constexpr double kClose = 0.005;  // of the tolerance
    constexpr double kShort = 0.02;   // of the cell, so that normals are right
    project(1);
    for (Index v = 0; v < used_.size(); ++v) {
      const double share = last_step_[v] / at_.cells[v];
      used_[v] = !(share <= kShort && share * last_step_[v] <= kClose * options_.tolerance);
      if (!used_[v]) last_step_[v] *= share;
    }
    project(1);
    used_.assign(used_.size(), true);
  }

  /// Vertices that swing to and fro, as beside a kink: to a change of sign on their line.
  void search(const std::vector<Index>& open) {
    std::vector<RootQuery> lines;
    lines.reserve(open.size());
    for (const Index v : open) {
      lines.push_back({position(v), at_.normals[v], last_step_[v], at_.cells[v]});
    }
    std::vector<std::optional<Vec3d>> roots(lines.size());
    find_near_roots(surface_, lines, roots);
    for (std::size_t i = 0; i < roots.size(); ++i) {
      if (roots[i]) mesh_.move_vertex(open[i], *roots[i]);
    }
    if (!open.empty()) project(1);
  }

  /// Puts a vertex where the jet at `point` says that the surface is; returns the length of the
  /// way. (At the edge of a support the logarithm makes short steps too, far from the surface.)
  double place(Index v, const Vec3d& point, const Jet& jet) {
    const double slope = norm_of_any(jet.gradient);
    if (!(slope > 0)) return kInfinity;
    at_.normals[v] = -1.0 / slope * jet.gradient;
    const Vec3d step = bounded(-leveled(jet.value) / slope * at_.normals[v], v);
    mesh_.move_vertex(v, point - step);
    return std::max(norm(step), norm(bounded(jet.value / slope * at_.normals[v], v)));
  }

  /// A step no longer than a quarter of a cell.
  Vec3d bounded(const Vec3d& step, Index v) const {
    const double most = 0.25 * at_.cells[v];
    const double length = norm(step);
    return length > most ? most / length * step : step;
  }

  // ---- Edges ----

  /// How the surface bends at each vertex, by the normals around.
  void find_metrics() {
    at_.shapes = shape_operators(mesh_.mesh(), at_.normals);
    at_.metrics.resize(at_.shapes.size());
    tbb::parallel_for(std::size_t{0}, at_.shapes.size(), [&](std::size_t v) {
      at_.metrics[v] = bend_metric(at_.shapes[v], at_.normals[v], stretch_);
    });
  }

  void collapse_short(double share) {
    const double slack = share < kInfinity ? RemeshRules::kSlack : kStrict;
    statistics.collapses += change_edges([&](HalfEdge h) {
      if (!(rules_.length_of(h) < share * share) || !rules_.may_collapse(h, slack)) return false;
      mesh_.collapse_edge(h);
      return true;
    });
  }

  /// Calls change(h) for each half-edge, many at a time; it may collapse h or flip it. Returns how
  /// often it did so, as it tells.
  template <class Change>
  std::size_t change_edges(const Change& change) {
    std::atomic<std::size_t> changed = 0;
    MeshBlocks(mesh_.mesh()).for_each_triangle(Depth::deep, [&](std::size_t t) {
      for (std::size_t k = 0; k < 3 && mesh_.alive(t); ++k) {
        if (change(static_cast<HalfEdge>(3 * t + k))) ++changed;
      }
    });
    return changed;
  }

  /// Cuts the longest edges of triangles that are too far from the surface.
  void split_far() {
    const std::size_t count = mesh_.mesh().triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      if (!mesh_.alive(t)) continue;
      const auto [a, b, c] = mesh_.mesh().triangles[t];
      if (std::max({a, b, c}) >= at_.metrics.size()) continue;
      if (!(rules_.deviation_of(a, b, c) > rules_.slack_of(a, b, c, kFar) * options_.tolerance)) {
        continue;
      }
      const auto first = static_cast<HalfEdge>(3 * t);
      HalfEdge longest = first;
      for (const HalfEdge h : {first + 1, first + 2}) {
        if (rules_.length_of(h) > rules_.length_of(longest)) longest = h;
      }
      const HalfEdge beyond = next_in_triangle(mesh_.opposite(longest));
      if (end(beyond) >= at_.metrics.size()) continue;
      split(longest);
    }
    sort_by_place();
  }

  /// Puts a vertex on the surface above the middle of an edge, as far as the normals tell.
  void split(HalfEdge h) {
    const Index a = start(h), b = end(h);
    const Vec3d sum = at_.normals[a] + at_.normals[b];
    const double length = norm(sum);
    if (!(length > RemeshRules::kTurn)) return;
    const Vec3d n = sum / length;
    mesh_.split_edge(h, 0.5 * (position(a) + position(b)) + rules_.sagitta_of(a, b) * n);
    at_.normals.push_back(n);
    at_.cells.push_back(at_.cells[a]);
    leaf_of_.push_back(leaf_of_[a]);
    last_step_.push_back(0.0);
    used_.push_back(true);
  }

  /// Makes edges locally Delaunay where that keeps the mesh near the surface, in two sweeps, the
  /// second over the edges of triangles that the first changed.
  void flip_edges() {
    std::vector<char> changed(mesh_.mesh().triangles.size(), 0);
    const auto flip = [&](HalfEdge h) {
      const HalfEdge back = mesh_.opposite(h);
      if (!rules_.should_flip(h) || !mesh_.flip_edge(h)) return false;
      changed[triangle_of(h)] = changed[triangle_of(back)] = 1;
      return true;
    };
    statistics.flips += change_edges([&](HalfEdge h) { return mesh_.opposite(h) > h && flip(h); });
    for (std::size_t t = 0; t < changed.size(); ++t) {
      for (std::size_t k = 0; changed[t] != 0 && k < 3; ++k) {
        const auto h = static_cast<HalfEdge>(3 * t + k);
        const std::size_t beyond = triangle_of(mesh_.opposite(h));
        if ((beyond > t || changed[beyond] == 0) && flip(h)) ++statistics.flips;
      }
    }
  }

  /// Moves vertices and flips edges so that triangles are equally far from the surface.
  void spread() {
    constexpr int kSweeps = 6;
    constexpr double kSmoothShare = 0.9;  // along grooves, measuring has to cut again what comes
    if (smooth_share(mesh_, at_.normals) < kSmoothShare) return;
    find_metrics();
    std::vector<SpreadVertex> vertices;
    vertices.reserve(at_.shapes.size());
    for (Index v = 0; v < at_.shapes.size(); ++v) {
      vertices.push_back({at_.shapes[v], rules_.allowed(v), rules_.lift(v)});
    }
    spread_error(mesh_, at_.normals, vertices, kSweeps);
    project(1);
  }

  // ---- Moving ----

  /// Moves vertices and flips edges in turns.
  void even_out() {
    flip_edges();
    for (int round = 0; round < kMoves; ++round) {
      relax();
      flip_edges();
    }
    const std::vector<Vec3d> old_points = mesh_.mesh().positions, old_normals = at_.normals;
    project(1);
    take_back(MeshBlocks(mesh_.mesh()), old_points, old_normals);
  }

  /// Moves every vertex to the mean of the circumcentres of its triangles, all measured as the
  /// surface bends (Chen, "Mesh smoothing schemes based on optimal Delaunay triangulations", 2004),
  /// where no triangle is the worse for it.
  void relax() {
    std::vector<Vec3d> sum(at_.normals.size(), Vec3d{});
    std::vector<double> weight(at_.normals.size(), 0.0);
    const MeshBlocks blocks(mesh_.mesh());
    blocks.for_each_triangle(Depth::inner, [&](std::size_t triangle) {
      const auto& t = mesh_.mesh().triangles[triangle];
      const MeasuredTriangle seen = rules_.measured(t[0], t[1], t[2]);
      const double dense =
          at_.metrics[t[0]].density + at_.metrics[t[1]].density + at_.metrics[t[2]].density;
      const double mass = dense * seen.area();
      const Vec3d centre = position(t[0]) + seen.to_centre();
      for (const Index v : t) {
        sum[v] += mass * (centre - position(v));
        weight[v] += mass;
      }
    });
    const std::vector<Vec3d> old_points = mesh_.mesh().positions, old_normals = at_.normals;
    tbb::parallel_for(std::size_t{0}, order_.size(), [&](std::size_t i) {
      const Index v = order_[i];
      if (weight[v] > 0) move_along(v, sum[v] / weight[v]);
    });
    take_back(blocks, old_points, old_normals);
  }

  /// Moves a vertex as far as the surface and its normal can be told from how it bends there.
  void move_along(Index v, const Vec3d& way) {
    constexpr double kMostTurn = 0.3;
    const Vec3d step = bounded(way - dot(way, at_.normals[v]) * at_.normals[v], v);
    const Vec3d turn = at_.shapes[v] * step;
    if (!(squared_norm(turn) < kMostTurn * kMostTurn)) return;
    mesh_.move_vertex(v, position(v) + step - 0.5 * dot(step, turn) * at_.normals[v]);
    at_.normals[v] = normalized(at_.normals[v] + turn);
  }

  /// Returns the vertices of triangles that turned over, until there are none or all are back.
  void take_back(const MeshBlocks& blocks, std::span<const Vec3d> points,
                 std::span<const Vec3d> normals) {
    constexpr std::uint8_t kMostRounds = 8;
    std::vector<std::uint8_t> back(normals.size(), 0);  // since which round
    for (std::uint8_t round = 1; round <= kMostRounds; ++round) {
      std::atomic<bool> any = false;
      blocks.for_each_triangle(Depth::inner, [&](std::size_t triangle) {
        const auto& t = mesh_.mesh().triangles[triangle];
        // One that none came back to since is as good as it was found.
        if (std::max({back[t[0]], back[t[1]], back[t[2]]}) + 1 < round) return;
        if (!rules_.is_worse(t, points)) return;
        for (const Index v : t) {
          if (back[v] != 0) continue;
          back[v] = round;
          any = true;
          mesh_.move_vertex(v, points[v]);
          at_.normals[v] = normals[v];
        }
      });
      if (!any) break;
    }
  }

  static constexpr int kFittings = 3;       ///< rounds of splitting what is too far, at the end
  static constexpr int kMoves = 3;          ///< of all vertices, in each round
  static constexpr double kStrict = 1.2;    ///< the same at last
  static constexpr double kFar = 0.97;      ///< of the tolerance, beyond which triangles are split
  static constexpr double kShortest = 0.8;  ///< of the length that suits the curvature
  /// Most ratio of curvatures that triangles follow, at first and last.
  static constexpr double kStretch = 4.0, kLastStretch = 3.0;
  const ImplicitSurface& surface_;
  const SurfaceOctree& tree_;
  const RemeshOptions& options_;
  std::vector<Octree::Index> leaf_of_;
  EditableMesh mesh_;
  SurfaceAtVertices at_;
  RemeshRules rules_;
  std::vector<double> last_step_;  ///< on the way to the surface
  std::vector<Index> order_;
  std::vector<bool> used_;
  double stretch_ = kStretch;  ///< most ratio of curvatures that triangles follow
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
