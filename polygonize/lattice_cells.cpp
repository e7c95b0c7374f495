#include "polygonize/lattice_cells.h"

#include <algorithm>
#include <bit>

#include "libfield/base/check.h"
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
  settle_faces(index);
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

/// The middle of a face of a cell, to the bit the same for both cells at it: their corners come in
/// one order.
Vec3d LatticeCells::middle_of(std::size_t index, int offset, unsigned face) const {
  Vec3d middle{};
  const std::vector<int>& corners = cube_shape().faces[face];
  for (int c = 0; c < 8; ++c) {
    if (std::find(corners.begin(), corners.end(), c) == corners.end()) continue;
    const NodeRef node = node_at(index, local_node(offset) + corner_step(c));
    middle += 0.25 * nodes_.position(node.block, node.offset);
  }
  return middle;
}

/// Samples the middles of ambiguous faces, which tell what is joined across them.
void LatticeCells::settle_faces(std::size_t index) {
  std::vector<SplitCell>& splits = blocks_[index].splits;
  std::vector<Vec3d> middles;
  for (const SplitCell& split : splits) {
    for (unsigned faces = ambiguous_faces(split.inside); faces != 0; faces &= faces - 1) {
      const auto face = static_cast<unsigned>(std::countr_zero(faces));
      middles.push_back(middle_of(index, split.offset, face));
    }
  }
  if (middles.empty()) return;
  std::vector<double> values(middles.size());
  band_.surface(index).values(middles, values);
  blocks_[index].values += middles.size();
  auto value = values.begin();
  for (SplitCell& split : splits) {
    unsigned joined = ambiguous_faces(split.inside);
    for (unsigned faces = joined; faces != 0; faces &= faces - 1) {
      if (!(*value++ >= 0)) joined &= ~(1U << std::countr_zero(faces));
    }
    split.joined = static_cast<std::uint8_t>(joined);
  }
}

/// Samples the centres, moves those near the surface, and numbers the vertices on their edges.
void LatticeCells::settle_centres(std::size_t index) {
  BlockCells& block = blocks_[index];
  if (block.splits.empty()) return;
  const ImplicitSurface& surface = band_.surface(index);
  const double cell = band_.lattice().cell;
  std::vector<Vec3d> points;
  for (const SplitCell& split : block.splits) points.push_back(split.centre);
  std::vector<Jet> jets(points.size());
  surface.jets(points, jets);
  block.jets += points.size();
  for (std::size_t i = 0; i < points.size(); ++i) {
    SplitCell& split = block.splits[i];
    split.jet = jets[i];
    if (!NodeMover::near(split.jet, cell)) continue;
    std::array<Vec3d, NodeMover::kTrials + 1> places;
    std::array<Jet, NodeMover::kTrials + 1> trials;
    places[0] = NodeMover::first_place(split.centre, split.jet, cell);
    for (int k = 0; k < NodeMover::kTrials; ++k) {
      places[static_cast<std::size_t>(k + 1)] =
          NodeMover::other_place(split.centre, split.jet, cell, k);
    }
    surface.jets(places, trials);
    block.jets += places.size();
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!(clearance(trials[k]) > clearance(split.jet))) continue;
      split.centre = places[k];
      split.jet = trials[k];
      if (!NodeMover::near(split.jet, cell)) break;
    }
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
