#include "polygonize/editable_mesh.h"

#include <algorithm>
#include <array>
#include <utility>

#include "libfield/base/check.h"

namespace cs2mesh {

/// Returns the first half-edge of the new triangle; its neighbours are not known yet.
HalfEdge EditableMesh::append(Index a, Index b, Index c) {
  const auto first = static_cast<HalfEdge>(opposite_.size());
  mesh_.triangles.push_back({a, b, c});
  opposite_.resize(opposite_.size() + 3);
  return first;
}

void EditableMesh::join(HalfEdge a, HalfEdge b) {
  opposite_[a] = b;
  opposite_[b] = a;
}

void EditableMesh::split_triangle(std::size_t triangle, const Vec3d& p) {
  require(triangle < mesh_.triangles.size(), "split_triangle: no such triangle");
  const auto v = static_cast<Index>(mesh_.positions.size());
  mesh_.positions.push_back(p);
  const auto [a, b, c] = mesh_.triangles[triangle];
  const auto h = static_cast<HalfEdge>(3 * triangle);
  const HalfEdge beyond_bc = opposite_[h + 1], beyond_ca = opposite_[h + 2];
  const HalfEdge bcv = append(b, c, v), cav = append(c, a, v);
  mesh_.triangles[triangle] = {a, b, v};
  join(bcv, beyond_bc);
  join(cav, beyond_ca);
  join(h + 1, bcv + 2);
  join(bcv + 1, cav + 2);
  join(cav + 1, h + 2);
}

void EditableMesh::split_edge(HalfEdge h, const Vec3d& p) {
  require(h < opposite_.size(), "split_edge: no such half-edge");
  const auto v = static_cast<Index>(mesh_.positions.size());
  mesh_.positions.push_back(p);
  // a -> b with c on this side, b -> a on the other; each half is left behind as (a, v, c).
  std::array<HalfEdge, 2> kept{h, opposite_[h]};
  std::array<HalfEdge, 2> added{};
  for (std::size_t side = 0; side < 2; ++side) {
    const HalfEdge ab = kept[side];
    const HalfEdge bc = next_in_triangle(ab);
    const Index b = end_of(mesh_, ab);
    const Index c = end_of(mesh_, bc);
    const HalfEdge beyond_bc = opposite_[bc];
    added[side] = append(v, b, c);
    mesh_.triangles[triangle_of(bc)][bc % 3] = v;
    join(added[side] + 1, beyond_bc);
    join(added[side] + 2, bc);
  }
  join(kept[0], added[1]);
  join(kept[1], added[0]);
}

bool EditableMesh::can_collapse(HalfEdge h) const {
  const HalfEdge back = opposite_[h];
  const Index a = start_of(mesh_, h);
  const Index c = end_of(mesh_, next_in_triangle(h)), d = end_of(mesh_, next_in_triangle(back));
  if (c == d) return false;
  // Rings of bounded valence: look each neighbour of one up among those of the other.
  std::array<Index, kMostValence> around{};
  std::size_t count = 0;
  bool fits = true;
  for_ring(h, [&](HalfEdge turn) {
    if (count == kMostValence) {
      fits = false;
    } else {
      around[count++] = end_of(mesh_, turn);
    }
  });
  if (!fits) return false;
  const auto end = around.begin() + static_cast<std::ptrdiff_t>(count);
  std::size_t shared = 0, valence = 0;
  for_ring(back, [&](HalfEdge turn) {
    ++valence;
    const Index v = end_of(mesh_, turn);
    if (v != a && std::find(around.begin(), end, v) != end) ++shared;
  });
  const std::size_t then = valence + count - 4;
  return shared == 2 && then >= 3 && then + 4 <= kMostValence &&
         valence_above_three(before_in_triangle(h)) &&
         valence_above_three(before_in_triangle(back));
}

bool EditableMesh::valence_above_three(HalfEdge h) const {
  int valence = 0;
  for_ring(h, [&](HalfEdge) { ++valence; });
  return valence > 3;
}

void EditableMesh::collapse_edge(HalfEdge h) {
  const Index b = end_of(mesh_, h);
  for_ring(h, [&](HalfEdge turn) { mesh_.triangles[turn / 3][turn % 3] = b; });
  for (const HalfEdge side : {h, opposite_[h]}) {
    join(opposite_[next_in_triangle(side)], opposite_[before_in_triangle(side)]);
    mesh_.triangles[triangle_of(side)].fill(kGone);
  }
}

bool EditableMesh::can_flip(HalfEdge h) const {
  const HalfEdge back = opposite_[h];
  const Index c = end_of(mesh_, next_in_triangle(h)), d = end_of(mesh_, next_in_triangle(back));
  if (c == d) return false;
  bool free = true;
  for_ring(before_in_triangle(h), [&](HalfEdge turn) { free &= end_of(mesh_, turn) != d; });
  return free && valence_above_three(h) && valence_above_three(back);
}

bool EditableMesh::flip_edge(HalfEdge h) {
  require(h < opposite_.size(), "flip_edge: no such half-edge");
  if (!can_flip(h)) return false;
  // a -> b -> c and b -> a -> d become d -> c -> a ... with h from d to c.
  const HalfEdge back = opposite_[h];
  const HalfEdge bc = next_in_triangle(h), ca = before_in_triangle(h);
  const HalfEdge ad = next_in_triangle(back), db = before_in_triangle(back);
  const Index c = end_of(mesh_, bc), d = end_of(mesh_, ad);
  const HalfEdge beyond_bc = opposite_[bc], beyond_ad = opposite_[ad];
  // (d, c, a): h = d -> c, bc's place = c -> a, ca's place = a -> d.
  const Index a = end_of(mesh_, ca), b = end_of(mesh_, db);
  const auto set = [&](HalfEdge at, Index v) { mesh_.triangles[at / 3][at % 3] = v; };
  const HalfEdge beyond_ca = opposite_[ca], beyond_db = opposite_[db];
  set(h, d), set(bc, c), set(ca, a);
  set(back, c), set(ad, d), set(db, b);
  join(bc, beyond_ca);
  join(ca, beyond_ad);
  join(ad, beyond_db);
  join(db, beyond_bc);
  return true;
}

std::vector<EditableMesh::Index> EditableMesh::close_gaps() {
  std::vector<Index> triangle(mesh_.triangles.size(), kGone), vertex(mesh_.positions.size(), kGone);
  std::size_t left = 0;
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    if (!alive(t)) continue;
    triangle[t] = static_cast<Index>(left);
    mesh_.triangles[left] = mesh_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) opposite_[3 * left + k] = opposite_[3 * t + k];
    for (const Index v : mesh_.triangles[left++]) vertex[v] = 0;
  }
  mesh_.triangles.resize(left);
  opposite_.resize(3 * left);
  for (HalfEdge& h : opposite_) h = 3 * triangle[triangle_of(h)] + h % 3;
  std::vector<Index> former;
  for (Index v = 0; v < vertex.size(); ++v) {
    if (vertex[v] == kGone) continue;
    vertex[v] = static_cast<Index>(former.size());
    mesh_.positions[former.size()] = mesh_.positions[v];
    former.push_back(v);
  }
  mesh_.positions.resize(former.size());
  mesh_.positions.shrink_to_fit(), mesh_.triangles.shrink_to_fit(), opposite_.shrink_to_fit();
  for (auto& corners : mesh_.triangles) {
    for (Index& v : corners) v = vertex[v];
  }
  return former;
}

TriangleMesh EditableMesh::take() {
  close_gaps();
  opposite_ = {};
  return std::exchange(mesh_, {});
}

}  // namespace cs2mesh
