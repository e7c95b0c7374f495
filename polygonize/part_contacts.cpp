#include "polygonize/part_contacts.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "libfield/base/box_tree.h"
#include "polygonize/mesh_components.h"
#include "polygonize/self_intersection.h"

namespace cs2mesh {
namespace {

using Index = TriangleMesh::Index;

std::vector<std::uint32_t> triangles_near(const TriangleMesh& mesh, const Aabb& box) {
  std::vector<std::uint32_t> found;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (bounds(mesh, t).overlaps(box)) found.push_back(static_cast<std::uint32_t>(t));
  }
  return found;
}

/// The pairs of triangles of two meshes that intersect; see PartContact.
std::vector<std::array<std::uint32_t, 2>> intersecting(const TriangleMesh& a,
                                                       const TriangleMesh& b) {
  const std::vector<std::uint32_t> of_a = triangles_near(a, bounds(b));
  const std::vector<std::uint32_t> of_b = triangles_near(b, bounds(a));
  if (of_a.empty() || of_b.empty()) return {};
  TriangleMesh both;
  append_triangles(both, a, of_a);
  append_triangles(both, b, of_b);
  const auto found = find_self_intersections(both, std::numeric_limits<std::size_t>::max());
  std::vector<std::array<std::uint32_t, 2>> pairs;
  if (!found) {
    for (const std::uint32_t t : of_a) pairs.push_back({t, 0});
    return pairs;
  }
  for (const auto& [low, high] : found->pairs) {
    if (low < of_a.size() && high >= of_a.size()) {
      pairs.push_back({of_a[low], of_b[high - of_a.size()]});
    }
  }
  return pairs;
}

}  // namespace

std::vector<PartContact> find_contacts(const Model& model) {
  std::vector<Aabb> boxes;
  for (const MeshPart& part : model.parts) boxes.push_back(bounds(part.mesh));
  const BoxTree tree(boxes);
  std::vector<PartContact> contacts;
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    std::vector<std::uint32_t> near;
    tree.overlapping(boxes[a], near);
    std::sort(near.begin(), near.end());
    for (const std::size_t b : near) {
      if (b <= a) continue;
      auto pairs = intersecting(model.parts[a].mesh, model.parts[b].mesh);
      if (!pairs.empty()) contacts.push_back({a, b, std::move(pairs)});
    }
  }
  return contacts;
}

bool remove_components_inside(TriangleMesh& mesh, const TriangleMesh& solid) {
  const Aabb reach = bounds(solid);
  if (!reach.overlaps(bounds(mesh))) return false;
  std::vector<char> kept(mesh.triangles.size(), 1);
  bool all = true;
  for (const MeshComponent& component : components(mesh)) {
    const Vec3d& corner = mesh.positions[mesh.triangles[component.triangles.front()][0]];
    if (!reach.contains(component.box) || winding_number(solid, corner) < 0.5) continue;
    for (const Index t : component.triangles) kept[t] = 0;
    all = false;
  }
  if (all) return false;
  keep_triangles(mesh, kept);
  return true;
}

}  // namespace cs2mesh
