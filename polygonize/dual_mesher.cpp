#include "polygonize/dual_mesher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/lattice_cut.h"
#include "polygonize/plane_fit.h"
#include "polygonize/polygon_mesh.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// The tangent plane of {F = 0} near a point, to first order.
Plane tangent_plane(const Vec3d& p, const Jet& jet) {
  const double slope = norm(jet.gradient);
  const Vec3d normal = jet.gradient / slope;
  return {normal, dot(normal, p) - jet.value / slope};
}

/// The least cosine between the normals of two of the planes; 1 where one of them is not a number.
double least_cosine(std::span<const Plane> planes) {
  double least = 1.0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double cosine = dot(planes[i].normal, planes[j].normal);
      if (!std::isfinite(cosine)) return 1.0;
      least = std::min(least, cosine);
    }
  }
  return least;
}

class DualMesher {
 public:
  DualMesher(LatticeCut& cut, const Progress* progress) : cut_(cut), progress_(progress) {}

  /// False if cancelled.
  bool run() { return collect() && find_tangents() && place_vertices() && join(); }
  PolygonMesh take() { return std::move(dual_); }
  std::size_t jets() const { return std::accumulate(jets_.begin(), jets_.end(), std::size_t{0}); }

 private:
  /// A corner of a primal polygon, seen from its vertex: the vertices beside it, and the polygon.
  struct Corner {
    Index before = 0, after = 0, polygon = 0;
  };

  /// The polygons of all blocks, and where those of each begin.
  bool collect() {
    const std::size_t count = cut_.cells.blocks().size();
    polygons_.resize(count);
    jets_.assign(count, 0);
    const bool done = for_each_block(
        count, progress_, [this](std::size_t b) { polygons_[b] = cut_.cells.polygons(b); });
    first_.assign(count + 1, 0);
    for (std::size_t b = 0; b < count; ++b) {
      first_[b + 1] = first_[b] + static_cast<Index>(polygons_[b].size());
    }
    return done;
  }

  bool find_tangents() {
    tangents_.resize(cut_.crossings.size());
    return for_each_block(polygons_.size(), progress_, [this](std::size_t b) {
      const BlockCells& block = cut_.cells.blocks()[b];
      const std::span points =
          std::span(cut_.crossings).subspan(block.first_vertex, block.vertices);
      std::vector<Jet> jets(points.size());
      cut_.band.surface(b).jets(points, jets);
      jets_[b] += jets.size();
      for (std::size_t i = 0; i < jets.size(); ++i) {
        tangents_[block.first_vertex + i] = tangent_plane(points[i], jets[i]);
      }
    });
  }

  // ---- A vertex for each primal polygon ----

  bool place_vertices() {
    dual_.positions.resize(first_.back());
    dual_.retreats.resize(first_.back());
    dual_.fixed.assign(first_.back(), 0);
    return for_each_block(polygons_.size(), progress_, [this](std::size_t b) {
      for (std::size_t i = 0; i < polygons_[b].size(); ++i) place_vertex(b, i);
    });
  }

  void place_vertex(std::size_t block, std::size_t i) {
    const std::span<const std::uint32_t> polygon = polygons_[block].polygon(i);
    std::vector<Plane> planes;
    std::vector<Vec3d> points;
    Vec3d middle{};
    for (const std::uint32_t v : polygon) {
      planes.push_back(tangents_[v]);
      points.push_back(cut_.crossings[v]);
      middle += points.back();
    }
    middle = middle / static_cast<double>(polygon.size());
    Vec3d& position = dual_.positions[first_[block] + i];
    position = middle;
    dual_.retreats[first_[block] + i] = middle;
    // Surfaces that turn by this much (25 degrees) within a cell are looked at more closely.
    constexpr double kTurns = 0.9;
    if (polygons_[block].whole[i] == 0 || least_cosine(planes) > kTurns) return;
    if (find_crease(block, cell_box(block, polygons_[block].offsets[i]), points, planes,
                    position)) {
      dual_.fixed[first_[block] + i] = 1;
    }
  }

  Aabb cell_box(std::size_t block, int offset) const {
    const Int3 low = Lattice::kBlockCells * cut_.band.coord(block) + local_node(offset);
    const Lattice& lattice = cut_.band.lattice();
    return {lattice.node(low), lattice.node(low + Int3{1, 1, 1})};
  }

  /// Looks for the crease that the planes at these points of a cell speak of; true, and the point
  /// of it nearest to `position`, if there is one in the cell.
  bool find_crease(std::size_t block, const Aabb& cell, std::span<const Vec3d> points,
                   std::vector<Plane>& planes, Vec3d& position) {
    constexpr double kSharp = 0.97;  // 14 degrees: what is smooth turns far less that near
    constexpr double kNear = 0.01;   // of a cell
    constexpr std::array<double, 3> kShares{0.25, 0.0625, 0.015625};
    constexpr std::array<double, 4> kCutoffs{0.1, 0.03, 0.01, 0.01};
    const ImplicitSurface& surface = cut_.band.surface(block);
    Vec3d x = cell.clamp(point_near_planes(planes, position, kCutoffs[0]));
    std::vector<Vec3d> nearer(points.size());
    std::vector<Jet> jets(points.size());
    for (std::size_t round = 0; round < kShares.size(); ++round) {
      for (std::size_t k = 0; k < points.size(); ++k) {
        nearer[k] = x + kShares[round] * (points[k] - x);
      }
      surface.jets(nearer, jets);
      jets_[block] += jets.size();
      for (std::size_t k = 0; k < points.size(); ++k) planes[k] = tangent_plane(nearer[k], jets[k]);
      if (least_cosine(planes) > kSharp) return false;
      x = point_near_planes(planes, position, kCutoffs[round + 1]);
      if (round + 1 < kShares.size()) x = cell.clamp(x);
    }
    if (!cell.contains(x)) return false;
    ++jets_[block];
    const double side = cut_.band.lattice().cell;
    if (!(first_order_distance(surface.jet(x), side) < kNear * side)) return false;
    position = x;
    return true;
  }

  // ---- A polygon for each primal vertex ----

  bool join() {
    gather_corners();
    const std::size_t count = cut_.crossings.size();
    dual_.corners.reserve(corners_.size());
    dual_.ends.reserve(count);
    for (std::size_t v = 0; v < count; ++v) {
      walk_around(std::span(corners_).subspan(begin_[v], begin_[v + 1] - begin_[v]));
      dual_.ends.push_back(static_cast<Index>(dual_.corners.size()));
    }
    return !cancelled(progress_);
  }

  /// The corners of all primal polygons by vertex.
  void gather_corners() {
    begin_.assign(cut_.crossings.size() + 1, 0);
    for (const CellPolygons& block : polygons_) {
      for (const std::uint32_t v : block.corners) ++begin_[v + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    corners_.resize(begin_.back());
    std::vector<std::size_t> place(begin_.begin(), begin_.end() - 1);
    for (std::size_t b = 0; b < polygons_.size(); ++b) {
      for (std::size_t i = 0; i < polygons_[b].size(); ++i) {
        const std::span<const std::uint32_t> polygon = polygons_[b].polygon(i);
        const std::size_t n = polygon.size();
        for (std::size_t k = 0; k < n; ++k) {
          corners_[place[polygon[k]]++] = {polygon[(k + n - 1) % n], polygon[(k + 1) % n],
                                           first_[b] + static_cast<Index>(i)};
        }
      }
    }
  }

  /// Appends the polygons around a vertex counter-clockwise: each ends at the side that the next
  /// one begins with.
  void walk_around(std::span<const Corner> around) {
    const Corner* at = around.data();
    for (std::size_t steps = 0; steps < around.size(); ++steps) {
      dual_.corners.push_back(at->polygon);
      const Index side = at->before;
      const auto next = std::find_if(around.begin(), around.end(),
                                     [side](const Corner& c) { return c.after == side; });
      require(next != around.end(), "mesh_dual: the polygons do not close");
      at = &*next;
    }
    require(at == around.data(), "mesh_dual: the polygons around a vertex are not one fan");
  }

  LatticeCut& cut_;
  const Progress* progress_;
  std::vector<CellPolygons> polygons_;  ///< by block
  std::vector<Index> first_;            ///< by block: the number of its first polygon
  std::vector<Plane> tangents_;         ///< by primal vertex
  std::vector<std::size_t> begin_;      ///< by primal vertex, into corners_
  std::vector<Corner> corners_;
  std::vector<std::size_t> jets_;  ///< evaluations, by block
  PolygonMesh dual_;
};

}  // namespace

Result<TriangleMesh> mesh_dual(const ImplicitSurface& surface, const LatticeOptions& options,
                               LatticeStatistics* statistics) {
  LatticeStatistics counts;
  Result<std::unique_ptr<LatticeCut>> cut = cut_lattice(surface, options, counts);
  if (!cut) return Result<TriangleMesh>::failure(cut.diagnostics());
  DualMesher mesher(**cut, options.progress);
  if (!mesher.run()) return error_at({}, "interrupted", Failure::interrupted);
  report_mesh(options.progress, 0.9);
  counts.gradient_evaluations += mesher.jets();
  PolygonMesh dual = mesher.take();
  cut->reset();
  if (dual.triangle_count() > options.max_triangles) {
    return too_many_triangles(dual.triangle_count());
  }
  SettleCounts settled;
  Result<TriangleMesh> mesh =
      settle(surface, std::move(dual), {options.cell, options.progress}, settled);
  counts.gradient_evaluations += settled.jets;
  counts.off_surface = settled.off_surface;
  if (mesh) {
    counts.vertices = mesh->positions.size();
    counts.triangles = mesh->triangles.size();
  }
  report_mesh(options.progress, 1.0);
  if (statistics != nullptr) *statistics = counts;
  return mesh;
}

}  // namespace cs2mesh
