#include "polygonize/collapse_crossings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "libfield/base/box_tree.h"
#include "polygonize/editable_mesh.h"
#include "polygonize/self_intersection.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
using Corners = std::array<Index, 3>;

/// The cosine between the normals of two triangles from which they count as folded.
constexpr double kSharpest = -0.97;

class Untangler {
 public:
  explicit Untangler(EditableMesh& mesh) : mesh_(mesh), is_changed_(triangles().size(), false) {}

  std::size_t run(std::span<const std::array<Index, 2>> pairs) {
    if (pairs.empty()) return 0;
    std::vector<Aabb> boxes;
    for (Index t = 0; t < triangles().size(); ++t) {
      if (!mesh_.alive(t)) continue;
      boxes.push_back(bounds(mesh_.mesh(), t));
      triangle_of_box_.push_back(t);
    }
    tree_ = BoxTree(std::move(boxes));
    std::size_t mended = 0;
    for (const auto& pair : pairs) {
      if (mend(pair)) ++mended;
    }
    return mended;
  }

 private:
  bool mend(const std::array<Index, 2>& pair) {
    if (!mesh_.alive(pair[0]) || !mesh_.alive(pair[1])) return false;
    if (count_crossings({pair[0], pair[1]}, {}) == 0) return false;
    Change best;
    for (const Index t : pair) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto h = static_cast<HalfEdge>(3 * t + k);
        try_collapse(h, best);
        try_collapse(mesh_.opposite(h), best);
        try_flip(h, best);
      }
    }
    if (best.triangles.empty()) return false;
    for (const Index t : best.triangles) set_changed(t);
    if (best.flip) {
      mesh_.flip_edge(best.edge);
    } else {
      mesh_.collapse_edge(best.edge);
    }
    return true;
  }

  /// What could be done, and the triangles that it would change.
  struct Change {
    HalfEdge edge = 0;
    bool flip = false;
    std::ptrdiff_t gain = 0;   ///< crossings that are no more
    double length = HUGE_VAL;  ///< of an edge that is collapsed
    std::vector<Index> triangles;
  };

  const std::vector<Corners>& triangles() const { return mesh_.mesh().triangles; }
  const Vec3d& position(Index v) const { return mesh_.mesh().positions[v]; }
  Index start(HalfEdge h) const { return start_of(mesh_.mesh(), h); }
  Index end(HalfEdge h) const { return end_of(mesh_.mesh(), h); }
  Vec3d normal(const Corners& t) const {
    return cross(position(t[1]) - position(t[0]), position(t[2]) - position(t[0]));
  }

  void set_changed(Index t) {
    if (is_changed_[t]) return;
    is_changed_[t] = true;
    changed_.push_back(t);
  }

  /// The triangles whose boxes meet this one.
  std::vector<Index> near(const Aabb& box) const {
    std::vector<std::uint32_t> all;
    tree_.overlapping(box, all);
    std::vector<Index> found;
    for (const std::uint32_t i : all) {
      const Index t = triangle_of_box_[i];
      if (mesh_.alive(t) && !is_changed_[t]) found.push_back(t);
    }
    for (const Index t : changed_) {
      if (mesh_.alive(t) && bounds(mesh_.mesh(), t).overlaps(box)) found.push_back(t);
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  /// How many triangles would cross those in the place of `old`: among each other and with the
  /// rest.
  std::ptrdiff_t count_crossings(const std::vector<Index>& old,
                                 const std::vector<Corners>& instead) const {
    TriangleMesh part;
    std::map<Index, Index> number;
    const auto append = [&](Corners t) {
      for (Index& v : t) {
        const auto [at, is_new] = number.try_emplace(v, static_cast<Index>(number.size()));
        if (is_new) part.positions.push_back(position(v));
        v = at->second;
      }
      part.triangles.push_back(t);
    };
    Aabb box;
    if (instead.empty()) {
      for (const Index t : old) append(triangles()[t]);
    } else {
      for (const Corners& t : instead) append(t);
    }
    for (const Vec3d& p : part.positions) box.include(p);
    const std::size_t own = part.triangles.size();
    for (const Index t : near(box)) {
      if (std::find(old.begin(), old.end(), t) == old.end()) append(triangles()[t]);
    }
    constexpr std::size_t kMostPairs = 10'000;
    const std::optional<SelfIntersections> found = find_self_intersections(part, kMostPairs);
    if (!found) return 0;
    return std::count_if(found->pairs.begin(), found->pairs.end(),
                         [own](const auto& pair) { return pair[0] < own; });
  }

  /// The triangles beyond the edges of these.
  std::vector<Corners> ring_around(const std::vector<Index>& old) const {
    std::vector<Corners> ring;
    for (const Index t : old) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto beyond =
            static_cast<Index>(triangle_of(mesh_.opposite(static_cast<HalfEdge>(3 * t + k))));
        if (std::find(old.begin(), old.end(), beyond) == old.end()) {
          ring.push_back(triangles()[beyond]);
        }
      }
    }
    return ring;
  }

  /// How often one of these is folded onto another, or onto one of the ring around.
  int count_folds(const std::vector<Corners>& these, const std::vector<Corners>& ring) const {
    std::vector<Corners> around = these;
    around.insert(around.end(), ring.begin(), ring.end());
    int folds = 0;
    for (std::size_t i = 0; i < these.size(); ++i) {
      const Vec3d a = normal(these[i]);
      for (std::size_t j = i + 1; j < around.size(); ++j) {
        if (!share_an_edge(these[i], around[j])) continue;
        const Vec3d b = normal(around[j]);
        if (!(dot(a, b) > kSharpest * norm(a) * norm(b))) ++folds;
      }
    }
    return folds;
  }
  static bool share_an_edge(const Corners& a, const Corners& b) {
    return std::count_if(a.begin(), a.end(),
                         [&](Index v) { return std::find(b.begin(), b.end(), v) != b.end(); }) == 2;
  }

  /// Takes the change if it leaves fewer crossings than the best so far, or as many and, as of
  /// tangles that only get smaller step by step, is a shorter edge collapsed.
  void consider(Change change, const std::vector<Corners>& instead, Change& best) const {
    const std::ptrdiff_t before = count_crossings(change.triangles, {});
    if (before < best.gain) return;
    std::vector<Corners> now;
    for (const Index t : change.triangles) now.push_back(triangles()[t]);
    const std::vector<Corners> ring = ring_around(change.triangles);
    if (count_folds(instead, ring) > count_folds(now, ring)) return;
    change.gain = before - count_crossings(change.triangles, instead);
    if (change.gain > best.gain ||
        (change.gain == best.gain && !change.flip && change.length < best.length)) {
      best = std::move(change);
    }
  }

  void try_collapse(HalfEdge h, Change& best) const {
    if (!mesh_.can_collapse(h)) return;
    const Index a = start(h), b = end(h);
    Change change{h, false, 0, norm(position(b) - position(a)), {}};
    std::vector<Corners> instead;
    mesh_.for_ring(h, [&](HalfEdge turn) {
      const std::size_t t = triangle_of(turn);
      change.triangles.push_back(static_cast<Index>(t));
      Corners corners = triangles()[t];
      if (std::find(corners.begin(), corners.end(), b) != corners.end()) return;
      std::replace(corners.begin(), corners.end(), a, b);
      instead.push_back(corners);
    });
    consider(std::move(change), instead, best);
  }

  void try_flip(HalfEdge h, Change& best) const {
    if (!mesh_.can_flip(h)) return;
    const HalfEdge back = mesh_.opposite(h);
    const Index a = start(h), b = end(h);
    const Index c = end(next_in_triangle(h)), d = end(next_in_triangle(back));
    consider({h,
              true,
              0,
              HUGE_VAL,
              {static_cast<Index>(triangle_of(h)), static_cast<Index>(triangle_of(back))}},
             {{d, c, a}, {c, d, b}}, best);
  }

  EditableMesh& mesh_;
  BoxTree tree_;  ///< of the triangles as they were at first
  std::vector<Index> triangle_of_box_;
  std::vector<bool> is_changed_;
  std::vector<Index> changed_;
};

}  // namespace

std::size_t collapse_crossings(EditableMesh& mesh, std::span<const std::array<Index, 2>> pairs) {
  return Untangler(mesh).run(pairs);
}

std::size_t collapse_crossings(EditableMesh& mesh) {
  constexpr std::size_t kMostPairs = 10'000;
  TriangleMesh alive;
  alive.positions = mesh.mesh().positions;
  std::vector<Index> numbers;
  for (Index t = 0; t < mesh.mesh().triangles.size(); ++t) {
    if (!mesh.alive(t)) continue;
    alive.triangles.push_back(mesh.mesh().triangles[t]);
    numbers.push_back(t);
  }
  std::vector<std::array<Index, 2>> pairs;
  const std::optional<SelfIntersections> found = find_self_intersections(alive, kMostPairs);
  if (found) pairs = found->pairs;
  for (auto& pair : pairs) pair = {numbers[pair[0]], numbers[pair[1]]};
  return collapse_crossings(mesh, pairs);
}

}  // namespace cs2mesh
