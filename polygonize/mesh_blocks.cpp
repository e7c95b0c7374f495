#include "polygonize/mesh_blocks.h"

namespace cs2mesh {
namespace {

/// Large enough that few triangles are at borders, small enough that there are many for each
/// thread.
constexpr std::size_t kLeastSize = 4096, kMostBlocks = 64;

}  // namespace

MeshBlocks::MeshBlocks(const TriangleMesh& mesh)
    : mesh_(mesh),
      size_(std::max(kLeastSize, (mesh.triangles.size() + kMostBlocks - 1) / kMostBlocks)) {
  auto& [inner, deep] = reach_;
  inner.resize(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (is_gone(t)) continue;
    const auto block = static_cast<std::uint8_t>(t / size_);
    for (const TriangleMesh::Index v : mesh.triangles[t]) inner[v].include({block, block});
  }
  deep = inner;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (is_gone(t)) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    Reach all = inner[a];
    all.include(inner[b]);
    all.include(inner[c]);
    // Most are within one block, as are their neighbours: nothing to write then.
    if (all.first == all.last) continue;
    for (const TriangleMesh::Index v : {a, b, c}) deep[v].include(all);
  }
}

}  // namespace cs2mesh
