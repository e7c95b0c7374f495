#include "polygonize/dual_surface.h"

#include <algorithm>

#include "libfield/base/check.h"
#include "polygonize/ear_cutting.h"
#include "polygonize/edge_set.h"

namespace cs2mesh {
template <class F>
void DualSurface::for_each_polygon(const F& f) const {
  std::size_t first = 0;
  for (const std::uint8_t length : lengths_) {
    f(std::span(corners_).subspan(first, length));
    first += length;
  }
}

DualSurface::DualSurface(const Octree& octree)
    : octree_(octree), cells_(mixed_dual_cells(octree)), first_of_(octree.size(), Crossing::kNone) {
  for (const DualCell& cell : cells_) {
    if (!cube_table().cases[inside_corners(octree, cell)].ambiguous) continue;
    middles_.push_back(octree.point(meeting_point(octree, cell)));
  }
}

void DualSurface::cross(const std::vector<bool>& inside) {
  require(inside.size() == middles_.size(), "DualSurface: one side a middle");
  Index middle = 0;
  for (const DualCell& cell : cells_) {
    const unsigned corners = inside_corners(octree_, cell);
    const CellCase& cut = cube_table().cases[corners];
    if (!cut.ambiguous) {
      add_plain(cell, cut);
    } else {
      add_split(cell, corners | (inside[middle] ? 1U << kCentre : 0U), middle);
      ++middle;
    }
  }
}

void DualSurface::add_plain(const DualCell& cell, const CellCase& cut) {
  std::array<Index, 8> polygon;
  for (std::size_t c = 0; c < cut.cycle_count; ++c) {
    const CellCycle& cycle = cut.cycles[c];
    for (std::size_t i = 0; i < cycle.length; ++i) {
      const auto& edge = cube_table().edges[cycle.edge[i]];
      polygon[i] = vertex_between(cell[edge[0]], cell[edge[1]]);
    }
    add_polygon(std::span(polygon).first(cycle.length));
  }
}

void DualSurface::add_split(const DualCell& cell, unsigned inside, Index middle) {
  for_each_piece(inside, [&](const CellCase& cut, const CellTable& table, const SubCell& piece) {
    std::array<Index, 8> polygon;
    for (std::size_t c = 0; c < cut.cycle_count; ++c) {
      const CellCycle& cycle = cut.cycles[c];
      for (std::size_t i = 0; i < cycle.length; ++i) {
        const auto& edge = table.edges[cycle.edge[i]];
        const int a = piece.corner[edge[0]], b = piece.corner[edge[1]];
        polygon[i] = a == kCentre   ? vertex_at_middle(cell[static_cast<std::size_t>(b)], middle)
                     : b == kCentre ? vertex_at_middle(cell[static_cast<std::size_t>(a)], middle)
                                    : vertex_between(cell[static_cast<std::size_t>(a)],
                                                     cell[static_cast<std::size_t>(b)]);
      }
      add_polygon(std::span(polygon).first(cycle.length));
    }
  });
}

DualSurface::Index DualSurface::vertex_between(Index a, Index b) {
  if (a > b) std::swap(a, b);
  for (Index v = first_of_[a]; v != Crossing::kNone; v = next_[v]) {
    if (crossings_[v].middle == Crossing::kNone && crossings_[v].other == b) return v;
  }
  const auto v = static_cast<Index>(crossings_.size());
  crossings_.push_back({a, b});
  next_.push_back(first_of_[a]);
  first_of_[a] = v;
  return v;
}

DualSurface::Index DualSurface::vertex_at_middle(Index leaf, Index middle) {
  for (Index v = first_of_[leaf]; v != Crossing::kNone; v = next_[v]) {
    if (crossings_[v].middle == middle) return v;
  }
  const auto v = static_cast<Index>(crossings_.size());
  crossings_.push_back({leaf, leaf, middle});
  next_.push_back(first_of_[leaf]);
  first_of_[leaf] = v;
  return v;
}

/// Drops sides of length 0, and what has no area then.
void DualSurface::add_polygon(std::span<const Index> vertices) {
  const std::size_t first = corners_.size();
  for (const Index v : vertices) {
    if (corners_.size() == first || corners_.back() != v) corners_.push_back(v);
  }
  while (corners_.size() > first + 1 && corners_.back() == corners_[first]) corners_.pop_back();
  const std::size_t length = corners_.size() - first;
  if (length < 3) {
    corners_.resize(first);
  } else {
    lengths_.push_back(static_cast<std::uint8_t>(length));
  }
}

std::vector<std::array<DualSurface::Index, 3>> DualSurface::triangulate(
    std::vector<Vec3d>& positions, std::vector<Index>& beside) const {
  require(positions.size() == crossings_.size(), "DualSurface: one place a crossing");
  // Two leaves may meet in several places, so a chord of one polygon may be an edge of another.
  EdgeSet edges(corners_.size());
  for_each_polygon([&](std::span<const Index> polygon) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      edges.insert(polygon[i], polygon[(i + 1) % polygon.size()]);
    }
  });
  std::vector<std::array<Index, 3>> triangles;
  triangles.reserve(corners_.size() - 2 * lengths_.size());
  const auto emit = [&](Index a, Index b, Index c) {
    edges.insert(a, c);
    triangles.push_back({a, b, c});
  };
  std::vector<Index> open;
  for_each_polygon([&](std::span<const Index> polygon) {
    open.assign(polygon.begin(), polygon.end());
    const auto may_join = [&](Index a, Index b) { return !edges.contains(a, b); };
    open.resize(cut_ears(open, positions, may_join, emit));
    if (open.size() == 3) {
      triangles.push_back({open[0], open[1], open[2]});
      return;
    }
    const auto middle = static_cast<Index>(positions.size());
    Vec3d sum{};
    for (const Index v : open) sum += positions[v];
    positions.push_back(sum / static_cast<double>(open.size()));
    beside.push_back(open[0]);
    for (std::size_t i = 0; i < open.size(); ++i) {
      triangles.push_back({open[i], open[(i + 1) % open.size()], middle});
    }
  });
  return triangles;
}

}  // namespace cs2mesh
