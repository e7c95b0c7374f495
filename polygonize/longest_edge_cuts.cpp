#include "polygonize/longest_edge_cuts.h"

#include <algorithm>

namespace cs2mesh {

/// A triangle on its way to being cut: corners, and the new vertex of each edge, or kNone.
struct LongestEdgeCuts::Piece {
  std::array<Index, 3> corner;
  std::array<Index, 3> middle;  ///< of the edge from corner k to corner k + 1
};

LongestEdgeCuts::LongestEdgeCuts(const TriangleMesh& mesh)
    : middle_of(3 * mesh.triangles.size(), kNone),
      mesh_(mesh),
      opposite_(opposite_half_edges(mesh)),
      marked_(opposite_.size(), 0) {}

double LongestEdgeCuts::squared_length(HalfEdge h) const {
  return squared_norm(mesh_.positions[end_of(mesh_, h)] - mesh_.positions[start_of(mesh_, h)]);
}

Vec3d LongestEdgeCuts::middle(HalfEdge h) const {
  return 0.5 * (mesh_.positions[start_of(mesh_, h)] + mesh_.positions[end_of(mesh_, h)]);
}

HalfEdge LongestEdgeCuts::longest_edge(std::size_t triangle) const {
  const auto h = static_cast<HalfEdge>(3 * triangle);
  std::array<HalfEdge, 3> edges{edge_of(h), edge_of(h + 1), edge_of(h + 2)};
  return *std::max_element(edges.begin(), edges.end(), [&](HalfEdge a, HalfEdge b) {
    const double la = squared_length(a), lb = squared_length(b);
    return la != lb ? la < lb : a < b;
  });
}

std::vector<HalfEdge> LongestEdgeCuts::close() {
  std::vector<HalfEdge> open;
  for (HalfEdge h = 0; h < marked_.size(); ++h) {
    if (marked_[h] != 0) open.push_back(h);
  }
  while (!open.empty()) {
    const HalfEdge h = open.back();
    open.pop_back();
    for (const HalfEdge side : {h, opposite_[h]}) {
      const HalfEdge longest = longest_edge(triangle_of(side));
      if (marked_[longest] != 0) continue;
      marked_[longest] = 1;
      open.push_back(longest);
    }
  }
  std::vector<HalfEdge> all;
  for (HalfEdge h = 0; h < marked_.size(); ++h) {
    if (marked_[h] != 0) all.push_back(h);
  }
  return all;
}

/// Cuts a triangle through the middle of its longest edge that is to be cut, and the parts
/// likewise.
template <class F>
void LongestEdgeCuts::for_each_part(const Piece& piece, const F& f) const {
  std::size_t longest = 3;
  double length = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    if (piece.middle[k] == kNone) continue;
    const double squared =
        squared_norm(mesh_.positions[piece.corner[(k + 1) % 3]] - mesh_.positions[piece.corner[k]]);
    if (squared > length) {
      length = squared;
      longest = k;
    }
  }
  if (longest == 3) return f(piece.corner);
  const std::size_t a = longest, b = (a + 1) % 3, c = (a + 2) % 3;
  const Index m = piece.middle[a];
  for_each_part(Piece{{piece.corner[a], m, piece.corner[c]}, {kNone, kNone, piece.middle[c]}}, f);
  for_each_part(Piece{{m, piece.corner[b], piece.corner[c]}, {kNone, piece.middle[b], kNone}}, f);
}

std::vector<std::array<LongestEdgeCuts::Index, 3>> LongestEdgeCuts::parts(
    std::vector<std::uint32_t>* whole) const {
  std::vector<std::array<Index, 3>> all;
  all.reserve(mesh_.triangles.size());
  for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
    Piece piece;
    piece.corner = mesh_.triangles[t];
    for (HalfEdge k = 0; k < 3; ++k) piece.middle[k] = middle_of[edge_of(3 * t + k)];
    for_each_part(piece, [&](const std::array<Index, 3>& part) {
      all.push_back(part);
      if (whole != nullptr) whole->push_back(t);
    });
  }
  return all;
}

FlatParts cut_flat(const TriangleMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  FlatParts cut;
  cut.mesh.positions = mesh.positions;
  LongestEdgeCuts cuts(mesh);
  for (const HalfEdge t : triangles) {
    for (HalfEdge k = 0; k < 3; ++k) cuts.mark(3 * t + k);
  }
  for (const HalfEdge h : cuts.close()) {
    cuts.middle_of[h] = static_cast<TriangleMesh::Index>(cut.mesh.positions.size());
    cut.mesh.positions.push_back(cuts.middle(h));
  }
  cut.mesh.triangles = cuts.parts(&cut.whole);
  return cut;
}

}  // namespace cs2mesh
