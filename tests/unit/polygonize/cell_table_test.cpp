#include "polygonize/cell_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "libfield/base/random.h"
#include "polygonize/lattice.h"
#include "polygonize/lattice_cells.h"
#include "polygonize/self_intersection.h"

namespace cs2mesh {
namespace {

/// Crossed edges are named by their two corners: 0 .. 7, and 8 for the centre.
using Edge = std::pair<int, int>;
using Cycle = std::vector<Edge>;

/// All cycles in a cube; `centre_inside` and `joined` matter for ambiguous cubes only.
std::vector<Cycle> cycles_in_cube(unsigned inside, bool centre_inside, unsigned joined) {
  std::vector<Cycle> cycles;
  const auto collect = [&](const CellTable& table, unsigned mask, auto&& corner_of) {
    const CellCase& cell = table.cases[mask];
    EXPECT_FALSE(cell.ambiguous);
    for (std::size_t i = 0; i < cell.cycle_count; ++i) {
      Cycle cycle;
      for (std::size_t k = 0; k < cell.cycles[i].length; ++k) {
        const auto& edge = table.edges[cell.cycles[i].edge[k]];
        cycle.push_back(std::minmax(int{corner_of(edge[0])}, int{corner_of(edge[1])}));
      }
      cycles.push_back(cycle);
    }
  };
  if (!cube_table().cases[inside].ambiguous) {
    collect(cube_table(), inside, [](int c) { return c; });
    return cycles;
  }
  std::array<SubCell, 12> cells;
  const int count = split_cube(inside, joined, cells);
  const unsigned all = inside | (centre_inside ? 256U : 0U);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const SubCell& cell = cells[i];
    unsigned mask = 0;
    for (unsigned c = 0; c < (cell.pyramid ? 5U : 4U); ++c) {
      mask |= ((all >> cell.corner[c]) & 1U) << c;
    }
    collect(cell.pyramid ? pyramid_table() : tetrahedron_table(), mask,
            [&](int c) { return cell.corner[c]; });
  }
  return cycles;
}

/// Directed segments of cycles that no other cycle runs back along.
std::set<std::pair<Edge, Edge>> border(const std::vector<Cycle>& cycles) {
  std::set<std::pair<Edge, Edge>> segments;
  for (const Cycle& cycle : cycles) {
    for (std::size_t i = 0; i < cycle.size(); ++i) {
      const auto segment = std::pair(cycle[i], cycle[(i + 1) % cycle.size()]);
      EXPECT_TRUE(segments.insert(segment).second) << "a segment runs twice the same way";
    }
  }
  std::set<std::pair<Edge, Edge>> open;
  for (const auto& [a, b] : segments) {
    if (!segments.contains({b, a})) open.insert({a, b});
  }
  return open;
}

bool in_face(const Edge& edge, const std::vector<int>& face) {
  return std::find(face.begin(), face.end(), edge.first) != face.end() &&
         std::find(face.begin(), face.end(), edge.second) != face.end();
}

Vec3d corner_place(int c) {
  return c == kCentre ? Vec3d{0.5, 0.5, 0.5}
                      : Vec3d{double(c & 1), double(c >> 1 & 1), double(c >> 2 & 1)};
}

/// Calls f(joined) for every choice of ambiguous faces whose inside corners are joined.
template <class F>
void for_each_joining(unsigned inside, F&& f) {
  const unsigned faces = ambiguous_faces(inside);
  for (unsigned joined = faces;; joined = (joined - 1) & faces) {
    f(joined);
    if (joined == 0) return;
  }
}

void expect_closed_up_to_faces(unsigned inside, bool centre_inside, unsigned joined) {
  const auto cycles = cycles_in_cube(inside, centre_inside, joined);
  std::set<Edge> on_cycles;
  for (const Cycle& cycle : cycles) {
    EXPECT_GE(cycle.size(), 3U);
    EXPECT_LE(cycle.size(), 7U);
    for (const Edge& e : cycle) on_cycles.insert(e);
  }
  // Every crossed edge of the cube has a vertex, and only those.
  for (const auto& [a, b] : cube_table().edges) {
    const bool crossed = ((inside >> a) & 1U) != ((inside >> b) & 1U);
    EXPECT_EQ(on_cycles.contains({a, b}), crossed);
  }
  // What is open lies in faces of the cube, as many segments a face as the face has pairs; in an
  // ambiguous face each cuts off a corner, of those that are not joined.
  std::map<std::size_t, int> segments;
  for (const auto& [a, b] : border(cycles)) {
    std::size_t faces = 0;
    for (std::size_t f = 0; f < 6; ++f) {
      if (!in_face(a, cube_shape().faces[f]) || !in_face(b, cube_shape().faces[f])) continue;
      ++segments[f];
      ++faces;
      if (((ambiguous_faces(inside) >> f) & 1U) == 0) continue;
      const bool meet_in_first = a.first == b.first || a.first == b.second;
      const int corner = meet_in_first ? a.first : a.second;
      EXPECT_EQ(((inside >> corner) & 1U) != 0, ((joined >> f) & 1U) == 0);
    }
    EXPECT_EQ(faces, 1U) << "case " << inside;
  }
  for (std::size_t f = 0; f < 6; ++f) {
    const auto& face = cube_shape().faces[f];
    int changes = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      changes += ((inside >> face[i]) & 1U) != ((inside >> face[(i + 1) % 4]) & 1U) ? 1 : 0;
    }
    EXPECT_EQ(segments[f], changes / 2) << "case " << inside << " face " << f;
  }
}

TEST(CellTable, EveryCubeClosesUpToItsFaces) {
  for (unsigned inside = 0; inside < 256; ++inside) {
    for (const bool centre_inside : {false, true}) {
      for_each_joining(inside, [&](unsigned joined) {
        expect_closed_up_to_faces(inside, centre_inside, joined);
      });
    }
  }
}

TEST(CellTable, NeighboursAgreeOnTheirCommonFace) {
  // Twelve corners of two cubes side by side along each axis: bit 3 g + k is corner k of layer g.
  for (int axis = 0; axis < 3; ++axis) {
    const int step = 1 << axis;
    for (unsigned signs = 0; signs < 4096; ++signs) {
      std::array<unsigned, 2> inside{};
      for (int cube = 0; cube < 2; ++cube) {
        for (int c = 0; c < 8; ++c) {
          const int layer = cube + ((c & step) != 0 ? 1 : 0);
          const int low = c & (step - 1);
          const int place = low | ((c & ~(2 * step - 1)) >> 1);  // the corner without this axis
          inside[static_cast<std::size_t>(cube)] |= ((signs >> (4 * layer + place)) & 1U) << c;
        }
      }
      std::set<std::pair<Edge, Edge>> first;
      std::set<std::pair<Edge, Edge>> second;
      const auto moved = [step](const Edge& e) { return Edge{e.first ^ step, e.second ^ step}; };
      const auto all_in = [step](const Edge& e, bool upper) {
        return e.first != kCentre && e.second != kCentre && ((e.first & step) != 0) == upper &&
               ((e.second & step) != 0) == upper;
      };
      for (const unsigned joined : {0U, 0x3fU}) {
        first.clear();
        second.clear();
        for (const auto& [a, b] : border(cycles_in_cube(inside[0], false, joined))) {
          if (all_in(a, true) && all_in(b, true)) first.insert({moved(a), moved(b)});
        }
        for (const auto& [a, b] : border(cycles_in_cube(inside[1], true, joined))) {
          if (all_in(a, false) && all_in(b, false)) second.insert({b, a});
        }
        ASSERT_EQ(first, second) << "axis " << axis << " signs " << signs;
      }
    }
  }
}

TEST(CellTable, TheInsideIsBehindTheTriangles) {
  // One inside corner: its triangle faces away from it.
  for (int corner = 0; corner < 8; ++corner) {
    const auto cycles = cycles_in_cube(1U << corner, false, 0);
    ASSERT_EQ(cycles.size(), 1U);
    ASSERT_EQ(cycles[0].size(), 3U);
    std::array<Vec3d, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = 0.5 * (corner_place(cycles[0][i].first) + corner_place(cycles[0][i].second));
    }
    const Vec3d normal = cross(p[1] - p[0], p[2] - p[0]);
    EXPECT_GT(dot(normal, p[0] - corner_place(corner)), 0.0);
  }
}

/// Whether triangles cross in a cube, wherever its crossings are.
void expect_no_intersections(unsigned inside, const std::vector<Cycle>& cycles,
                             std::uint64_t trials) {
  for (std::uint64_t trial = 0; trial < trials; ++trial) {
    Random random(trial, inside);
    TriangleMesh mesh;
    std::map<Edge, std::uint32_t> vertex;
    for (const Cycle& cycle : cycles) {
      for (const Edge& e : cycle) {
        if (!vertex.emplace(e, mesh.positions.size()).second) continue;
        // Crossings near the ends as often as in the middle.
        const double u = random.uniform();
        const double t = trial % 2 == 0 ? u : u < 0.5 ? 0.02 + 0.1 * u : 0.98 - 0.1 * (1 - u);
        mesh.positions.push_back((1 - t) * corner_place(e.first) + t * corner_place(e.second));
      }
    }
    for (const Cycle& cycle : cycles) {
      std::vector<std::uint32_t> polygon;
      for (const Edge& e : cycle) polygon.push_back(vertex[e]);
      std::array<TriangleMesh::Index, 3> triangles[8];
      auto* end = triangles;
      triangulate(polygon, mesh.positions, end);
      ASSERT_EQ(static_cast<std::size_t>(end - triangles), cycle.size() - 2);
      mesh.triangles.insert(mesh.triangles.end(), triangles, end);
    }
    const auto found = find_self_intersections(mesh, 1);
    ASSERT_EQ(found ? found->count : 0, 0U) << "case " << inside << " trial " << trial;
  }
}

TEST(CellTable, NoIntersectionsInACellWhereverTheCrossingsAre) {
  for (unsigned inside = 1; inside < 255; ++inside) {
    for (const bool centre_inside : {false, true}) {
      for_each_joining(inside, [&](unsigned joined) {
        const std::uint64_t trials = joined == 0 ? 20 : 4;
        expect_no_intersections(inside, cycles_in_cube(inside, centre_inside, joined), trials);
      });
    }
  }
}

}  // namespace
}  // namespace cs2mesh
