#include "polygonize/vdb_mesher.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "polygonize/lattice_cut.h"
#include "polygonize/narrow_band.h"
#include "polygonize/polygon_mesh.h"

namespace cs2mesh {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using Leaf = openvdb::FloatTree::LeafNodeType;
using Mask = openvdb::FloatTree::ValueConverter<bool>::Type;

/// Distances are in voxels, negative inside, and end here.
constexpr float kFarthest = 3.0F;

Diagnostic interrupted() {
  return error_at({}, "interrupted", Failure::interrupted);
}

class LevelSet {
 public:
  LevelSet(const NarrowBand& band, const Progress* progress) : band_(band), progress_(progress) {
    // Voxels are counted from the band's lowest block, for points of the mesh are floats.
    for (std::size_t b = 0; b < band.block_count(); ++b) {
      const Int3& c = band.coord(b);
      lowest_ = {std::min(lowest_.x, c.x), std::min(lowest_.y, c.y), std::min(lowest_.z, c.z)};
    }
    grid_ = FloatGrid::create(kFarthest);
    grid_->setGridClass(openvdb::GRID_LEVEL_SET);
  }

  /// False if cancelled.
  bool fill() {
    if (band_.block_count() == 0) return true;
    mark_signs();
    Mask::Ptr near = openvdb::tools::extractIsosurfaceMask(grid_->tree(), 0.0F);
    // The gradients by which volumeToMesh judges flatness take one voxel more on either side.
    openvdb::tools::dilateActiveValues(*near, 1, openvdb::tools::NN_FACE_EDGE_VERTEX);
    openvdb::tools::dilateActiveValues(*near, 1, openvdb::tools::NN_FACE);
    return measure(*near);
  }

  PolygonMesh mesh(double adaptivity) const {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quadrilaterals;
    openvdb::tools::volumeToMesh(*grid_, points, triangles, quadrilaterals, 0.0, adaptivity);
    PolygonMesh mesh;
    const Lattice& lattice = band_.lattice();
    const Vec3d base = lattice.node(Lattice::kBlockCells * lowest_);
    mesh.positions.reserve(points.size());
    for (const openvdb::Vec3s& p : points) {
      mesh.positions.push_back(base + lattice.cell * Vec3d{p.x(), p.y(), p.z()});
    }
    // Clockwise seen from outside.
    const auto add = [&mesh](const auto& polygon, int corners) {
      for (int k = corners - 1; k >= 0; --k) mesh.corners.push_back(polygon[k]);
      mesh.ends.push_back(static_cast<TriangleMesh::Index>(mesh.corners.size()));
    };
    for (const openvdb::Vec3I& triangle : triangles) add(triangle, 3);
    for (const openvdb::Vec4I& quadrilateral : quadrilaterals) add(quadrilateral, 4);
    return mesh;
  }

  std::size_t jets() const { return jets_; }

 private:
  Coord corner_of(std::size_t block) const {
    const Int3 c = Lattice::kBlockCells * (band_.coord(block) + -1 * lowest_);
    return {c.x, c.y, c.z};
  }

  /// The grid with nothing but signs, everywhere.
  void mark_signs() {
    leaves_.resize(band_.block_count());
    for (std::size_t b = 0; b < leaves_.size(); ++b) {
      leaves_[b] = grid_->tree().touchLeaf(corner_of(b));
    }
    for_each_block(leaves_.size(), nullptr, [this](std::size_t b) {
      const std::span<const double> values = band_.values(b);
      const NodeSet sampled = band_.sampled(b);
      Leaf& leaf = *leaves_[b];
      // F keeps its sign in the box of a block that is not active, so that those of its nodes which
      // are not sampled have that of the others.
      bool inside = false;
      sampled.for_each([&](int offset) { inside = values[static_cast<std::size_t>(offset)] >= 0; });
      leaf.fill(inside ? -kFarthest : kFarthest, true);
      sampled.for_each([&](int offset) {
        const bool in = values[static_cast<std::size_t>(offset)] >= 0;
        leaf.setValueOnly(static_cast<openvdb::Index>(offset), in ? -kFarthest : kFarthest);
      });
    });
    openvdb::tools::signedFloodFill(grid_->tree());
  }

  /// Distances at the voxels of the mask; the others become inactive.
  bool measure(const Mask& near) {
    std::vector<std::size_t> jets(leaves_.size(), 0);
    const bool done = for_each_block(leaves_.size(), progress_, [&](std::size_t b) {
      Leaf& leaf = *leaves_[b];
      const Mask::LeafNodeType* wanted = near.probeConstLeaf(leaf.origin());
      std::vector<std::uint16_t> offsets;
      std::vector<Vec3d> points;
      if (wanted != nullptr) {
        band_.sampled(b).for_each([&](int offset) {
          if (!wanted->isValueOn(static_cast<openvdb::Index>(offset))) return;
          offsets.push_back(static_cast<std::uint16_t>(offset));
          points.push_back(band_.node_position(b, offset));
        });
      }
      leaf.setValuesOff();
      std::vector<Jet> found(points.size());
      band_.jets(b, offsets, points, found);
      jets[b] = found.size();
      for (std::size_t i = 0; i < found.size(); ++i) {
        const bool inside = std::signbit(leaf.getValue(offsets[i]));
        leaf.setValueOn(offsets[i], distance(found[i], inside));
      }
    });
    for (const std::size_t n : jets) jets_ += n;
    return done;
  }

  float distance(const Jet& jet, bool inside) const {
    // Crossings keep clear of the voxels themselves, where they would coincide.
    constexpr double kNearest = 1e-3;
    const double first_order = std::abs(jet.value) / (norm(jet.gradient) * band_.lattice().cell);
    const double size =
        first_order >= kNearest ? std::min<double>(first_order, kFarthest) : kNearest;
    return static_cast<float>(inside ? -size : size);
  }

  const NarrowBand& band_;
  const Progress* progress_;
  Int3 lowest_{INT32_MAX, INT32_MAX, INT32_MAX};
  FloatGrid::Ptr grid_;
  std::vector<Leaf*> leaves_;  ///< by block
  std::size_t jets_ = 0;
};

}  // namespace

Result<TriangleMesh> mesh_vdb(const ImplicitSurface& surface, const LatticeOptions& options,
                              LatticeStatistics* statistics) {
  // One minus the cosine between normals that one larger cell may hold, and none.
  constexpr std::array<double, 2> kAdaptivities{0.01, 0.0};
  Progress* const progress = options.progress;
  report_mesh(progress, 0.0);
  const Result<NarrowBand> band =
      NarrowBand::build(surface, {options.cell, options.origin, options.max_nodes, progress});
  if (!band) return Result<TriangleMesh>::failure(band.diagnostics());
  LatticeStatistics counts;
  counts.value_evaluations = band->counts().nodes_evaluated;
  counts.blocks_tested = band->counts().blocks_tested;
  counts.blocks_active = band->counts().blocks_active;
  if (band->block_count() == 0) {
    if (statistics != nullptr) *statistics = counts;
    return TriangleMesh{};
  }
  report_mesh(progress, 0.4);
  LevelSet level_set(*band, progress);
  if (!level_set.fill()) return interrupted();
  counts.gradient_evaluations = level_set.jets();
  report_mesh(progress, 0.7);
  Result<TriangleMesh> mesh = TriangleMesh{};
  for (const double adaptivity : kAdaptivities) {
    if (cancelled(progress)) return interrupted();
    PolygonMesh polygons = level_set.mesh(adaptivity);
    if (polygons.triangle_count() > options.max_triangles) {
      return too_many_triangles(polygons.triangle_count());
    }
    SettleCounts settled;
    mesh = settle(surface, std::move(polygons), {options.cell, progress}, settled);
    counts.gradient_evaluations += settled.jets;
    counts.off_surface = settled.off_surface;
    if (mesh || mesh.diagnostics().front().failure != Failure::check_failed) break;
  }
  if (mesh) {
    counts.vertices = mesh->positions.size();
    counts.triangles = mesh->triangles.size();
  }
  report_mesh(progress, 1.0);
  if (statistics != nullptr) *statistics = counts;
  return mesh;
}

}  // namespace cs2mesh
