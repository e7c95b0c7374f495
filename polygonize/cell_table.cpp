#include "polygonize/cell_table.h"

#include <algorithm>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

constexpr int kUncrossed = -1;

/// For one face: the crossing where the walk around it leaves the shape, and where it enters.
struct FaceCrossings {
  int leave = kUncrossed;
  int enter = kUncrossed;
  int count = 0;
};

FaceCrossings crossings_of(const CellTable& table, const std::vector<int>& face, unsigned inside) {
  FaceCrossings found;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const int a = face[i];
    const int b = face[(i + 1) % face.size()];
    const bool a_in = (inside >> a) & 1U;
    const bool b_in = (inside >> b) & 1U;
    if (a_in == b_in) continue;
    ++found.count;
    (a_in ? found.leave : found.enter) = table.edge_between(a, b);
  }
  return found;
}

CellCase make_case(const CellTable& table, const CellShape& shape, unsigned inside) {
  CellCase result;
  // Seen from outside the cell, the piece of surface behind a face runs along it from the crossing
  // where the face's boundary enters the shape to the one where it leaves: with the inside corner
  // behind, the surface's normal then points away from it.
  std::array<int, 16> next;
  next.fill(kUncrossed);
  for (const std::vector<int>& face : shape.faces) {
    const FaceCrossings crossings = crossings_of(table, face, inside);
    if (crossings.count > 2) result.ambiguous = true;
    if (crossings.count == 2) next[static_cast<std::size_t>(crossings.enter)] = crossings.leave;
  }
  if (result.ambiguous) return result;

  // Follow the segments around.
  for (std::size_t start = 0; start < next.size(); ++start) {
    if (next[start] == kUncrossed) continue;
    CellCycle cycle;
    for (std::size_t edge = start; next[edge] != kUncrossed;) {
      cycle.edge[cycle.length++] = static_cast<std::uint8_t>(edge);
      const int following = next[edge];
      next[edge] = kUncrossed;
      edge = static_cast<std::size_t>(following);
    }
    result.triangle_count = static_cast<std::uint8_t>(result.triangle_count + cycle.length - 2);
    result.cycles[result.cycle_count++] = cycle;
  }
  return result;
}

}  // namespace

int CellTable::edge_between(int a, int b) const {
  const std::array<std::uint8_t, 2> pair{static_cast<std::uint8_t>(std::min(a, b)),
                                         static_cast<std::uint8_t>(std::max(a, b))};
  const auto found = std::find(edges.begin(), edges.end(), pair);
  require(found != edges.end(), "CellTable: no such edge");
  return static_cast<int>(found - edges.begin());
}

CellTable make_cell_table(const CellShape& shape) {
  CellTable table;
  for (const std::vector<int>& face : shape.faces) {
    for (std::size_t i = 0; i < face.size(); ++i) {
      const auto [a, b] = std::minmax(face[i], face[(i + 1) % face.size()]);
      table.edges.push_back({static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)});
    }
  }
  std::sort(table.edges.begin(), table.edges.end());
  table.edges.erase(std::unique(table.edges.begin(), table.edges.end()), table.edges.end());
  for (unsigned inside = 0; inside < (1U << shape.corners); ++inside) {
    table.cases.push_back(make_case(table, shape, inside));
  }
  return table;
}

const CellShape& cube_shape() {
  static const CellShape shape{
      8, {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  return shape;
}

const CellShape& pyramid_shape() {
  static const CellShape shape{5, {{0, 1, 2, 3}, {1, 0, 4}, {2, 1, 4}, {3, 2, 4}, {0, 3, 4}}};
  return shape;
}

const CellShape& tetrahedron_shape() {
  static const CellShape shape{4, {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}}};
  return shape;
}

const CellTable& cube_table() {
  static const CellTable table = make_cell_table(cube_shape());
  return table;
}

const CellTable& pyramid_table() {
  static const CellTable table = make_cell_table(pyramid_shape());
  return table;
}

const CellTable& tetrahedron_table() {
  static const CellTable table = make_cell_table(tetrahedron_shape());
  return table;
}

namespace {

/// Whether the signs at the corners of a face are + - + -.
bool alternates(const std::vector<int>& face, unsigned inside) {
  const auto sign = [&](std::size_t i) { return (inside >> face[i]) & 1U; };
  return sign(0) == sign(2) && sign(1) == sign(3) && sign(0) != sign(1);
}

}  // namespace

unsigned ambiguous_faces(unsigned inside_corners) {
  unsigned faces = 0;
  for (std::size_t f = 0; f < 6; ++f) {
    if (alternates(cube_shape().faces[f], inside_corners)) faces |= 1U << f;
  }
  return faces;
}

int split_cube(unsigned inside_corners, unsigned joined, std::span<SubCell, 12> cells) {
  const auto tetrahedron = [](int a, int b, int c) {
    return SubCell{{static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b),
                    static_cast<std::uint8_t>(c), kCentre, 0},
                   false};
  };
  std::size_t count = 0;
  for (std::size_t face = 0; face < 6; ++face) {
    const std::vector<int>& f = cube_shape().faces[face];
    if (!alternates(f, inside_corners)) {
      SubCell pyramid{{0, 0, 0, 0, kCentre}, true};
      for (std::size_t i = 0; i < 4; ++i) pyramid.corner[i] = static_cast<std::uint8_t>(f[i]);
      cells[count++] = pyramid;
      continue;
    }
    const bool from_first = ((inside_corners >> f[0]) & 1U) == ((joined >> face) & 1U);
    if (from_first) {
      cells[count++] = tetrahedron(f[0], f[1], f[2]);
      cells[count++] = tetrahedron(f[0], f[2], f[3]);
    } else {
      cells[count++] = tetrahedron(f[0], f[1], f[3]);
      cells[count++] = tetrahedron(f[1], f[2], f[3]);
    }
  }
  return static_cast<int>(count);
}

}  // namespace cs2mesh
