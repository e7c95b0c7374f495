#include "polygonize/near_intersections.h"

#include <optional>
#include <utility>

#include "libfield/base/box_tree.h"

namespace cs2mesh {

SelfIntersections find_intersections_near(const TriangleMesh& mesh, std::vector<Aabb> boxes,
                                          std::size_t most_pairs) {
  if (boxes.empty()) return {};
  const BoxTree tree(std::move(boxes));
  TriangleMesh part;
  part.positions = mesh.positions;
  std::vector<TriangleMesh::Index> numbers;
  std::vector<std::uint32_t> met;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    met.clear();
    tree.overlapping(bounds(mesh, t), met);
    if (met.empty()) continue;
    part.triangles.push_back(mesh.triangles[t]);
    numbers.push_back(static_cast<TriangleMesh::Index>(t));
  }
  SelfIntersections found = find_self_intersections(part, most_pairs).value_or(SelfIntersections{});
  for (auto& pair : found.pairs) pair = {numbers[pair[0]], numbers[pair[1]]};
  return found;
}

SelfIntersections find_new_intersections(const TriangleMesh& mesh, const TriangleSet& apart,
                                         std::size_t most_pairs) {
  if (apart.empty()) {
    return find_self_intersections(mesh, most_pairs).value_or(SelfIntersections{});
  }
  std::vector<Aabb> boxes;
  for (const std::uint32_t t : apart.others(mesh)) boxes.push_back(bounds(mesh, t));
  return find_intersections_near(mesh, std::move(boxes), most_pairs);
}

std::vector<Vec3d> places_of(const SelfIntersections& found, const TriangleMesh& mesh) {
  std::vector<Vec3d> places;
  for (const auto& pair : found.pairs) {
    for (const auto t : pair) places.push_back(mesh.positions[mesh.triangles[t][0]]);
  }
  return places;
}

}  // namespace cs2mesh
