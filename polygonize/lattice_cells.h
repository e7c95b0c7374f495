// Cells, crossed edges and the numbering of vertices of the lattice mesher.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "polygonize/edge_root.h"
#include "polygonize/lattice_nodes.h"
#include "polygonize/triangle_mesh.h"

namespace cs2mesh {

/// A cell with an ambiguous face, cut into pieces around its centre.
struct SplitCell {
  std::uint16_t offset = 0;  ///< of its lowest node
  std::uint8_t inside = 0;   ///< corner bits
  std::uint8_t crossed = 0;  ///< corners whose edge to the centre is crossed
  std::uint8_t joined = 0;   ///< faces whose inside corners are joined, as split_cube() has them
  std::uint32_t first = 0;   ///< number in the block of the lowest crossed corner's vertex
  Vec3d centre;              ///< somewhere in the cell
  Jet jet;

  bool centre_inside() const { return jet.value >= 0; }
};

/// What an active block contributes to the mesh. Vertices are numbered along x, y, z edges by
/// lowest node, then along the edges to the centres of split cells.
struct BlockCells {
  std::array<NodeSet, 3> crossed;              ///< edges, by axis and lowest node
  std::array<std::uint16_t, 24> rank_of_word;  ///< vertices before each word of `crossed`
  std::vector<SplitCell> splits;               ///< by ascending offset
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::uint32_t first_vertex = 0;
  std::uint32_t first_triangle = 0;
  std::size_t values = 0;   ///< evaluations, without gradients
  std::size_t jets = 0;     ///< and with
  std::size_t clamped = 0;  ///< roots

  std::uint32_t edge_vertex(int axis, int offset) const {
    const std::size_t word = static_cast<std::size_t>(8 * axis + (offset >> 6));
    const std::uint64_t before = crossed[static_cast<std::size_t>(axis)].word[offset >> 6] &
                                 ((std::uint64_t{1} << (offset & 63)) - 1);
    return first_vertex + rank_of_word[word] + static_cast<std::uint32_t>(std::popcount(before));
  }
};

/// The closed polygons in which the surface meets the cells of a block, counter-clockwise seen from
/// outside.
struct CellPolygons {
  std::vector<std::uint32_t> corners;  ///< vertices of the mesh, polygon after polygon
  std::vector<std::uint32_t> ends;     ///< by polygon: where its corners end
  std::vector<std::uint16_t> offsets;  ///< by polygon: the lowest node of its cell
  std::vector<char> whole;             ///< by polygon: whether of a cell, not of a piece of one

  std::size_t size() const { return ends.size(); }
  std::span<const std::uint32_t> polygon(std::size_t i) const {
    const std::size_t first = i == 0 ? 0 : ends[i - 1];
    return std::span(corners).subspan(first, ends[i] - first);
  }
};

/// The extraction of a mesh from settled nodes, block by block; each step needs the one before to
/// be done for all blocks.
class LatticeCells {
 public:
  explicit LatticeCells(const LatticeNodes& nodes)
      : nodes_(nodes), band_(nodes.band()), blocks_(nodes.band().active_count()) {}

  /// Finds crossed edges and split cells, and counts what they yield.
  void classify(std::size_t block);
  std::vector<BlockCells>& blocks() { return blocks_; }
  /// Writes the vertices of a block at first_vertex.
  void place_vertices(std::size_t block, std::span<Vec3d> positions);
  /// Writes the triangles of a block at first_triangle.
  void make_triangles(std::size_t block, std::span<const Vec3d> positions,
                      std::span<std::array<TriangleMesh::Index, 3>> triangles) const;
  /// The polygons that make_triangles() cuts. Every edge between two vertices is a side of exactly
  /// two of all polygons, once in each direction; no two polygons share more than one.
  CellPolygons polygons(std::size_t block) const;

 private:
  /// A node by its block and its place there.
  struct NodeRef {
    std::size_t block = 0;
    int offset = 0;
  };
  NodeRef node_at(std::size_t block, const Int3& local) const;
  void add_split(std::size_t block, int offset, unsigned inside);
  void settle_centres(std::size_t block);
  template <class F>
  void for_each_polygon(std::size_t block, F&& f) const;
  std::uint32_t lattice_edge_vertex(std::size_t block, int offset, int a, int b) const;
  std::uint32_t split_edge_vertex(std::size_t block, const SplitCell& cell, int a, int b) const;

  const LatticeNodes& nodes_;
  const NarrowBand& band_;
  std::vector<BlockCells> blocks_;
};

/// Cuts ears off a polygon, the one with the shortest chord first, and appends the triangles at
/// `out`; `polygon` is used up.
void triangulate(std::span<std::uint32_t> polygon, std::span<const Vec3d> positions,
                 std::array<TriangleMesh::Index, 3>*& out);

}  // namespace cs2mesh
