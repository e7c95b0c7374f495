#include "polygonize/dual_surface.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <utility>

#include "libfield/base/check.h"
#include "polygonize/ear_cutting.h"
#include "polygonize/edge_set.h"

namespace cs2mesh {

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
  for_each_piece(inside, 0, [&](const CellCase& cut, const CellTable& table, const SubCell& piece) {
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

/// Cuts polygons into triangles, each as if those before it were cut already: a chord of one may be
/// an edge of another, as two leaves may meet in several places.
class DualSurface::Cutting {
 public:
  using Triangle = std::array<Index, 3>;

  /// `first` holds for each polygon its first corner, and the number of all corners.
  Cutting(std::span<const Index> corners, std::span<const std::size_t> first,
          std::vector<Vec3d>& positions, std::vector<Index>& beside)
      : corners_(corners),
        first_(first),
        positions_(positions),
        beside_(beside),
        edges_(corners.size()),
        chords_(corners.size() - 2 * count()),
        triangles_(corners.size() - 2 * count()),
        whole_(count(), 1) {}

  std::vector<Triangle> run() {
    for_each_aside([&](std::size_t k) {
      const std::span<const Index> p = polygon(k);
      for (std::size_t i = 0; i < p.size(); ++i) edges_.insert(p[i], p[(i + 1) % p.size()]);
    });
    for_each_aside([&](std::size_t k) { whole_[k] = cut(k) ? 1 : 0; });
    for (std::size_t k = 0; k < count(); ++k) {
      if (whole_[k] == 0 || !take_chords(k)) cut_again(k);
    }
    return again_.empty() ? std::move(triangles_) : together();
  }

 private:
  std::size_t count() const { return first_.size() - 1; }
  std::span<const Index> polygon(std::size_t k) const {
    return corners_.subspan(first_[k], first_[k + 1] - first_[k]);
  }
  /// Two less than it has corners.
  std::span<Triangle> triangles_of(std::size_t k) {
    return std::span(triangles_).subspan(first_[k] - 2 * k, polygon(k).size() - 2);
  }
  template <class F>
  void for_each_aside(const F& f) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count(), 2048), [&](const auto& range) {
      for (std::size_t k = range.begin(); k < range.end(); ++k) f(k);
    });
  }

  /// Cuts a polygon as if it were the first; false if that cannot be.
  bool cut(std::size_t k) {
    const std::span<const Index> all = polygon(k);
    boost::container::small_vector<Index, 16> open(all.begin(), all.end());
    const std::span<Triangle> out = triangles_of(k);
    std::size_t found = 0;
    const auto may_join = [&](Index a, Index b) { return !edges_.contains(a, b); };
    const auto emit = [&](Index a, Index b, Index c) { out[found++] = {a, b, c}; };
    if (cut_ears({open.data(), open.size()}, positions_, may_join, emit) != 3) return false;
    out[found] = {open[0], open[1], open[2]};
    return true;
  }

  /// Whether no chord was drawn before; they count as drawn then.
  bool take_chords(std::size_t k) {
    const std::span<const Triangle> ears = triangles_of(k).first(polygon(k).size() - 3);
    const auto same = [](const Triangle& a, const Triangle& b) {
      return std::minmax(a[0], a[2]) == std::minmax(b[0], b[2]);
    };
    for (std::size_t i = 0; i < ears.size(); ++i) {
      if (chords_.contains(ears[i][0], ears[i][2])) return false;
      for (std::size_t j = 0; j < i; ++j) {
        if (same(ears[i], ears[j])) return false;
      }
    }
    for (const Triangle& ear : ears) chords_.insert(ear[0], ear[2]);
    return true;
  }

  /// Around a vertex in the middle where no chord can be drawn any more.
  void cut_again(std::size_t k) {
    const std::span<const Index> all = polygon(k);
    std::vector<Index> open(all.begin(), all.end());
    std::vector<Triangle>& out = again_.emplace_back(k, std::vector<Triangle>{}).second;
    const auto may_join = [&](Index a, Index b) {
      return !edges_.contains(a, b) && !chords_.contains(a, b);
    };
    const auto emit = [&](Index a, Index b, Index c) {
      chords_.insert(a, c);
      out.push_back({a, b, c});
    };
    open.resize(cut_ears(open, positions_, may_join, emit));
    if (open.size() == 3) {
      out.push_back({open[0], open[1], open[2]});
      return;
    }
    const auto middle = static_cast<Index>(positions_.size());
    Vec3d sum{};
    for (const Index v : open) sum += positions_[v];
    positions_.push_back(sum / static_cast<double>(open.size()));
    beside_.push_back(open[0]);
    for (std::size_t i = 0; i < open.size(); ++i) {
      out.push_back({open[i], open[(i + 1) % open.size()], middle});
    }
  }

  /// Those of all polygons in order.
  std::vector<Triangle> together() {
    std::vector<Triangle> all;
    all.reserve(triangles_.size() + 4 * again_.size());
    auto next = again_.begin();
    for (std::size_t k = 0; k < count(); ++k) {
      if (next != again_.end() && next->first == k) {
        all.insert(all.end(), next->second.begin(), next->second.end());
        ++next;
      } else {
        const std::span<const Triangle> own = triangles_of(k);
        all.insert(all.end(), own.begin(), own.end());
      }
    }
    return all;
  }

  std::span<const Index> corners_;
  std::span<const std::size_t> first_;
  std::vector<Vec3d>& positions_;
  std::vector<Index>& beside_;
  EdgeSet edges_, chords_;  ///< sides of polygons; chords that were drawn
  std::vector<Triangle> triangles_;
  std::vector<char> whole_;
  std::vector<std::pair<std::size_t, std::vector<Triangle>>> again_;  ///< by polygon
};

std::vector<std::array<DualSurface::Index, 3>> DualSurface::triangulate(
    std::vector<Vec3d>& positions, std::vector<Index>& beside) const {
  require(positions.size() == crossings_.size(), "DualSurface: one place a crossing");
  std::vector<std::size_t> first{0};
  first.reserve(lengths_.size() + 1);
  for (const std::uint8_t length : lengths_) first.push_back(first.back() + length);
  return Cutting(corners_, first, positions, beside).run();
}

}  // namespace cs2mesh
