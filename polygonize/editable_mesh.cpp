#include "polygonize/editable_mesh.h"

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

/// Calls f(half-edge) for those that start where `h` does.
template <class F>
void EditableMesh::for_each_from(HalfEdge h, const F& f) const {
  HalfEdge at = h;
  do {
    f(at);
    at = next_in_triangle(opposite_[at]);
  } while (at != h);
}

bool EditableMesh::flip_edge(HalfEdge h) {
  require(h < opposite_.size(), "flip_edge: no such half-edge");
  const HalfEdge o = opposite_[h];
  const HalfEdge bc = next_in_triangle(h), ca = next_in_triangle(bc);
  const HalfEdge ad = next_in_triangle(o), db = next_in_triangle(ad);
  const Index a = start_of(mesh_, h), b = end_of(mesh_, h);
  const Index c = start_of(mesh_, ca), d = start_of(mesh_, db);
  std::size_t at_a = 0, at_b = 0;
  bool joined = c == d;
  for_each_from(h, [&](HalfEdge) { ++at_a; });
  for_each_from(o, [&](HalfEdge) { ++at_b; });
  for_each_from(ca, [&](HalfEdge e) { joined = joined || end_of(mesh_, e) == d; });
  if (joined || at_a < 4 || at_b < 4) return false;

  const HalfEdge beyond_bc = opposite_[bc], beyond_ca = opposite_[ca];
  const HalfEdge beyond_ad = opposite_[ad], beyond_db = opposite_[db];
  const auto set = [this](HalfEdge e, Index start) {
    mesh_.triangles[triangle_of(e)][e % 3] = start;
  };
  // (a, b, c) becomes (d, c, a), and (b, a, d) becomes (c, d, b).
  set(h, d);
  set(bc, c);
  set(ca, a);
  set(o, c);
  set(ad, d);
  set(db, b);
  join(bc, beyond_ca);
  join(ca, beyond_ad);
  join(ad, beyond_db);
  join(db, beyond_bc);
  return true;
}

}  // namespace cs2mesh
