// How a surface cuts a convex cell, for every choice of signs at its corners.
//
// On each face of the cell the crossed edges are joined in pairs; the segments close to cycles, and
// each cycle bounds one piece of surface. A face with more than one pair of crossings (signs
// + - + - around a quadrilateral) does not say how to join them: such a case is marked ambiguous
// and has no cycles. The tables are generated from the faces of the cell, so there is nothing to
// mistype (the problem of the 256 hand-made cases of Lorensen and Cline, 1987).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cs2mesh {

/// A convex cell: each face lists its corners counter-clockwise seen from outside the cell.
struct CellShape {
  int corners = 0;
  std::vector<std::vector<int>> faces;
};

/// A closed polygon over crossed edges, counter-clockwise seen from outside the shape.
struct CellCycle {
  std::uint8_t length = 0;
  std::array<std::uint8_t, 8> edge{};  ///< numbers in CellTable::edges
};

struct CellCase {
  bool ambiguous = false;
  std::uint8_t cycle_count = 0;
  std::uint8_t triangle_count = 0;
  std::array<CellCycle, 4> cycles{};
};

struct CellTable {
  std::vector<std::array<std::uint8_t, 2>> edges;  ///< corner pairs, lower first
  std::vector<CellCase> cases;                     ///< by inside mask: bit c = corner c is inside

  int edge_between(int a, int b) const;
};

CellTable make_cell_table(const CellShape& shape);

/// Corner c of the cube is at (c & 1, c >> 1 & 1, c >> 2 & 1).
const CellShape& cube_shape();
/// Corners 0..3 are the base, counter-clockwise seen from the apex's far side; corner 4 is the
/// apex.
const CellShape& pyramid_shape();
/// Corners 0, 1, 2 are counter-clockwise seen from outside; corner 3 is opposite.
const CellShape& tetrahedron_shape();

const CellTable& cube_table();
const CellTable& pyramid_table();
const CellTable& tetrahedron_table();

/// The cells one lattice cell is cut into. Corners 0..7 are those of the cube, 8 is its centre.
struct SubCell {
  std::uint8_t corner[5] = {};
  bool pyramid = false;  ///< else a tetrahedron
};

inline constexpr int kCentre = 8;

/// The pyramids over the six faces of the cube with its centre as apex; a pyramid over an ambiguous
/// face is cut into two tetrahedra along a diagonal, on which no crossing lies: that between the
/// face's inside corners where bit f of `joined` is set for face f of cube_shape(), that between
/// its outside corners elsewhere. Both cubes at such a face have to choose the same. At most twelve
/// cells; returns how many.
int split_cube(unsigned inside_corners, unsigned joined, std::span<SubCell, 12> cells);

/// The faces of a cube whose signs alternate, bit f for face f of cube_shape().
unsigned ambiguous_faces(unsigned inside_corners);

/// Calls f(case, table, cell) for each of those pieces; bit kCentre of `inside` is that of the
/// centre.
template <class F>
void for_each_piece(unsigned inside, unsigned joined, F&& f) {
  std::array<SubCell, 12> pieces;
  const int count = split_cube(inside & 0xffU, joined, pieces);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const SubCell& piece = pieces[i];
    const CellTable& table = piece.pyramid ? pyramid_table() : tetrahedron_table();
    unsigned mask = 0;
    for (unsigned c = 0; c < (piece.pyramid ? 5U : 4U); ++c) {
      mask |= ((inside >> piece.corner[c]) & 1U) << c;
    }
    f(table.cases[mask], table, piece);
  }
}

}  // namespace cs2mesh
