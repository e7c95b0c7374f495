#include "polygonize/make_manifold.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>

#include "polygonize/half_edges.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
constexpr HalfEdge kNone = std::numeric_limits<HalfEdge>::max();

Index lower_end(const TriangleMesh& mesh, HalfEdge h) {
  return std::min(start_of(mesh, h), end_of(mesh, h));
}
Index upper_end(const TriangleMesh& mesh, HalfEdge h) {
  return std::max(start_of(mesh, h), end_of(mesh, h));
}
bool on_one_edge(const TriangleMesh& mesh, HalfEdge g, HalfEdge h) {
  return lower_end(mesh, g) == lower_end(mesh, h) && upper_end(mesh, g) == upper_end(mesh, h);
}

/// Half-edges by their lower vertex, then the other; those of one direction first.
std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
  const auto count = static_cast<HalfEdge>(3 * mesh.triangles.size());
  std::vector<std::uint32_t> begin(mesh.positions.size() + 1, 0);
  for (HalfEdge h = 0; h < count; ++h) ++begin[lower_end(mesh, h) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> place(begin.begin(), begin.end() - 1);
  using Keyed = std::tuple<Index, bool, HalfEdge>;  // upper vertex, whether from it, half-edge
  std::vector<Keyed> keyed(count);
  for (HalfEdge h = 0; h < count; ++h) {
    const Index lower = lower_end(mesh, h);
    keyed[place[lower]++] = {upper_end(mesh, h), start_of(mesh, h) != lower, h};
  }
  std::vector<HalfEdge> sorted(count);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.positions.size(), 4096),
                    [&](const auto& range) {
                      for (std::size_t v = range.begin(); v < range.end(); ++v) {
                        std::sort(keyed.begin() + begin[v], keyed.begin() + begin[v + 1]);
                        for (std::uint32_t i = begin[v]; i < begin[v + 1]; ++i) {
                          sorted[i] = std::get<2>(keyed[i]);
                        }
                      }
                    });
  return sorted;
}

/// Connectivity that is made up as needed.
class Separation {
 public:
  explicit Separation(TriangleMesh& mesh) : mesh_(mesh) {}

  /// Whether any edge has more than two triangles; pairs the half-edges of each.
  bool pair_up() {
    std::vector<HalfEdge> sorted = sorted_half_edges(mesh_);
    opposite_.assign(sorted.size(), kNone);
    for (std::size_t first = 0; first < sorted.size();) {
      std::size_t last = first;
      while (last < sorted.size() && on_one_edge(mesh_, sorted[first], sorted[last])) ++last;
      const std::size_t pairs = (last - first) / 2;
      pair_edge(std::span(sorted).subspan(first, pairs),
                std::span(sorted).subspan(first + pairs, pairs));
      first = last;
    }
    return !crowded_.empty();
  }

  /// Gives each pair at a crowded edge a vertex of its own in the middle.
  void split_crowded(std::vector<Index>& beside) {
    for (const HalfEdge h : crowded_) {
      const Index a = start_of(mesh_, h), b = end_of(mesh_, h);
      const auto middle = static_cast<Index>(mesh_.positions.size());
      mesh_.positions.push_back(0.5 * (mesh_.positions[a] + mesh_.positions[b]));
      beside.push_back(a);
      const HalfEdge back = opposite_[h];
      const HalfEdge front_part = cut(h, middle);
      const HalfEdge back_part = cut(back, middle);
      join(h, back_part);
      join(back, front_part);
    }
  }

  /// Doubles vertices that have more than one ring of triangles.
  void double_vertices(std::vector<Index>& beside) {
    std::vector<bool> visited(3 * mesh_.triangles.size(), false),
        used(mesh_.positions.size(), false);
    for (HalfEdge start = 0; start < visited.size(); ++start) {
      if (visited[start]) continue;
      Index vertex = start_of(mesh_, start);
      if (used[vertex]) {
        beside.push_back(vertex);
        vertex = static_cast<Index>(mesh_.positions.size());
        mesh_.positions.push_back(Vec3d(mesh_.positions[beside.back()]));
        used.push_back(true);
      }
      used[vertex] = true;
      HalfEdge h = start;
      do {
        visited[h] = true;
        mesh_.triangles[h / 3][h % 3] = vertex;
        h = opposite_[before_in_triangle(h)];
      } while (h != start);
    }
  }

 private:
  Index apex(HalfEdge h) const { return end_of(mesh_, next_in_triangle(h)); }
  /// Joins each half-edge with one that runs back, of another apex if there is one: two triangles
  /// of the same corners would enclose nothing.
  void pair_edge(std::span<const HalfEdge> forth, std::span<HalfEdge> back) {
    for (std::size_t i = 0; i < forth.size(); ++i) {
      const auto other = std::find_if(back.begin() + static_cast<std::ptrdiff_t>(i), back.end(),
                                      [&](HalfEdge h) { return apex(h) != apex(forth[i]); });
      if (other != back.end()) std::iter_swap(back.begin() + static_cast<std::ptrdiff_t>(i), other);
      join(forth[i], back[i]);
      if (forth.size() > 1) crowded_.push_back(forth[i]);
    }
  }
  void join(HalfEdge a, HalfEdge b) {
    opposite_[a] = b;
    opposite_[b] = a;
  }
  /// Cuts the triangle of h from the middle of h to its opposite corner; h becomes its first half.
  /// Returns the second half, in a new triangle.
  HalfEdge cut(HalfEdge h, Index middle) {
    const HalfEdge next = next_in_triangle(h);
    const Index end = start_of(mesh_, next), apex = end_of(mesh_, next);
    const auto part = static_cast<HalfEdge>(3 * mesh_.triangles.size());
    mesh_.triangles.push_back({middle, end, apex});
    opposite_.resize(opposite_.size() + 3);
    join(part + 1, opposite_[next]);
    join(part + 2, next);
    mesh_.triangles[next / 3][next % 3] = middle;
    return part;
  }

  TriangleMesh& mesh_;
  std::vector<HalfEdge> opposite_, crowded_;
};

}  // namespace

std::vector<Index> make_manifold(TriangleMesh& mesh) {
  std::vector<Index> beside;
  Separation separation(mesh);
  if (separation.pair_up()) separation.split_crowded(beside);
  separation.double_vertices(beside);
  for (Index& v : beside) {
    // A copy of a copy or of a middle.
    while (v >= mesh.positions.size() - beside.size()) {
      v = beside[v - (mesh.positions.size() - beside.size())];
    }
  }
  return beside;
}

}  // namespace cs2mesh
