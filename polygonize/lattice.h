// The global lattice: nodes at origin + cell * (i, j, k), and blocks of 8^3 cells of it.
#pragma once

#include <bit>
#include <cstdint>

#include "libfield/base/aabb.h"
#include "libfield/base/vec.h"

namespace cs2mesh {

/// Whole coordinates of a node, a cell (its lowest node) or a block (its lowest node over 8).
struct Int3 {
  std::int32_t x = 0, y = 0, z = 0;
  friend Int3 operator+(const Int3& a, const Int3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Int3 operator*(std::int32_t k, const Int3& a) { return {k * a.x, k * a.y, k * a.z}; }
  friend bool operator==(const Int3&, const Int3&) = default;
};

/// Bits 0, 1, 2 of `bits` as steps along x, y, z.
constexpr Int3 corner_step(int bits) {
  return {bits & 1, (bits >> 1) & 1, (bits >> 2) & 1};
}

struct Lattice {
  static constexpr std::int32_t kBlockCells = 8;
  static constexpr int kBlockNodes = 512;

  Vec3d origin;
  double cell = 1.0;

  /// Rounded to nearest, hence monotone in every index: a node of a block lies in block_box().
  Vec3d node(const Int3& n) const {
    return {origin.x + cell * n.x, origin.y + cell * n.y, origin.z + cell * n.z};
  }
  /// The closed box of a cube of `blocks` blocks a side whose lowest block is `block`.
  Aabb block_box(const Int3& block, std::int32_t blocks = 1) const {
    const Int3 side{blocks, blocks, blocks};
    return {node(kBlockCells * block), node(kBlockCells * (block + side))};
  }
};

/// Nodes in a block are numbered (x << 6) | (y << 3) | z, so one 64-bit word of a bit set holds a
/// slice of constant x.
constexpr int node_offset(const Int3& local) {
  return (local.x << 6) | (local.y << 3) | local.z;
}
constexpr Int3 local_node(int offset) {
  return {offset >> 6, (offset >> 3) & 7, offset & 7};
}

/// A set of nodes of one block, with the rank of each member.
struct NodeSet {
  std::uint64_t word[8] = {};

  bool contains(int offset) const { return (word[offset >> 6] >> (offset & 63)) & 1; }
  void insert(int offset) { word[offset >> 6] |= std::uint64_t{1} << (offset & 63); }
  void assign(int offset, bool member) {
    const std::uint64_t bit = std::uint64_t{1} << (offset & 63);
    word[offset >> 6] = member ? word[offset >> 6] | bit : word[offset >> 6] & ~bit;
  }
  int count() const {
    int n = 0;
    for (const std::uint64_t w : word) n += std::popcount(w);
    return n;
  }
  /// How many members precede `offset`.
  int rank(int offset) const {
    int n = std::popcount(word[offset >> 6] & ((std::uint64_t{1} << (offset & 63)) - 1));
    for (int i = 0; i < offset >> 6; ++i) n += std::popcount(word[i]);
    return n;
  }
  /// Calls f(offset) for each member in ascending order.
  template <class F>
  void for_each(F&& f) const {
    for (int i = 0; i < 8; ++i) {
      for (std::uint64_t w = word[i]; w != 0; w &= w - 1) f((i << 6) | std::countr_zero(w));
    }
  }
};

}  // namespace cs2mesh
