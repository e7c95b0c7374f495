#include "tests/bench/vdb_peer.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "tests/bench/sample_grid.h"

namespace cs2mesh::bench {
namespace {

/// -F at the nodes of blocks that may hold surface; elsewhere no more than its sign.
openvdb::FloatGrid::Ptr level_set(const SampleGrid& samples) {
  constexpr float kBackground = 1e3F;
  openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(kBackground);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  for (const SampleBlock& block : samples.all) {
    const openvdb::Coord corner(block.first[0], block.first[1], block.first[2]);
    auto* leaf = grid->tree().touchLeaf(corner);
    // Leaves have z fastest, too.
    for (openvdb::Index i = 0; i < openvdb::Index{kBlockNodes}; ++i)
      leaf->setValueOn(i, -block.values[i]);
  }
  openvdb::tools::signedFloodFill(grid->tree());
  return grid;
}

}  // namespace

TriangleMesh vdb_level_set_mesh(const ImplicitSurface& surface, double cell) {
  openvdb::initialize();
  const SampleGrid samples = sample_grid(surface, cell, false);
  const openvdb::FloatGrid::Ptr grid = level_set(samples);
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quadrilaterals;
  openvdb::tools::volumeToMesh(*grid, points, triangles, quadrilaterals, 0.0, 0.0);
  TriangleMesh mesh;
  for (const openvdb::Vec3s& p : points) {
    mesh.positions.push_back(samples.origin + cell * Vec3d{p.x(), p.y(), p.z()});
  }
  // Clockwise seen from outside.
  for (const openvdb::Vec3I& t : triangles) mesh.triangles.push_back({t[2], t[1], t[0]});
  for (const openvdb::Vec4I& q : quadrilaterals) {
    mesh.triangles.push_back({q[2], q[1], q[0]});
    mesh.triangles.push_back({q[3], q[2], q[0]});
  }
  return mesh;
}

}  // namespace cs2mesh::bench
