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
#include "polygonize/fold.h"
#include "polygonize/leaf_jets.h"
#include "polygonize/measured_triangle.h"
#include "polygonize/mend_folds.h"
#include "polygonize/mesh_blocks.h"
#include "polygonize/near_root.h"
#include "polygonize/points_half_way.h"
#include "polygonize/sagitta.h"
#include "polygonize/shape_operator.h"
#include "polygonize/spread_error.h"
#include "polygonize/triangle_sample.h"
#include "polygonize/triangle_shape.h"

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
        normals_(leaf_of.size()),
        last_step_(leaf_of.size(), 0.0),
        used_(leaf_of.size(), true) {
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
    sound_ = tangent_of(kThinAngle + 1);
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
    const auto heights = balanced_heights(mesh_.mesh(), normals_, kMost * options_.tolerance);
    for (Index v = 0; v < normals_.size(); ++v) {
      if (used_[v]) mesh_.move_vertex(v, position(v) + heights[v] * normals_[v]);
    }
  }

  void mend_folds() {
    const FoldsMended mended = cs2mesh::mend_folds(mesh_, normals_, kTurn);
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
    std::vector<Index> kept;
    mesh_ = EditableMesh(mesh_.take(&kept));
    const auto keep = [&](auto& of_vertex) {
      for (std::size_t v = 0; v < kept.size(); ++v) of_vertex[v] = of_vertex[kept[v]];
      of_vertex.resize(kept.size());
    };
    keep(normals_), keep(leaf_of_), keep(shapes_), keep(metrics_), keep(last_step_), keep(used_);
    sort_by_place();
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

  // ---- Vertices and the surface ----

  /// Puts down where the surface is: at the vertices, and where it turns much between two of them
  /// half way too.
  void remember_surface() {
    const double close = 0.01 * options_.tolerance;
    for (const Index v : order_) {
      if (last_step_[v] <= close) statistics.on_surface.push_back(position(v));
    }
    const std::vector<Vec3d> between =
        points_half_way(surface_, tree_, mesh_.mesh(), normals_, leaf_of_, close);
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
        if (last_step_[v] > kThere * side_at(v)) open[kept++] = v;
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
      const double share = last_step_[v] / side_at(v);
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
      lines.push_back({position(v), normals_[v], last_step_[v], side_at(v)});
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
    normals_[v] = -1.0 / slope * jet.gradient;
    const Vec3d step = bounded(-leveled(jet.value) / slope * normals_[v], v);
    mesh_.move_vertex(v, point - step);
    return std::max(norm(step), norm(bounded(jet.value / slope * normals_[v], v)));
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
  DeviationRange range_of(Index a, Index b, Index c) const {
    return deviation_range(sagitta_of(a, b), sagitta_of(b, c), sagitta_of(c, a));
  }
  /// How far a triangle is from the surface; balanced, how far it would be if it were lifted.
  double deviation_of(Index a, Index b, Index c) const {
    return distance_from(range_of(a, b, c), (lift(a) + lift(b) + lift(c)) / 3);
  }
  /// How far triangles at a vertex may be from the surface: where cells are small, other sheets may
  /// be near.
  double allowed(Index v, double slack = 1.0) const {
    constexpr double kCellShare = 0.5;
    return std::min(slack * kFit * options_.tolerance, kCellShare * side_at(v));
  }
  /// Where the surface is smooth, moving spreads the error: triangles may be farther at first.
  double slack_of(Index a, Index b, Index c, double most) const {
    const bool smooth = dot(normals_[a], normals_[b]) > kSmooth &&
                        dot(normals_[b], normals_[c]) > kSmooth &&
                        dot(normals_[c], normals_[a]) > kSmooth;
    return smooth ? most : std::min(most, kRough);
  }
  bool is_near(Index a, Index b, Index c, double most) const {
    const double slack = slack_of(a, b, c, most);
    return deviation_of(a, b, c) <=
           std::min({allowed(a, slack), allowed(b, slack), allowed(c, slack)});
  }

  /// How the surface bends at each vertex, by the normals around.
  void find_metrics() {
    shapes_ = shape_operators(mesh_.mesh(), normals_);
    metrics_.resize(shapes_.size());
    tbb::parallel_for(std::size_t{0}, shapes_.size(), [&](std::size_t v) {
      metrics_[v] = bend_metric(shapes_[v], normals_[v], stretch_);
    });
  }

  /// As of distance_from(): over saddles the surface is as far above as below anyway.
  double lift(Index v) const {
    constexpr double kSteep = 4.0;
    return options_.balance ? std::clamp(1 + kSteep * metrics_[v].ratio, 0.0, 1.0) : 0.0;
  }

  /// The squared length of an edge, 1 where it is what suits the curvature.
  double length_of(HalfEdge h) const {
    const Index a = start(h), b = end(h);
    const Vec3d edge = position(b) - position(a);
    const auto at = [&](Index v) {
      // Where the principal curvatures differ, a triangle is nearer than on a sphere of the
      // greater.
      const double gain = 1 + (1 - std::max(metrics_[v].ratio, 0.0)) / 3;
      return dot(edge, metrics_[v].form * edge) /
             (6 * gain * (1 + lift(v)) * kFit * options_.tolerance);
    };
    return std::max(at(a), at(b));
  }

  void collapse_short(double share) {
    const double slack = share < kInfinity ? kSlack : kStrict;
    statistics.collapses += change_edges([&](HalfEdge h) {
      if (!(length_of(h) < share * share) || !may_collapse(h, slack)) return false;
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

  /// Whether the triangles that stay around the start of h would be near the surface, face its way,
  /// and be shaped no worse than is tolerable or than they were.
  bool may_collapse(HalfEdge h, double slack) const {
    constexpr double kShape = 0.35;
    const Index a = start(h), b = end(h);
    const HalfEdge back = mesh_.opposite(h);
    bool fits = dot(normals_[a], normals_[b]) > kTurn;
    double worst = 1.0, worst_now = 1.0;
    double angle = sound_, angle_now = sound_;
    int neighbours = 0;
    mesh_.for_ring(h, [&](HalfEdge turn) {
      ++neighbours;
      if (!fits) return;
      const Index c = end(turn), d = end(next_in_triangle(turn));
      worst_now = std::min(worst_now, quality(a, c, d));
      angle_now = std::min(angle_now, angle_of(a, c, d));
      if (turn == h || triangle_of(turn) == triangle_of(back)) return;
      fits = faces_outward(b, c, d) && is_near(b, c, d, slack) && near_vertex(a, b, c, d, slack);
      worst = std::min(worst, quality(b, c, d));
      angle = std::min(angle, angle_of(b, c, d));
    });
    // Of three neighbours one triangle would be left, which in grooves often crosses others.
    return fits && neighbours > 3 && angle >= angle_now && (worst > kShape || worst > worst_now) &&
           mesh_.can_collapse(h);
  }

  /// Whether the plane of a triangle passes within the tolerance of a vertex, along its normal.
  bool near_vertex(Index v, Index a, Index b, Index c, double slack) const {
    const Vec3d area = cross(position(b) - position(a), position(c) - position(a));
    const double height = dot(area, position(v) - position(a));
    return std::abs(height) <= (1 + lift(v)) * allowed(v, slack_of(a, b, c, slack)) * norm(area);
  }

  Symmetric3 form_of(Index a, Index b, Index c) const {
    return metrics_[a].form + metrics_[b].form + metrics_[c].form;
  }

  /// A triangle, seen from a, as the surface measures it.
  MeasuredTriangle measured(const Symmetric3& form, Index a, Index b, Index c) const {
    return {form, position(b) - position(a), position(c) - position(a)};
  }
  double quality(Index a, Index b, Index c) const {
    return measured(form_of(a, b, c), a, b, c).quality();
  }

  /// Cuts the longest edges of triangles that are too far from the surface.
  void split_far() {
    const std::size_t count = mesh_.mesh().triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      if (!mesh_.alive(t)) continue;
      const auto [a, b, c] = mesh_.mesh().triangles[t];
      if (std::max({a, b, c}) >= metrics_.size()) continue;
      if (!(deviation_of(a, b, c) > slack_of(a, b, c, kFar) * options_.tolerance)) continue;
      const auto first = static_cast<HalfEdge>(3 * t);
      HalfEdge longest = first;
      for (const HalfEdge h : {first + 1, first + 2}) {
        if (length_of(h) > length_of(longest)) longest = h;
      }
      const HalfEdge beyond = next_in_triangle(mesh_.opposite(longest));
      if (end(beyond) >= metrics_.size()) continue;
      split(longest);
    }
    sort_by_place();
  }

  /// Puts a vertex on the surface above the middle of an edge, as far as the normals tell.
  void split(HalfEdge h) {
    const Index a = start(h), b = end(h);
    const Vec3d sum = normals_[a] + normals_[b];
    const double length = norm(sum);
    if (!(length > kTurn)) return;
    const Vec3d n = sum / length;
    mesh_.split_edge(h, 0.5 * (position(a) + position(b)) + sagitta_of(a, b) * n);
    normals_.push_back(n);
    leaf_of_.push_back(leaf_of_[a]);
    last_step_.push_back(0.0);
    used_.push_back(true);
  }

  bool faces_outward(Index a, Index b, Index c) const {
    return faces_normals(mesh_.mesh().positions, normals_, {a, b, c}, kTurn);
  }

  /// Makes edges locally Delaunay where that keeps the mesh near the surface.
  void flip_edges() {
    for (int sweep = 0; sweep < 2; ++sweep) {
      const std::size_t flipped = change_edges([&](HalfEdge h) {
        return mesh_.opposite(h) > h && should_flip(h) && mesh_.flip_edge(h);
      });
      statistics.flips += flipped;
      if (flipped == 0) break;
    }
  }

  bool should_flip(HalfEdge h) const {
    const HalfEdge back = mesh_.opposite(h);
    const Index a = start(h), b = end(h);
    const Index c = end(next_in_triangle(h)), d = end(next_in_triangle(back));
    if (c == d) return false;
    const Symmetric3 form = form_of(a, b, c) + metrics_[d].form;
    const double both = measured(form, c, a, b).cotangent() + measured(form, d, b, a).cotangent();
    if (!(both < -1e-9)) return false;
    if (!faces_outward(d, c, a) || !faces_outward(c, d, b)) return false;
    const double angle = std::min(angle_of(d, c, a), angle_of(c, d, b));
    if (angle < sound_ && angle < std::min(angle_of(a, b, c), angle_of(b, a, d))) return false;
    const double now = std::max(deviation_of(a, b, c), deviation_of(b, a, d));
    const double then = std::max(deviation_of(d, c, a), deviation_of(c, d, b));
    return !(then > now && then > kFit * options_.tolerance);
  }

  /// The tangent of the smallest angle.
  double angle_of(Index a, Index b, Index c) const {
    return tangent_of_smallest_angle(position(a), position(b), position(c));
  }

  /// Moves vertices and flips edges so that triangles are equally far from the surface.
  void spread() {
    constexpr int kSweeps = 6;
    constexpr double kSmoothShare = 0.9;  // along grooves, measuring has to cut again what comes
    if (smooth_share(mesh_, normals_) < kSmoothShare) return;
    find_metrics();
    std::vector<SpreadVertex> vertices;
    vertices.reserve(shapes_.size());
    for (Index v = 0; v < shapes_.size(); ++v) {
      vertices.push_back({shapes_[v], allowed(v), lift(v)});
    }
    spread_error(mesh_, normals_, vertices, kSweeps);
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
    const std::vector<Vec3d> old_points = mesh_.mesh().positions, old_normals = normals_;
    project(1);
    take_back(MeshBlocks(mesh_.mesh()), old_points, old_normals);
  }

  /// Moves every vertex to the mean of the circumcentres of its triangles, all measured as the
  /// surface bends (Chen, "Mesh smoothing schemes based on optimal Delaunay triangulations", 2004),
  /// where no triangle is the worse for it.
  void relax() {
    std::vector<Vec3d> sum(normals_.size(), Vec3d{});
    std::vector<double> weight(normals_.size(), 0.0);
    const MeshBlocks blocks(mesh_.mesh());
    blocks.for_each_triangle(Depth::inner, [&](std::size_t triangle) {
      const auto& t = mesh_.mesh().triangles[triangle];
      const Symmetric3 form = form_of(t[0], t[1], t[2]);
      const double dense = metrics_[t[0]].density + metrics_[t[1]].density + metrics_[t[2]].density;
      for (std::size_t k = 0; k < 3; ++k) {
        const MeasuredTriangle seen = measured(form, t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
        const double mass = dense * seen.area();
        sum[t[k]] += mass * seen.to_centre();
        weight[t[k]] += mass;
      }
    });
    const std::vector<Vec3d> old_points = mesh_.mesh().positions, old_normals = normals_;
    tbb::parallel_for(std::size_t{0}, order_.size(), [&](std::size_t i) {
      const Index v = order_[i];
      if (weight[v] > 0) move_along(v, sum[v] / weight[v]);
    });
    take_back(blocks, old_points, old_normals);
  }

  /// Moves a vertex as far as the surface and its normal can be told from how it bends there.
  void move_along(Index v, const Vec3d& way) {
    constexpr double kMostTurn = 0.3;
    const Vec3d step = bounded(way - dot(way, normals_[v]) * normals_[v], v);
    const Vec3d turn = shapes_[v] * step;
    if (!(squared_norm(turn) < kMostTurn * kMostTurn)) return;
    mesh_.move_vertex(v, position(v) + step - 0.5 * dot(step, turn) * normals_[v]);
    normals_[v] = normalized(normals_[v] + turn);
  }

  /// Whether a triangle should not be as it is, after its corners were moved from these points.
  bool worse(const std::array<Index, 3>& t, std::span<const Vec3d> points) const {
    if (!faces_outward(t[0], t[1], t[2])) return true;
    if (deviation_of(t[0], t[1], t[2]) > slack_of(t[0], t[1], t[2], kSlack) * options_.tolerance) {
      return true;
    }
    const double angle = angle_of(t[0], t[1], t[2]);
    return angle < sound_ &&
           angle < tangent_of_smallest_angle(points[t[0]], points[t[1]], points[t[2]]);
  }

  /// Returns the vertices of triangles that turned over, until there are none or all are back.
  void take_back(const MeshBlocks& blocks, std::span<const Vec3d> points,
                 std::span<const Vec3d> normals) {
    std::vector<char> back(normals.size(), 0);
    constexpr int kMostRounds = 8;
    for (int round = 0; round < kMostRounds; ++round) {
      std::atomic<bool> any = false;
      blocks.for_each_triangle(Depth::inner, [&](std::size_t triangle) {
        const auto& t = mesh_.mesh().triangles[triangle];
        // One that none came back to is as good as the first round found it.
        if (round > 0 && back[t[0]] + back[t[1]] + back[t[2]] == 0) return;
        if (!worse(t, points)) return;
        for (const Index v : t) {
          if (back[v] != 0) continue;
          back[v] = 1;
          any = true;
          mesh_.move_vertex(v, points[v]);
          normals_[v] = normals[v];
        }
      });
      if (!any) break;
    }
  }

  static constexpr int kFittings = 3;       ///< rounds of splitting what is too far, at the end
  static constexpr int kMoves = 3;          ///< of all vertices, in each round
  static constexpr double kFit = 0.86;      ///< of the tolerance, which collapsing aims at
  static constexpr double kSlack = 1.6;     ///< times that, at first: moving spreads the error
  static constexpr double kStrict = 1.2;    ///< the same at last
  static constexpr double kRough = 0.6;     ///< the same where normals turn much between corners
  static constexpr double kFar = 0.97;      ///< of the tolerance, beyond which triangles are split
  static constexpr double kShortest = 0.8;  ///< of the length that suits the curvature
  /// Most ratio of curvatures that triangles follow, at first and last.
  static constexpr double kStretch = 4.0, kLastStretch = 3.0;
  static constexpr double kTurn = 0.2;  ///< least cosine between a triangle and its normals
  const ImplicitSurface& surface_;
  const SurfaceOctree& tree_;
  const RemeshOptions& options_;
  std::vector<Octree::Index> leaf_of_;
  EditableMesh mesh_;
  std::vector<Vec3d> normals_;
  std::vector<Symmetric3> shapes_;
  std::vector<BendMetric> metrics_;
  std::vector<double> last_step_;  ///< on the way to the surface
  std::vector<Index> order_;
  std::vector<bool> used_;
  /// The tangent of the angle below which none is made of better ones.
  double sound_ = tangent_of(kThinAngle);
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
