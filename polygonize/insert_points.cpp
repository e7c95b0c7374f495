#include "polygonize/insert_points.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "polygonize/editable_mesh.h"
#include "polygonize/fold.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

/// The cosine between the normals of two triangles from which they count as folded.
constexpr double kSharpest = -0.97;
/// The least barycentric weight of a tent's foot; below it the tent stands on an edge.
constexpr double kLeastWeight = 0.15;

class Inserter {
 public:
  Inserter(const ImplicitSurface& surface, TriangleMesh mesh)
      : surface_(surface), mesh_(std::move(mesh)), changed_(mesh_.mesh().triangles.size(), 0) {}

  bool insert(const LostPoint& lost) {
    if (changed_[lost.triangle] != 0) return false;
    if (lost.on_surface == lost.on_mesh) return false;
    const std::array<double, 3> weight = barycentric(lost.triangle, lost.on_mesh);
    const auto least =
        static_cast<std::size_t>(std::min_element(weight.begin(), weight.end()) - weight.begin());
    if (weight[least] >= kLeastWeight) return on_triangle(lost.triangle, lost.on_surface);
    // The edge opposite to the corner of the least weight.
    return on_edge(static_cast<HalfEdge>(3 * lost.triangle + (least + 1) % 3), lost.on_surface);
  }
  TriangleMesh take() { return mesh_.take(); }

 private:
  const TriangleMesh& mesh() const { return mesh_.mesh(); }

  TriangleCorners corners(std::size_t t) const {
    const auto& [a, b, c] = mesh().triangles[t];
    return {mesh().positions[a], mesh().positions[b], mesh().positions[c]};
  }

  /// Weights of the foot of p in the plane of a triangle, moved into it.
  std::array<double, 3> barycentric(std::size_t t, const Vec3d& p) const {
    const auto [a, b, c] = corners(t);
    const Vec3d n = cross(b - a, c - a);
    std::array<double, 3> w{dot(n, cross(c - b, p - b)), dot(n, cross(a - c, p - c)),
                            dot(n, cross(b - a, p - a))};
    double sum = 0;
    for (double& x : w) sum += x = std::max(x, 0.0);
    for (double& x : w) x = sum > 0 ? x / sum : 1.0 / 3;
    return w;
  }

  /// Whether a tent from `apex` over a ring of half-edges would be folded.
  bool would_fold(std::span<const HalfEdge> ring, const Vec3d& apex) const {
    std::vector<TriangleCorners> sides;
    for (const HalfEdge h : ring) {
      sides.push_back(
          {mesh().positions[start_of(mesh(), h)], mesh().positions[end_of(mesh(), h)], apex});
      const std::size_t beyond = triangle_of(mesh_.opposite(h));
      if (folded(surface_, sides.back(), corners(beyond), kSharpest)) return true;
    }
    for (std::size_t i = 0; i < sides.size(); ++i) {
      if (folded(surface_, sides[i], sides[(i + 1) % sides.size()], kSharpest)) return true;
    }
    return false;
  }

  bool on_triangle(std::size_t t, const Vec3d& apex) {
    const auto h = static_cast<HalfEdge>(3 * t);
    if (would_fold(std::array{h, h + 1, h + 2}, apex)) return false;
    mesh_.split_triangle(t, apex);
    changed_[t] = 1;
    return true;
  }

  bool on_edge(HalfEdge h, const Vec3d& apex) {
    const HalfEdge o = mesh_.opposite(h);
    const std::size_t other = triangle_of(o);
    if (other >= changed_.size() || changed_[other] != 0) return false;
    const auto left = [](HalfEdge e) { return next_in_triangle(next_in_triangle(e)); };
    if (would_fold(std::array{next_in_triangle(h), left(h), next_in_triangle(o), left(o)}, apex)) {
      return false;
    }
    mesh_.split_edge(h, apex);
    changed_[triangle_of(h)] = changed_[other] = 1;
    return true;
  }

  const ImplicitSurface& surface_;
  EditableMesh mesh_;
  std::vector<char> changed_;  ///< by original triangle
};

}  // namespace

std::vector<std::size_t> insert_points(const ImplicitSurface& surface, TriangleMesh& mesh,
                                       std::span<const LostPoint> points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].distance > points[b].distance;
  });
  Inserter inserter(surface, std::move(mesh));
  std::vector<std::size_t> joined;
  for (const std::size_t i : order) {
    if (inserter.insert(points[i])) joined.push_back(i);
  }
  mesh = inserter.take();
  return joined;
}

}  // namespace cs2mesh
