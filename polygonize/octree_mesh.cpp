#include "polygonize/octree_mesh.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "polygonize/dual_surface.h"
#include "polygonize/edge_root.h"
#include "polygonize/make_manifold.h"
#include "polygonize/place_order.h"
#include "polygonize/triangle_sample.h"

namespace cs2mesh {
namespace {

/// A sample and what is known of F there.
struct Sample {
  Vec3d point;
  const Jet* jet = nullptr;  ///< null in an empty leaf
};

/// Where a tangent at `from` reaches the surface on the way to `to`, away from both ends.
Vec3d by_one_jet(const Sample& from, const Vec3d& to) {
  constexpr double kClearance = 0.05;
  const double t = -from.jet->value / dot(from.jet->gradient, to - from.point);
  const double kept = t > kClearance ? std::min(t, 1 - kClearance) : kClearance;
  return from.point + kept * (to - from.point);
}

Vec3d crossing_between(const Sample& a, const Sample& b) {
  if (a.jet == nullptr && b.jet == nullptr) return 0.5 * (a.point + b.point);
  if (b.jet == nullptr) return by_one_jet(a, b.point);
  if (a.jet == nullptr) return by_one_jet(b, a.point);
  const Vec3d way = b.point - a.point;
  const double t = hermite_root(a.jet->value, dot(a.jet->gradient, way), b.jet->value,
                                dot(b.jet->gradient, way));
  return a.point + t * way;
}

Sample sample_in(const SurfaceOctree& tree, Octree::Index leaf) {
  return {tree.octree().center(leaf),
          tree.kind(leaf) == LeafKind::empty ? nullptr : &tree.jet(leaf)};
}

/// Where Newton's method along the gradient leads from the centre of a leaf, if to the surface in
/// it.
std::optional<Vec3d> foot_in(const SurfaceOctree& tree, Octree::Index leaf, std::size_t& jets) {
  constexpr int kMostSteps = 6;
  constexpr double kThere = 1e-9;  // of the side
  const Aabb box = tree.octree().box(leaf);
  const double side = tree.octree().side(tree.octree()[leaf].level);
  Vec3d point = box.center();
  Jet jet = tree.jet(leaf);
  for (int step = 0; step < kMostSteps; ++step) {
    const double slope = norm_of_any(jet.gradient);
    if (!(slope > 0)) return std::nullopt;
    const double way = leveled(jet.value) / slope;
    point -= way / slope * jet.gradient;
    if (!box.contains(point)) return std::nullopt;
    // At the edge of a support the logarithm makes short steps, too, far from the surface.
    if (first_order_distance(jet, side) <= kThere * side) return point;
    jet = tree.surface_at(leaf).jet(point);
    ++jets;
  }
  return std::nullopt;
}

/// Points of the surface in leaves that may hold it and that no crossing is near.
void find_bulges(const SurfaceOctree& tree, const DualSurface& dual, OctreeMesh& result) {
  const Octree& octree = tree.octree();
  std::vector<bool> seen(octree.size(), false);
  for (const DualSurface::Crossing& crossing : dual.crossings()) {
    seen[crossing.leaf] = seen[crossing.other] = true;
  }
  for (Octree::Index leaf = 0; leaf < octree.size(); ++leaf) {
    if (!octree.is_leaf(leaf) || seen[leaf] || tree.kind(leaf) == LeafKind::empty) continue;
    const std::optional<Vec3d> foot = foot_in(tree, leaf, result.evaluations);
    if (foot) result.bulges.push_back(*foot);
  }
}

}  // namespace

OctreeMesh mesh_octree(const ImplicitSurface& surface, const SurfaceOctree& tree) {
  DualSurface dual(tree.octree());
  const std::vector<Vec3d> middles(dual.middles().begin(), dual.middles().end());
  std::vector<Jet> jets(middles.size());
  surface.jets(middles, jets);
  std::vector<bool> inside(middles.size());
  for (std::size_t i = 0; i < jets.size(); ++i) inside[i] = jets[i].value >= 0;
  dual.cross(inside);

  OctreeMesh result;
  result.evaluations = jets.size();
  const auto crossings = dual.crossings();
  result.mesh.positions.resize(crossings.size());
  result.leaf_of.resize(crossings.size());
  tbb::parallel_for(std::size_t{0}, crossings.size(), [&](std::size_t i) {
    const DualSurface::Crossing& crossing = crossings[i];
    const Sample a = sample_in(tree, crossing.leaf);
    const bool at_middle = crossing.middle != DualSurface::Crossing::kNone;
    const Sample b = at_middle ? Sample{middles[crossing.middle], &jets[crossing.middle]}
                               : sample_in(tree, crossing.other);
    result.mesh.positions[i] = crossing_between(a, b);
    result.leaf_of[i] = at_middle || a.jet != nullptr ? crossing.leaf : crossing.other;
  });
  find_bulges(tree, dual, result);
  std::vector<TriangleMesh::Index> beside;
  result.mesh.triangles = dual.triangulate(result.mesh.positions, beside);
  for (const TriangleMesh::Index v : beside) result.leaf_of.push_back(result.leaf_of[v]);
  beside = make_manifold(result.mesh);
  for (const TriangleMesh::Index v : beside) result.leaf_of.push_back(result.leaf_of[v]);
  const std::vector<Octree::Index> leaf_of = std::move(result.leaf_of);
  result.leaf_of.clear();
  for (const TriangleMesh::Index v : sort_by_place(result.mesh)) {
    result.leaf_of.push_back(leaf_of[v]);
  }
  return result;
}

}  // namespace cs2mesh
