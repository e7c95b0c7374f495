#include "polygonize/mesh_blocks.h"

#include <limits>

namespace cs2mesh {
namespace {

/// Large enough that few triangles are at borders, small enough that there are many for each
/// thread.
constexpr std::size_t kLeastSize = 4096, kMostBlocks = 64;

}  // namespace

MeshBlocks::MeshBlocks(const TriangleMesh& mesh)
    : mesh_(mesh),
      size_(std::max(kLeastSize, (mesh.triangles.size() + kMostBlocks - 1) / kMostBlocks)),
      depth_(mesh.positions.size(), Depth::deep) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> block_of(mesh.positions.size(), kNone);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (is_gone(t)) continue;
    const auto block = static_cast<std::uint32_t>(t / size_);
    for (const TriangleMesh::Index v : mesh.triangles[t]) {
      if (block_of[v] == kNone) block_of[v] = block;
      if (block_of[v] != block) depth_[v] = Depth::border;
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (is_gone(t) || is_within(t, Depth::inner)) continue;
    for (const TriangleMesh::Index v : mesh.triangles[t]) {
      depth_[v] = std::min(depth_[v], Depth::inner);
    }
  }
}

}  // namespace cs2mesh
