#include "polygonize/flip_far.h"

#include <algorithm>
#include <array>
#include <optional>

#include "polygonize/editable_mesh.h"
#include "polygonize/fold.h"

namespace cs2mesh {
namespace {

using Corners = std::array<TriangleMesh::Index, 3>;

class Flipper {
 public:
  Flipper(const ImplicitSurface& surface, TriangleMesh mesh, const FarOptions& options)
      : surface_(surface), mesh_(std::move(mesh)), options_(options) {}

  /// Whether an edge of the triangle has been flipped.
  bool flip_at(std::size_t triangle) {
    std::optional<HalfEdge> best;
    double least = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto h = static_cast<HalfEdge>(3 * triangle + k);
      if (!mesh_.can_flip(h)) continue;
      const HalfEdge back = mesh_.opposite(h);
      const auto a = start_of(mesh_.mesh(), h), b = end_of(mesh_.mesh(), h);
      const auto c = end_of(mesh_.mesh(), next_in_triangle(h));
      const auto d = end_of(mesh_.mesh(), next_in_triangle(back));
      const std::array<Corners, 2> then{{{d, c, a}, {c, d, b}}};
      if (!faces_outward(then[0]) || !faces_outward(then[1])) continue;
      const double distance = farthest(then);
      if (best && !(distance < least)) continue;
      if (distance > 0 && !(distance < farthest({{{a, b, c}, {b, a, d}}}))) continue;
      best = h;
      least = distance;
    }
    return best && mesh_.flip_edge(*best);
  }
  TriangleMesh take() { return mesh_.take(); }

 private:
  bool faces_outward(const Corners& t) const {
    const auto& at = mesh_.mesh().positions;
    return cs2mesh::faces_outward(surface_, {at[t[0]], at[t[1]], at[t[2]]});
  }
  /// How far the farther one is; 0 if both are near enough.
  double farthest(const std::array<Corners, 2>& triangles) const {
    TriangleMesh two;
    for (const Corners& t : triangles) {
      const auto first = static_cast<TriangleMesh::Index>(two.positions.size());
      for (const auto v : t) two.positions.push_back(mesh_.mesh().positions[v]);
      two.triangles.push_back({first, first + 1, first + 2});
    }
    double most = 0.0;
    constexpr std::array<std::size_t, 2> kBoth{0, 1};
    for (const LostPoint& lost : far_triangles(surface_, two, kBoth, options_)) {
      most = std::max(most, lost.distance);
    }
    return most;
  }

  const ImplicitSurface& surface_;
  EditableMesh mesh_;
  const FarOptions& options_;
};

}  // namespace

std::size_t flip_far(const ImplicitSurface& surface, TriangleMesh& mesh,
                     std::span<const LostPoint> lost, const FarOptions& options) {
  if (lost.empty()) return 0;
  Flipper flipper(surface, std::move(mesh), options);
  std::size_t flipped = 0;
  for (const LostPoint& point : lost) flipped += flipper.flip_at(point.triangle) ? 1 : 0;
  mesh = flipper.take();
  return flipped;
}

}  // namespace cs2mesh
