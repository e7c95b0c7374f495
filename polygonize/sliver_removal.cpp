#include "polygonize/sliver_removal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "libfield/base/check.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
using Corners = std::array<Index, 3>;

constexpr int kMostPasses = 12;
/// The cosine of the angle by which a triangle may turn.
constexpr double kMostTurned = 0.5;

class SliverRemover {
 public:
  SliverRemover(TaggedMesh& mesh, std::vector<char>& is_open, double height)
      : mesh_(mesh.mesh),
        tags_(mesh.tags),
        is_open_(is_open),
        height_(height),
        stars_(mesh_.positions.size()) {
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      for (const Index v : mesh_.triangles[t]) stars_[v].push_back(static_cast<std::uint32_t>(t));
    }
  }

  std::size_t run() {
    std::vector<std::uint32_t> slivers = find_slivers();
    for (int pass = 0; pass < kMostPasses && !slivers.empty(); ++pass) {
      bool changed = false;
      for (const std::uint32_t t : slivers) {
        if (!is_gone(t) && flatness(mesh_.triangles[t]) < height_) changed |= remove(t);
      }
      slivers = find_slivers();
      if (!changed) break;
    }
    close_gaps();
    return slivers.size();
  }

 private:
  // ---- Geometry ----

  const Vec3d& at(Index v) const { return mesh_.positions[v]; }
  Vec3d normal(const Corners& t) const { return cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0])); }
  double squared_length(Index a, Index b) const { return squared_norm(at(b) - at(a)); }

  /// The corner from which the longest edge starts.
  std::size_t longest(const Corners& t) const { return extreme_edge(t, 1.0); }
  std::size_t shortest(const Corners& t) const { return extreme_edge(t, -1.0); }
  std::size_t extreme_edge(const Corners& t, double sign) const {
    std::size_t found = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      const double best = sign * squared_length(t[found], t[(found + 1) % 3]);
      if (sign * squared_length(t[k], t[(k + 1) % 3]) > best) found = k;
    }
    return found;
  }
  /// The least height.
  double flatness(const Corners& t) const {
    const std::size_t k = longest(t);
    const double base = std::sqrt(squared_length(t[k], t[(k + 1) % 3]));
    return base > 0 ? norm(normal(t)) / base : 0.0;
  }

  /// Whether `after` may stand where `before` stood. What was a sliver had no direction to keep.
  bool may_become(const Corners& before, const Corners& after) const {
    const Vec3d m = normal(after);
    const double old_height = flatness(before);
    if (old_height < height_) return flatness(after) >= 0.5 * old_height;
    const Vec3d n = normal(before);
    return dot(n, m) > kMostTurned * norm(n) * norm(m) && flatness(after) > 0.25 * height_;
  }

  // ---- Connectivity ----

  static bool has(const Corners& t, Index v) { return t[0] == v || t[1] == v || t[2] == v; }
  bool is_gone(std::uint32_t t) const { return mesh_.triangles[t][0] == mesh_.triangles[t][1]; }

  std::vector<Index> neighbours(Index v) const {
    std::vector<Index> all;
    for (const std::uint32_t t : stars_[v]) {
      const Corners& corner = mesh_.triangles[t];
      // Each neighbour follows v in exactly one triangle.
      for (std::size_t k = 0; k < 3; ++k) {
        if (corner[k] == v) all.push_back(corner[(k + 1) % 3]);
      }
    }
    std::sort(all.begin(), all.end());
    return all;
  }
  bool are_neighbours(Index a, Index b) const {
    return std::any_of(stars_[a].begin(), stars_[a].end(),
                       [&](std::uint32_t t) { return has(mesh_.triangles[t], b); });
  }
  /// The triangle in which the edge runs from a to b.
  std::uint32_t triangle_along(Index a, Index b) const {
    const auto found = std::find_if(stars_[a].begin(), stars_[a].end(), [&](std::uint32_t t) {
      const Corners& corner = mesh_.triangles[t];
      for (std::size_t k = 0; k < 3; ++k) {
        if (corner[k] == a && corner[(k + 1) % 3] == b) return true;
      }
      return false;
    });
    require(found != stars_[a].end(), "remove_slivers: the mesh is closed");
    return *found;
  }
  Index third(std::uint32_t t, Index a, Index b) const {
    const Corners& corner = mesh_.triangles[t];
    return corner[0] != a && corner[0] != b   ? corner[0]
           : corner[1] != a && corner[1] != b ? corner[1]
                                              : corner[2];
  }
  bool on_crease(Index v) const {
    const std::uint32_t first = tags_[stars_[v].front()];
    return std::any_of(stars_[v].begin(), stars_[v].end(),
                       [&](std::uint32_t t) { return tags_[t] != first; });
  }
  void leave_star(Index v, std::uint32_t t) {
    stars_[v].erase(std::find(stars_[v].begin(), stars_[v].end(), t));
  }

  // ---- Operations ----

  std::vector<std::uint32_t> find_slivers() const {
    std::vector<std::uint32_t> found;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const Corners& corner = mesh_.triangles[t];
      if (is_gone(static_cast<std::uint32_t>(t))) continue;
      if (is_open_[corner[0]] + is_open_[corner[1]] + is_open_[corner[2]] == 0) continue;
      if (flatness(corner) < height_) found.push_back(static_cast<std::uint32_t>(t));
    }
    return found;
  }

  bool remove(std::uint32_t t) {
    const Corners corner = mesh_.triangles[t];
    const std::size_t k = shortest(corner);
    const Index a = corner[k], b = corner[(k + 1) % 3];
    if (squared_length(a, b) < 4 * height_ * height_) {
      const bool b_stays = on_crease(b) && !on_crease(a);
      if (collapse(b_stays ? b : a, b_stays ? a : b)) return true;
      if (on_crease(a) == on_crease(b) && collapse(b, a)) return true;
    }
    return flip_longest(t);
  }

  /// Takes `gone` for `kept`, its neighbour; false if that would break the mesh or turn a triangle.
  bool collapse(Index kept, Index gone) {
    const std::uint32_t one = triangle_along(kept, gone), other = triangle_along(gone, kept);
    const Index c = third(one, kept, gone), d = third(other, kept, gone);
    if (stars_[c].size() <= 3 || stars_[d].size() <= 3) return false;
    const std::vector<Index> around_kept = neighbours(kept), around_gone = neighbours(gone);
    std::vector<Index> common;
    std::set_intersection(around_kept.begin(), around_kept.end(), around_gone.begin(),
                          around_gone.end(), std::back_inserter(common));
    if (common.size() != 2) return false;
    const std::vector<std::uint32_t> star = stars_[gone];
    for (const std::uint32_t t : star) {
      if (t == one || t == other) continue;
      Corners after = mesh_.triangles[t];
      std::replace(after.begin(), after.end(), gone, kept);
      if (!may_become(mesh_.triangles[t], after)) return false;
    }
    for (const std::uint32_t t : star) {
      if (t == one || t == other) continue;
      std::replace(mesh_.triangles[t].begin(), mesh_.triangles[t].end(), gone, kept);
      stars_[kept].push_back(t);
    }
    for (const std::uint32_t t : {one, other}) {
      leave_star(kept, t);
      leave_star(t == one ? c : d, t);
      mesh_.triangles[t] = {kept, kept, kept};
    }
    stars_[gone].clear();
    is_open_[kept] = 1;
    return true;
  }

  /// Replaces the longest edge of a triangle, which nearly runs through the corner opposite to it,
  /// by one from that corner to that of the neighbour. The triangle's area goes to the neighbour.
  bool flip_longest(std::uint32_t t) {
    const Corners corner = mesh_.triangles[t];
    const std::size_t k = longest(corner);
    const Index a = corner[k], b = corner[(k + 1) % 3], c = corner[(k + 2) % 3];
    const std::uint32_t beyond = triangle_along(b, a);
    const Index d = third(beyond, a, b);
    if (c == d || are_neighbours(c, d) || stars_[a].size() <= 3 || stars_[b].size() <= 3) {
      return false;
    }
    const Corners neighbour = mesh_.triangles[beyond];
    const Corners at_a{a, d, c}, at_b{d, b, c};
    const double before = std::min(flatness(corner), flatness(neighbour));
    if (!(std::min(flatness(at_a), flatness(at_b)) > before)) return false;
    if (!may_become(neighbour, at_a) || !may_become(neighbour, at_b)) return false;
    mesh_.triangles[t] = at_a;
    mesh_.triangles[beyond] = at_b;
    tags_[t] = tags_[beyond];
    leave_star(b, t);
    leave_star(a, beyond);
    stars_[c].push_back(beyond);
    stars_[d].push_back(t);
    return true;
  }

  /// Drops the triangles and vertices that are gone.
  void close_gaps() {
    std::vector<Index> number(mesh_.positions.size());
    Index kept = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (stars_[v].empty()) continue;
      mesh_.positions[kept] = mesh_.positions[v];
      is_open_[kept] = is_open_[v];
      number[v] = kept++;
    }
    mesh_.positions.resize(kept);
    is_open_.resize(kept);
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (is_gone(static_cast<std::uint32_t>(t))) continue;
      const Corners& corner = mesh_.triangles[t];
      mesh_.triangles[count] = {number[corner[0]], number[corner[1]], number[corner[2]]};
      tags_[count++] = tags_[t];
    }
    mesh_.triangles.resize(count);
    tags_.resize(count);
  }

  TriangleMesh& mesh_;
  std::vector<std::uint32_t>& tags_;
  std::vector<char>& is_open_;
  double height_;
  std::vector<std::vector<std::uint32_t>> stars_;  ///< of each vertex, its triangles
};

}  // namespace

std::size_t remove_slivers(TaggedMesh& mesh, std::vector<char>& is_open, double height) {
  require(mesh.tags.size() == mesh.mesh.triangles.size(), "remove_slivers: a tag a triangle");
  require(is_open.size() == mesh.mesh.positions.size(), "remove_slivers: a mark a vertex");
  return SliverRemover(mesh, is_open, height).run();
}

}  // namespace cs2mesh
