#include "polygonize/lattice_cells.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "libfield/base/check.h"
#include "polygonize/cell_connection.h"
#include "polygonize/cell_table.h"
#include "polygonize/ear_cutting.h"

namespace cs2mesh {
namespace {

int axis_between(int a, int b) {
  return (a ^ b) >> 1;  // 1, 2, 4 -> 0, 1, 2
}

/// Calls f(offset, inside corner bits) for each cell of a block whose corners differ in sign.
template <class F>
void for_each_mixed_cell(const PaddedNodes& inside, F&& f) {
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      // Corner c is at (c & 1, c >> 1 & 1, c >> 2 & 1); bit z of rows[c] is corner c of cell z.
      std::array<unsigned, 8> rows;
      unsigned any = 0;
      unsigned all = ~0U;
      for (int c = 0; c < 8; ++c) {
        const unsigned row = inside.row(x + (c & 1), y + ((c >> 1) & 1)) >> (1 + (c >> 2));
        rows[static_cast<std::size_t>(c)] = row;
        any |= row;
        all &= row;
      }
      for (unsigned mixed = any & ~all & 0xff; mixed != 0; mixed &= mixed - 1) {
        const int z = std::countr_zero(mixed);
        unsigned corners = 0;
        for (std::size_t c = 0; c < 8; ++c) corners |= ((rows[c] >> z) & 1U) << c;
        f(node_offset({x, y, z}), corners);
      }
    }
  }
}

/// Moves the centre of a split cell to the clearest of these places, of those on `side` if that is
/// given; the first that is clear enough will do. Returns the number of jets.
std::size_t move_centre(const ImplicitSurface& surface, double cell, std::span<const Vec3d> places,
                        std::optional<bool> side, SplitCell& split) {
  std::vector<Jet> jets(places.size());
  surface.jets(places, jets);
  for (std::size_t k = 0; k < places.size() && NodeMover::near(split.jet, cell); ++k) {
    const bool right = !side || (jets[k].value >= 0) == *side;
    if (!right || !(clearance(jets[k]) > clearance(split.jet))) continue;
    split.centre = places[k];
    split.jet = jets[k];
  }
  return places.size();
}

/// Puts the centre of a split cell, which is in its middle, on the side that hangs together in the
/// cell, and clear of the surface. Returns the number of jets.
std::size_t settle_centre(const ImplicitSurface& surface, double cell,
                          const CellConnection& connection, SplitCell& split) {
  constexpr std::size_t kMostPlaces = 8;
  const Vec3d middle = split.centre;
  std::size_t count = 0;
  std::optional<bool> side;
  if (connection.side) {
    const std::size_t tried = std::min(kMostPlaces, connection.places.size());
    split.jet = {};  // no place is less clear
    count += move_centre(surface, cell, std::span(connection.places).first(tried), connection.side,
                         split);
    if (clearance(split.jet) > 0) side = connection.side;
    if (!NodeMover::near(split.jet, cell)) return count;
  }
  const Jet jet = surface.jet(middle);
  ++count;
  if (!side) split.jet = jet;
  if (!NodeMover::near(split.jet, cell)) return count;
  // Around the middle, from where none of them comes near a face.
  std::array<Vec3d, NodeMover::kTrials + 1> places;
  places[0] = NodeMover::first_place(middle, jet, cell);
  for (int k = 0; k < NodeMover::kTrials; ++k) {
    places[static_cast<std::size_t>(k + 1)] = NodeMover::other_place(middle, jet, cell, k);
  }
  return count + move_centre(surface, cell, places, side, split);
}

/// The sides of a split cell's corners and of its centre.
unsigned inside_of(const SplitCell& split) {
  return split.inside | (split.centre_inside() ? 1U << kCentre : 0U);
}

}  // namespace

LatticeCells::NodeRef LatticeCells::node_at(std::size_t block, const Int3& local) const {
  const Int3 step{local.x >> 3, local.y >> 3, local.z >> 3};
  return {step == Int3{} ? block : band_.neighbour(block, step),
          node_offset({local.x & 7, local.y & 7, local.z & 7})};
}

void LatticeCells::classify(std::size_t index) {
  BlockCells& block = blocks_[index];
  const PaddedNodes inside = nodes_.padded_inside(index);
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      const unsigned row = inside.row(x, y);
      const std::array<unsigned, 3> other{inside.row(x + 1, y), inside.row(x, y + 1), row >> 1U};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::uint64_t bits = ((row ^ other[axis]) >> 1) & 0xff;
        block.crossed[axis].word[x] |= bits << (8 * y);
      }
    }
  }
  std::size_t rank = 0;
  for (std::size_t word = 0; word < 24; ++word) {
    block.rank_of_word[word] = static_cast<std::uint16_t>(rank);
    rank += static_cast<std::size_t>(std::popcount(block.crossed[word / 8].word[word % 8]));
  }
  block.vertices = rank;

  const CellTable& cube = cube_table();
  for_each_mixed_cell(inside, [&](int offset, unsigned corners) {
    const CellCase& cell = cube.cases[corners];
    if (cell.ambiguous) add_split(index, offset, corners);
    block.triangles += cell.triangle_count;
  });
  settle_centres(index);
}

void LatticeCells::add_split(std::size_t index, int offset, unsigned inside) {
  SplitCell split;
  split.offset = static_cast<std::uint16_t>(offset);
  split.inside = static_cast<std::uint8_t>(inside);
  for (int c = 0; c < 8; ++c) {
    const NodeRef node = node_at(index, local_node(offset) + corner_step(c));
    split.centre += 0.125 * nodes_.position(node.block, node.offset);
  }
  blocks_[index].splits.push_back(split);
}

/// Samples the cells with ambiguous faces, and finds a place in each that is clear of the surface.
void LatticeCells::settle_centres(std::size_t index) {
  BlockCells& block = blocks_[index];
  if (block.splits.empty()) return;
  const ImplicitSurface& surface = band_.surface(index);
  for (SplitCell& split : block.splits) {
    std::array<Vec3d, 8> corners;
    for (int c = 0; c < 8; ++c) {
      const NodeRef node = node_at(index, local_node(split.offset) + corner_step(c));
      corners[static_cast<std::size_t>(c)] = nodes_.position(node.block, node.offset);
    }
    const CellConnection connection = connect_cell(surface, corners, split.inside);
    block.values += connection.values;
    split.joined = connection.joined;
    block.jets += settle_centre(surface, band_.lattice().cell, connection, split);
  }
  for (SplitCell& split : block.splits) {
    split.crossed = static_cast<std::uint8_t>(split.centre_inside() ? ~split.inside : split.inside);
    split.first = static_cast<std::uint32_t>(block.vertices);
    block.vertices += static_cast<std::size_t>(std::popcount(split.crossed));
    for_each_piece(inside_of(split), split.joined,
                   [&](const CellCase& piece, const CellTable&, const SubCell&) {
                     block.triangles += piece.triangle_count;
                   });
  }
}

void LatticeCells::place_vertices(std::size_t index, std::span<Vec3d> positions) {
  BlockCells& block = blocks_[index];
  if (block.vertices == 0) return;
  std::vector<CrossedEdge> edges;
  edges.reserve(block.vertices);
  for (int axis = 0; axis < 3; ++axis) {
    block.crossed[static_cast<std::size_t>(axis)].for_each([&](int offset) {
      const NodeRef b = node_at(index, local_node(offset) + corner_step(1 << axis));
      edges.push_back({nodes_.position(index, offset), nodes_.position(b.block, b.offset),
                       nodes_.jet(index, offset), nodes_.jet(b.block, b.offset)});
    });
  }
  for (const SplitCell& split : block.splits) {
    for (int c = 0; c < 8; ++c) {
      if (((split.crossed >> c) & 1) == 0) continue;
      const NodeRef corner = node_at(index, local_node(split.offset) + corner_step(c));
      edges.push_back({nodes_.position(corner.block, corner.offset), split.centre,
                       nodes_.jet(corner.block, corner.offset), split.jet});
    }
  }
  EdgeRootCounts counts;
  find_roots(band_.surface(index), edges, positions.subspan(block.first_vertex, block.vertices),
             counts);
  block.jets += counts.jets;
  block.clamped = counts.clamped;
}

std::uint32_t LatticeCells::lattice_edge_vertex(std::size_t index, int offset, int a, int b) const {
  const NodeRef low = node_at(index, local_node(offset) + corner_step(std::min(a, b)));
  require(band_.active(static_cast<std::uint32_t>(low.block)),
          "ImplicitSurface::enclose cleared a box that holds surface");
  return blocks_[low.block].edge_vertex(axis_between(a, b), low.offset);
}

std::uint32_t LatticeCells::split_edge_vertex(std::size_t index, const SplitCell& cell, int a,
                                              int b) const {
  if (a != kCentre && b != kCentre) return lattice_edge_vertex(index, cell.offset, a, b);
  const int corner = std::min(a, b);
  const unsigned before = cell.crossed & ((1U << corner) - 1);
  return blocks_[index].first_vertex + cell.first +
         static_cast<std::uint32_t>(std::popcount(before));
}

/// Calls f(offset of the cell, whether it is whole, polygon) for the polygons of a block; f may use
/// up the polygon.
template <class F>
void LatticeCells::for_each_polygon(std::size_t index, F&& f) const {
  std::array<std::uint32_t, 8> polygon;
  const auto pass = [&](int offset, bool whole, const CellCase& cell, const CellTable& table,
                        auto&& vertex_of) {
    for (std::size_t i = 0; i < cell.cycle_count; ++i) {
      const CellCycle& cycle = cell.cycles[i];
      for (std::size_t k = 0; k < cycle.length; ++k) {
        const auto& edge = table.edges[cycle.edge[k]];
        polygon[k] = vertex_of(edge[0], edge[1]);
      }
      f(offset, whole, std::span(polygon).first(cycle.length));
    }
  };

  const CellTable& cube = cube_table();
  auto split = blocks_[index].splits.begin();
  for_each_mixed_cell(nodes_.padded_inside(index), [&](int offset, unsigned corners) {
    const CellCase& cell = cube.cases[corners];
    if (!cell.ambiguous) {
      pass(offset, true, cell, cube,
           [&](int a, int b) { return lattice_edge_vertex(index, offset, a, b); });
      return;
    }
    for_each_piece(inside_of(*split), split->joined,
                   [&](const CellCase& piece, const CellTable& table, const SubCell& sub) {
                     pass(offset, false, piece, table, [&](int a, int b) {
                       return split_edge_vertex(index, *split, sub.corner[a], sub.corner[b]);
                     });
                   });
    ++split;
  });
}

void LatticeCells::make_triangles(std::size_t index, std::span<const Vec3d> positions,
                                  std::span<std::array<TriangleMesh::Index, 3>> triangles) const {
  const BlockCells& block = blocks_[index];
  if (block.triangles == 0) return;
  std::array<TriangleMesh::Index, 3>* out = triangles.data() + block.first_triangle;
  for_each_polygon(index, [&](int, bool, std::span<std::uint32_t> polygon) {
    triangulate(polygon, positions, out);
  });
  require(out == triangles.data() + block.first_triangle + block.triangles,
          "LatticeCells: triangles miscounted");
}

CellPolygons LatticeCells::polygons(std::size_t index) const {
  CellPolygons all;
  if (blocks_[index].triangles == 0) return all;
  for_each_polygon(index, [&](int offset, bool whole, std::span<std::uint32_t> polygon) {
    all.corners.insert(all.corners.end(), polygon.begin(), polygon.end());
    all.ends.push_back(static_cast<std::uint32_t>(all.corners.size()));
    all.offsets.push_back(static_cast<std::uint16_t>(offset));
    all.whole.push_back(whole ? 1 : 0);
  });
  return all;
}

void triangulate(std::span<std::uint32_t> polygon, std::span<const Vec3d> positions,
                 std::array<TriangleMesh::Index, 3>*& out) {
  const auto emit = [&out](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    *out++ = {a, b, c};
  };
  cut_ears(
      polygon, positions, [](std::uint32_t, std::uint32_t) { return true; }, emit);
  emit(polygon[0], polygon[1], polygon[2]);
}

}  // namespace cs2mesh
