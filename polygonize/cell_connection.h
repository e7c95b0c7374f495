// What hangs together in a cell whose corners do not tell.
//
// Signs that alternate around a face leave open which of its corners belong together, and so does
// one sample in its middle, where something thin passes between them. A grid of samples follows
// them through the cell, with one more in the middle of each of its squares around which signs
// alternate. On a face either the two inside corners or the two outside ones are joined then, never
// both, as in the game of Hex.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "libfield/field/implicit_surface.h"

namespace cs2mesh {

struct CellConnection {
  /// The ambiguous faces whose inside corners are joined on them, as split_cube() has them.
  std::uint8_t joined = 0;
  /// The side of the surface all of whose corners are joined within the cell, where that is one of
  /// the two: the side that a vertex in the middle should be on.
  std::optional<bool> side;
  /// Points of the cell that are joined with the corners of that side, nearest to the middle first;
  /// away from the faces. May be empty.
  std::vector<Vec3d> places;
  std::size_t values = 0;  ///< how many were asked for
};

/// `corners` are those of a cell as cell_table.h numbers them, each on the side of its bit in
/// `inside`; their convex hull is where F is asked, some 125 times. What is told of a face is the
/// same for both cells at it, for any surfaces that are the same there to the bit. Not promised: to
/// see what is thinner than a quarter of a cell.
CellConnection connect_cell(const ImplicitSurface& surface, const std::array<Vec3d, 8>& corners,
                            unsigned inside);

}  // namespace cs2mesh
