#include "polygonize/mesh_blocks.h"

#include <atomic>

namespace cs2mesh {
namespace {

/// Large enough that few triangles are at borders, small enough that there are many for each
/// thread.
constexpr std::size_t kLeastSize = 4096, kMostBlocks = 64;

/// From any thread. Mostly there is nothing to do.
inline void widen(MeshBlocks::Reach& reach, const MeshBlocks::Reach& other) {
  const std::atomic_ref<MeshBlocks::Reach> shared(reach);
  MeshBlocks::Reach now = shared.load(std::memory_order_relaxed);
  for (;;) {
    MeshBlocks::Reach wide = now;
    wide.include(other);
    if (wide == now || shared.compare_exchange_weak(now, wide, std::memory_order_relaxed)) return;
  }
}

}  // namespace

MeshBlocks::MeshBlocks(const TriangleMesh& mesh)
    : mesh_(mesh),
      size_(std::max(kLeastSize, (mesh.triangles.size() + kMostBlocks - 1) / kMostBlocks)) {
  std::vector<Reach>& inner = reach_[0];
  std::vector<Reach>& deep = reach_[1];
  inner.resize(mesh.positions.size());
  const auto for_each_left = [&](const auto& f) {
    tbb::parallel_for(std::size_t{0}, count(), [&](std::size_t block) {
      const std::size_t last = std::min(size_ * (block + 1), mesh.triangles.size());
      for (std::size_t t = size_ * block; t < last; ++t) {
        if (!is_gone(t)) f(mesh.triangles[t], static_cast<std::uint8_t>(block));
      }
    });
  };
  for_each_left([&](const auto& corners, std::uint8_t block) {
    for (const TriangleMesh::Index v : corners) widen(inner[v], {block, block});
  });
  deep = inner;
  for_each_left([&](const auto& corners, std::uint8_t /*block*/) {
    Reach all = inner[corners[0]];
    all.include(inner[corners[1]]);
    all.include(inner[corners[2]]);
    // Most are within one block, as are their neighbours: nothing to write then.
    if (all.first == all.last) return;
    for (const TriangleMesh::Index v : corners) widen(deep[v], all);
  });
}

}  // namespace cs2mesh
