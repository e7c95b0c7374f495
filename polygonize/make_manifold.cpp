#include "polygonize/make_manifold.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <limits>
#include <span>

#include "polygonize/half_edges.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
constexpr HalfEdge kNone = std::numeric_limits<HalfEdge>::max();

/// The same for both directions of an edge, and for no other.
std::uint64_t edge_of(const TriangleMesh& mesh, HalfEdge h) {
  const Index a = start_of(mesh, h), b = end_of(mesh, h);
  return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
}

/// Half-edges by their lower vertex, then the other; those of one direction first.
std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
  struct Keyed {
    std::uint64_t key;
    HalfEdge half_edge;
  };
  std::vector<Keyed> keyed;
  keyed.reserve(3 * mesh.triangles.size());
  for (HalfEdge h = 0; h < 3 * mesh.triangles.size(); ++h) {
    keyed.push_back({edge_of(mesh, h), h});
  }
  const auto order = [&](const Keyed& x, const Keyed& y) {
    if (x.key != y.key) return x.key < y.key;
    const bool x_up = start_of(mesh, x.half_edge) < end_of(mesh, x.half_edge);
    const bool y_up = start_of(mesh, y.half_edge) < end_of(mesh, y.half_edge);
    return x_up != y_up ? x_up : x.half_edge < y.half_edge;
  };
  tbb::parallel_sort(keyed.begin(), keyed.end(), order);
  std::vector<HalfEdge> sorted;
  sorted.reserve(keyed.size());
  for (const Keyed& k : keyed) sorted.push_back(k.half_edge);
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
      const std::uint64_t edge = edge_of(mesh_, sorted[first]);
      while (last < sorted.size() && edge_of(mesh_, sorted[last]) == edge) ++last;
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
