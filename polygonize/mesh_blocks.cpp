#include "polygonize/mesh_blocks.h"

#include <atomic>
#include <span>

namespace cs2mesh {
namespace {

/// Large enough that few triangles are at borders, small enough that there are many for each
/// thread.
constexpr std::size_t kLeastSize = 4096, kMostBlocks = 64;

/// From any thread. Mostly there is nothing to do.
inline void widen(MeshBlocks::Reach& reach, const MeshBlocks::Reach& other) {
  const std::atomic_ref<MeshBlocks::Reach> shared(reach);
  MeshBlocks::Reach now = shared.load(std::memory_order_relaxed);
  if (now.first <= other.first && other.last <= now.last) return;
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
      const std::size_t first = size_ * block;
      const auto own =
          std::span(mesh.triangles).subspan(first, std::min(size_, mesh.triangles.size() - first));
      for (const auto& corners : own) {
        if (corners[0] != corners[1]) f(corners, static_cast<std::uint8_t>(block));
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
