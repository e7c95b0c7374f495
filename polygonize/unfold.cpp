#include "polygonize/unfold.h"

#include <algorithm>
#include <array>
#include <vector>

#include "libfield/base/check.h"
#include "polygonize/editable_mesh.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;
using Triangle = std::array<Index, 3>;

class Unfolder {
 public:
  Unfolder(TriangleMesh mesh, std::span<const Vec3d> normals)
      : mesh_(std::move(mesh)), normals_(normals) {}

  std::size_t run(std::vector<std::size_t> bad) {
    constexpr int kRounds = 4;
    std::size_t flips = 0;
    for (int round = 0; round < kRounds && !bad.empty(); ++round) {
      std::vector<std::size_t> still;
      for (const std::size_t t : bad) {
        if (is_well(mesh().positions, mesh().triangles[t], normals_)) continue;
        if (help(t)) ++flips;
        still.push_back(t);
      }
      bad = std::move(still);
    }
    return flips;
  }
  TriangleMesh take() { return mesh_.take(); }

  static bool is_well(std::span<const Vec3d> positions, const Triangle& t,
                      std::span<const Vec3d> normals) {
    constexpr double kAcross = 0.2;  // 78 degrees
    return facing(positions, t, normals) >= kAcross;
  }

 private:
  const TriangleMesh& mesh() const { return mesh_.mesh(); }

  /// The cosine between a triangle's normal and the surface's; 1 where that is not known.
  static double facing(std::span<const Vec3d> positions, const Triangle& t,
                       std::span<const Vec3d> normals) {
    const Vec3d outward = normals[t[0]] + normals[t[1]] + normals[t[2]];
    const Vec3d normal =
        cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]]);
    const double lengths = norm(outward) * norm(normal);
    if (lengths > 0) return dot(outward, normal) / lengths;
    return norm(outward) > 0 ? -1.0 : 1.0;
  }
  double facing(const Triangle& t) const { return facing(mesh().positions, t, normals_); }

  /// Flips the edge of a triangle that helps most, if any does.
  bool help(std::size_t t) {
    constexpr double kBetter = 1e-3;
    double best = kBetter;
    HalfEdge chosen = 0;
    for (HalfEdge h = static_cast<HalfEdge>(3 * t); h < 3 * t + 3; ++h) {
      const HalfEdge o = mesh_.opposite(h);
      const Index a = start_of(mesh(), h), b = end_of(mesh(), h);
      const Index c = end_of(mesh(), next_in_triangle(h)), d = end_of(mesh(), next_in_triangle(o));
      const double before = std::min(facing({a, b, c}), facing({b, a, d}));
      const double after = std::min(facing({a, d, c}), facing({d, b, c}));
      if (after - before > best) {
        best = after - before;
        chosen = h;
      }
    }
    return best > kBetter && mesh_.flip_edge(chosen);
  }

  EditableMesh mesh_;
  std::span<const Vec3d> normals_;
};

}  // namespace

std::size_t unfold(TriangleMesh& mesh, std::span<const Vec3d> normals) {
  require(normals.size() == mesh.positions.size(), "unfold: one normal a vertex");
  std::vector<std::size_t> bad;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!Unfolder::is_well(mesh.positions, mesh.triangles[t], normals)) bad.push_back(t);
  }
  if (bad.empty()) return 0;
  Unfolder unfolder(std::move(mesh), normals);
  const std::size_t flips = unfolder.run(std::move(bad));
  mesh = unfolder.take();
  return flips;
}

}  // namespace cs2mesh
