#include "polygonize/polygon_mesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "libfield/base/check.h"
#include "polygonize/check.h"
#include "polygonize/lattice_cells.h"
#include "polygonize/self_intersection.h"
#include "polygonize/surface_projection.h"
#include "polygonize/triangle_sample.h"
#include "polygonize/unfold.h"

namespace cs2mesh {
namespace {

using Index = PolygonMesh::Index;
using Triangle = std::array<Index, 3>;

/// Vertices or polygons treated together through one restriction of F.
constexpr std::size_t kChunk = 256;

template <class F>
void for_each_chunk(std::size_t count, const Progress* progress, const F& f) {
  tbb::parallel_for(std::size_t{0}, (count + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    if (!cancelled(progress)) f(kChunk * chunk, std::min(kChunk * (chunk + 1), count));
  });
}

Diagnostic interrupted() {
  return error_at({}, "interrupted", Failure::interrupted);
}

Vec3d normal(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return cross(b - a, c - a);
}

/// How well the two triangles that the diagonal from p[0] to p[2] makes of a quadrilateral face the
/// outside: the lesser cosine between their normals and that of the surface.
double facing(const std::array<Vec3d, 4>& p, const Vec3d& gradient) {
  const double slope = norm(gradient);
  double least = 1.0;
  for (const Vec3d& n : {normal(p[0], p[1], p[2]), normal(p[0], p[2], p[3])}) {
    const double lengths = norm(n) * slope;
    least = std::min(least, lengths > 0 ? -dot(n, gradient) / lengths : -1.0);
  }
  return least;
}

class Settler {
 public:
  Settler(const ImplicitSurface& surface, PolygonMesh polygons, const SettleOptions& options)
      : surface_(surface), polygons_(std::move(polygons)), options_(options) {
    require(options.reach > 0, "settle: the reach must be positive");
    require(polygons_.fixed.empty() || polygons_.fixed.size() == polygons_.positions.size(),
            "settle: all vertices or none are marked");
    require(polygons_.retreats.empty() || polygons_.retreats.size() == polygons_.positions.size(),
            "settle: all vertices or none have retreats");
  }

  Result<TriangleMesh> run() {
    mesh_.positions = polygons_.positions;
    normals_.resize(mesh_.positions.size());
    on_surface_.assign(mesh_.positions.size(), 0);
    for_each_chunk(mesh_.positions.size(), options_.progress,
                   [this](std::size_t first, std::size_t last) { move_to_surface(first, last); });
    cut();
    if (cancelled(options_.progress)) return interrupted();
    std::optional<Diagnostic> defect = find_defect();
    if (defect) return *defect;
    unfold(mesh_, normals_);
    const bool crossing_free = uncross();
    if (cancelled(options_.progress)) return interrupted();
    if (!crossing_free) {
      return error_at({}, "triangles cross where the cells are too large for the surface",
                      Failure::check_failed);
    }
    defect = find_defect();
    if (defect) return *defect;
    measure_vertices();
    return std::move(mesh_);
  }
  SettleCounts counts() const {
    return {2 * (polygons_.positions.size() + quadrilaterals_), off_surface_};
  }

 private:
  void move_to_surface(std::size_t first, std::size_t last) {
    std::vector<std::size_t> movable;
    std::vector<Vec3d> points;
    Aabb box;
    for (std::size_t v = first; v < last; ++v) {
      if (!polygons_.fixed.empty() && polygons_.fixed[v] != 0) continue;
      movable.push_back(v);
      points.push_back(polygons_.positions[v]);
      box.include(points.back());
    }
    if (points.empty()) return;
    constexpr double kMostlyWithin = 0.25;  // of the reach
    box = box.grown(kMostlyWithin * options_.reach);
    std::vector<Projection> feet(points.size());
    project(surface_, *surface_.restrict_to(box), box, points, options_.reach, feet);
    for (std::size_t i = 0; i < feet.size(); ++i) {
      if (!(feet[i].distance <= options_.reach)) continue;
      mesh_.positions[movable[i]] = feet[i].foot;
      on_surface_[movable[i]] = 1;
      const double slope = norm(feet[i].gradient);
      if (slope > 0) normals_[movable[i]] = feet[i].gradient / -slope;
    }
  }

  // ---- Cutting ----

  std::array<Vec3d, 4> places(std::span<const Index> quadrilateral) const {
    std::array<Vec3d, 4> p;
    for (std::size_t k = 0; k < 4; ++k) p[k] = mesh_.positions[quadrilateral[k]];
    return p;
  }

  /// For each quadrilateral of the range whether the diagonal from its second corner is better.
  void choose_diagonals(std::size_t first, std::size_t last) {
    std::vector<std::size_t> open;
    std::vector<Vec3d> middles;
    Aabb box;
    for (std::size_t i = first; i < last; ++i) {
      const std::span<const Index> polygon = polygons_.polygon(i);
      if (polygon.size() != 4) continue;
      const std::array<Vec3d, 4> p = places(polygon);
      open.push_back(i);
      for (std::size_t k = 0; k < 2; ++k) {
        middles.push_back(0.5 * (p[k] + p[k + 2]));
        box.include(middles.back());
      }
    }
    if (open.empty()) return;
    std::vector<Jet> jets(middles.size());
    surface_.restrict_to(box)->jets(middles, jets);
    for (std::size_t k = 0; k < open.size(); ++k) {
      second_[open[k]] =
          second_is_better(places(polygons_.polygon(open[k])), jets[2 * k], jets[2 * k + 1]) ? 1
                                                                                             : 0;
    }
  }

  static bool second_is_better(const std::array<Vec3d, 4>& p, const Jet& first, const Jet& second) {
    // A triangle that looks inwards is worth taking where the other diagonal is much farther from
    // the surface, as across a crease.
    constexpr double kMuch = 0.1;
    const double longest = std::max(norm(p[2] - p[0]), norm(p[3] - p[1]));
    const double d1 = first_order_distance(first, longest);
    const double d2 = first_order_distance(second, longest);
    if (std::abs(d1 - d2) < kMuch * longest) {
      const double face1 = facing(p, first.gradient);
      const double face2 = facing({p[1], p[2], p[3], p[0]}, second.gradient);
      if ((face1 < 0) != (face2 < 0)) return face1 < 0;
    }
    return d2 < d1;
  }

  void cut() {
    second_.assign(polygons_.size(), 0);
    for_each_chunk(polygons_.size(), options_.progress,
                   [this](std::size_t first, std::size_t last) { choose_diagonals(first, last); });
    mesh_.triangles.resize(polygons_.triangle_count());
    Triangle* out = mesh_.triangles.data();
    std::vector<Index> rest;
    for (std::size_t i = 0; i < polygons_.size(); ++i) {
      const std::span<const Index> p = polygons_.polygon(i);
      if (p.size() == 4) {
        ++quadrilaterals_;
        const std::size_t s = second_[i] != 0 ? 1 : 0;
        *out++ = {p[s], p[s + 1], p[s + 2]};
        *out++ = {p[s], p[s + 2], p[(s + 3) % 4]};
      } else {
        rest.assign(p.begin(), p.end());
        triangulate(rest, mesh_.positions, out);
      }
    }
  }

  // ---- What came of it ----

  std::optional<Diagnostic> find_defect() const {
    CheckOptions cheap;
    cheap.self_intersections = false;
    cheap.max_defects = 1;
    const MeshReport report = check(mesh_, cheap);
    if (report.ok()) return std::nullopt;
    return error_at({},
                    "the mesh has a defect, a " + std::string(name(report.defects.front().kind)),
                    Failure::check_failed);
  }

  void measure_vertices() {
    std::vector<double> distances(mesh_.positions.size(), 0.0);
    tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t v) {
      if (on_surface_[v] != 0 || cancelled(options_.progress)) return;
      const Vec3d& p = mesh_.positions[v];
      const double first_order = first_order_distance(surface_.jet(p), options_.reach);
      distances[v] = find_foot(surface_, p, first_order).distance;
    });
    for (const double distance : distances) off_surface_ = std::max(off_surface_, distance);
  }

  // ---- Crossing triangles ----

  /// Moves the corners of triangles that cross out of each other's way; false if there are
  /// still such triangles then. True in a build that cannot tell.
  bool uncross() {
    constexpr int kRounds = 4;
    constexpr std::size_t kMostPairs = 100'000;
    const auto& back = polygons_.retreats.empty() ? polygons_.positions : polygons_.retreats;
    for (int round = 0; round < kRounds && !cancelled(options_.progress); ++round) {
      const auto found = find_self_intersections(mesh_, kMostPairs);
      if (!found || found->count == 0) return true;
      bool changed = false;
      for (const auto& pair : found->pairs) {
        for (const Index t : pair) {
          for (const Index v : mesh_.triangles[t]) {
            changed = changed || mesh_.positions[v] != back[v];
            mesh_.positions[v] = back[v];
            on_surface_[v] = 0;
          }
        }
      }
      if (!changed) return false;
    }
    return false;
  }

  const ImplicitSurface& surface_;
  PolygonMesh polygons_;
  const SettleOptions& options_;
  TriangleMesh mesh_;
  std::vector<Vec3d> normals_;  ///< of the surface at the vertices moved
  std::vector<char> second_;    ///< by polygon: whether it is cut from its second corner
  std::size_t quadrilaterals_ = 0;
  std::vector<char> on_surface_;  ///< by vertex: whether it was moved there, and left there
  double off_surface_ = 0.0;
};

}  // namespace

Result<TriangleMesh> settle(const ImplicitSurface& surface, PolygonMesh polygons,
                            const SettleOptions& options, SettleCounts& counts) {
  Settler settler(surface, std::move(polygons), options);
  Result<TriangleMesh> mesh = settler.run();
  counts = settler.counts();
  return mesh;
}

}  // namespace cs2mesh
