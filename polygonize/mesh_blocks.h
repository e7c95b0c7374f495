// A mesh in blocks of triangles, whose insides can be changed side by side.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// Which triangles count when it is asked in which blocks a vertex is.
enum class Depth : std::uint8_t {
  inner,  ///< those of the vertex
  deep,   ///< and those of its neighbours
};

/// Blocks are runs of triangles in their order, by the number of triangles alone, so that what is
/// done does not depend on the number of threads; groups are runs of blocks. Where neighbours in
/// number are near each other in space (place_order.h), few triangles are between blocks. Triangles
/// with equal first two corners are gone.
class MeshBlocks {
 public:
  static constexpr std::size_t kGroup = 8;  ///< blocks

  /// From the first block to the last one that has triangles of a vertex.
  struct alignas(2) Reach {
    std::uint8_t first = 255, last = 0;

    void include(const Reach& other) {
      first = std::min(first, other.first);
      last = std::max(last, other.last);
    }
    bool operator==(const Reach&) const = default;
  };

  /// `mesh` outlives this. O(n).
  explicit MeshBlocks(const TriangleMesh& mesh);

  std::size_t size() const { return size_; }  ///< triangles of a block
  std::size_t count() const { return (mesh_.triangles.size() + size_ - 1) / size_; }
  /// Of a vertex with triangles.
  const Reach& reach(Depth depth, TriangleMesh::Index vertex) const {
    return reach_[static_cast<std::size_t>(depth)][vertex];
  }

  /// Calls f(t) once for each triangle that is not gone when it is its turn: first, block by block
  /// in parallel, for those whose corners are within the block as deep as that, then group by group
  /// for those within the group, then for those within one half of the groups, then for the others
  /// one by one, always in ascending order.
  ///
  /// At `inner`, f may move the corners of t and read all triangles at them. At `deep`, it may also
  /// collapse and flip the edges of t: triangles beside them stay within the block, and so do
  /// those of every vertex that they join.
  template <class F>
  void for_each_triangle(Depth depth, const F& f) const {
    const std::size_t groups = (count() + kGroup - 1) / kGroup;
    Numbers left = for_each_block(depth, f);
    left = for_each_group(depth, left, kGroup, kGroup, f);
    const std::size_t half = (groups + 1) / 2;
    if (groups > 2) left = for_each_group(depth, left, half, half * kGroup, f);
    for (const auto& of_group : left) {
      for (const std::uint32_t t : of_group) {
        if (!is_gone(t)) turn_of(t, f);
      }
    }
  }

 private:
  using Numbers = std::vector<std::vector<std::uint32_t>>;

  /// Returns what is not within its block, block by block.
  template <class F>
  Numbers for_each_block(Depth depth, const F& f) const {
    Numbers later(count());
    tbb::parallel_for(std::size_t{0}, later.size(), [&](std::size_t block) {
      const std::size_t last = std::min(size_ * (block + 1), mesh_.triangles.size());
      for (std::size_t t = size_ * block; t < last; ++t) {
        take_turn(t, depth, 1, later[block], f);
      }
    });
    return later;
  }

  /// For what was left of runs of blocks, in runs of so many of those, which are runs of `run`
  /// blocks; returns what is left of each.
  template <class F>
  Numbers for_each_group(Depth depth, const Numbers& left, std::size_t many, std::size_t run,
                         const F& f) const {
    Numbers later((left.size() + many - 1) / many);
    tbb::parallel_for(std::size_t{0}, later.size(), [&](std::size_t group) {
      const std::size_t last = std::min(many * (group + 1), left.size());
      for (std::size_t part = many * group; part < last; ++part) {
        for (const std::uint32_t t : left[part]) take_turn(t, depth, run, later[group], f);
      }
    });
    return later;
  }

  template <class F>
  void take_turn(std::size_t t, Depth depth, std::size_t run, std::vector<std::uint32_t>& later,
                 const F& f) const {
    if (is_gone(t)) return;
    if (is_within(t, depth, run)) {
      turn_of(t, f);
    } else {
      later.push_back(static_cast<std::uint32_t>(t));
    }
  }
  /// One place in the code that calls f, so that all of it can be inlined there.
  template <class F>
  [[gnu::noinline]] static void turn_of(std::size_t t, const F& f) {
    f(t);
  }
  bool is_gone(std::size_t t) const { return mesh_.triangles[t][0] == mesh_.triangles[t][1]; }
  /// Whether the corners of a triangle are within one of the runs of so many blocks.
  bool is_within(std::size_t t, Depth depth, std::size_t run) const {
    const auto& corners = mesh_.triangles[t];
    return std::all_of(corners.begin(), corners.end(), [&](TriangleMesh::Index v) {
      return reach(depth, v).first / run == reach(depth, v).last / run;
    });
  }

  const TriangleMesh& mesh_;
  std::size_t size_;
  std::array<std::vector<Reach>, 2> reach_;  ///< by depth, then by vertex
};

}  // namespace cs2mesh
