// A grid of samples of F for peers that need one, evaluated where the surface can be.
//
// Peers are not to be blamed for what is no work of theirs: blocks of the grid in which the bounds
// of F exclude a zero are filled with its sign, and the others are evaluated in bulk through a
// restriction, on as many threads as there are.
#pragma once

#include <array>
#include <vector>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh::bench {

/// Nodes a block has along an axis, and so many in all.
inline constexpr int kBlock = 8, kBlockNodes = kBlock * kBlock * kBlock;

struct SampleBlock {
  std::array<int, 3> first{};  ///< its lowest node
  bool empty = true;           ///< no zero of F in it or between it and the next ones
  bool inside = false;         ///< where empty
  /// F at the nodes, z fastest, where not empty.
  std::vector<float> values;
};

struct SampleGrid {
  double cell = 0.0;
  Vec3d origin;                 ///< of node (0, 0, 0)
  std::array<int, 3> blocks{};  ///< along each axis
  std::vector<SampleBlock> all;

  Vec3d node(const std::array<int, 3>& n) const {
    return origin + cell * Vec3d{double(n[0]), double(n[1]), double(n[2])};
  }
};

/// Over the bounds with two cells of air around. Empty blocks of one sign are in the list only if
/// `keep_empty`.
SampleGrid sample_grid(const ImplicitSurface& surface, double cell, bool keep_empty);

}  // namespace cs2mesh::bench
