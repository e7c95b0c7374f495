// A mesh in blocks of triangles, whose insides can be changed side by side.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// How far within a block a vertex lies.
enum class Depth : std::uint8_t {
  border,  ///< it has triangles of several blocks
  inner,   ///< all of its triangles are of one
  deep,    ///< and all of those of its neighbours
};

/// Blocks are runs of triangles in their order, by the number of triangles alone, so that what is
/// done does not depend on the number of threads. Triangles with equal first two corners are gone.
class MeshBlocks {
 public:
  /// `mesh` outlives this. O(n).
  explicit MeshBlocks(const TriangleMesh& mesh);

  std::size_t count() const { return (mesh_.triangles.size() + size_ - 1) / size_; }
  Depth depth(TriangleMesh::Index vertex) const { return depth_[vertex]; }

  /// Calls f(t) once for each triangle that is not gone: first, block by block in parallel, for
  /// those with all corners so deep when it is their turn, then for the others one by one, both in
  /// ascending order.
  ///
  /// At `inner`, f may move the corners of t and read all triangles at them. At `deep`, it may also
  /// collapse and flip the edges of t: triangles beside them stay within the block, and so do
  /// those of every vertex that they join.
  template <class F>
  void for_each_triangle(Depth depth, const F& f) const {
    std::vector<std::vector<std::uint32_t>> left(count());
    tbb::parallel_for(std::size_t{0}, left.size(), [&](std::size_t block) {
      const std::size_t last = std::min(size_ * (block + 1), mesh_.triangles.size());
      for (std::size_t t = size_ * block; t < last; ++t) {
        if (is_gone(t)) continue;
        if (is_within(t, depth)) {
          turn_of(t, f);
        } else {
          left[block].push_back(static_cast<std::uint32_t>(t));
        }
      }
    });
    for (const auto& of_block : left) {
      for (const std::uint32_t t : of_block) {
        if (!is_gone(t)) turn_of(t, f);
      }
    }
  }

 private:
  /// One place in the code that calls f, so that all of it can be inlined there.
  template <class F>
  [[gnu::noinline]] static void turn_of(std::size_t t, const F& f) {
    f(t);
  }
  bool is_gone(std::size_t t) const { return mesh_.triangles[t][0] == mesh_.triangles[t][1]; }
  bool is_within(std::size_t t, Depth depth) const {
    const auto& corners = mesh_.triangles[t];
    return std::all_of(corners.begin(), corners.end(),
                       [&](TriangleMesh::Index v) { return depth_[v] >= depth; });
  }

  const TriangleMesh& mesh_;
  std::size_t size_;
  std::vector<Depth> depth_;  ///< by vertex
};

}  // namespace cs2mesh
