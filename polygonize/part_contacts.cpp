#include "polygonize/part_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "libfield/base/box_tree.h"
#include "polygonize/disjoint_sets.h"
#include "polygonize/half_edges.h"
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

/// Appends triangles of `mesh`, with the vertices they need.
void append(TriangleMesh& to, const TriangleMesh& mesh, const std::vector<std::uint32_t>& chosen) {
  std::map<Index, Index> number;
  for (const std::uint32_t t : chosen) {
    auto& triangle = to.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const Index v = mesh.triangles[t][k];
      const auto [place, fresh] = number.emplace(v, static_cast<Index>(to.positions.size()));
      if (fresh) to.positions.push_back(mesh.positions[v]);
      triangle[k] = place->second;
    }
  }
}

/// The pairs of triangles of two meshes that intersect; see PartContact.
std::vector<std::array<std::uint32_t, 2>> intersecting(const TriangleMesh& a,
                                                       const TriangleMesh& b) {
  const std::vector<std::uint32_t> of_a = triangles_near(a, bounds(b));
  const std::vector<std::uint32_t> of_b = triangles_near(b, bounds(a));
  if (of_a.empty() || of_b.empty()) return {};
  TriangleMesh both;
  append(both, a, of_a);
  append(both, b, of_b);
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

/// How often a closed mesh goes round a point, 0 or 1 for the boundary of a solid: the sum of the
/// solid angles of its triangles (van Oosterom and Strackee 1983) over 4 pi.
double winding_number(const TriangleMesh& mesh, const Vec3d& p) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3d a = mesh.positions[t[0]] - p, b = mesh.positions[t[1]] - p,
                c = mesh.positions[t[2]] - p;
    const double la = norm(a), lb = norm(b), lc = norm(c);
    sum += std::atan2(dot(a, cross(b, c)),
                      la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

/// For each triangle the lowest one of its component.
std::vector<std::uint32_t> components(const TriangleMesh& mesh) {
  DisjointSets sets(mesh.triangles.size());
  const std::vector<HalfEdge> opposite = opposite_half_edges(mesh);
  for (HalfEdge h = 0; h < opposite.size(); ++h) {
    if (h < opposite[h]) {
      sets.join(static_cast<std::uint32_t>(triangle_of(h)),
                static_cast<std::uint32_t>(triangle_of(opposite[h])));
    }
  }
  std::vector<std::uint32_t> root(mesh.triangles.size());
  for (std::uint32_t t = 0; t < root.size(); ++t) root[t] = sets.root(t);
  return root;
}

/// Keeps the triangles that are marked, and their vertices.
void keep(TriangleMesh& mesh, const std::vector<char>& kept) {
  std::vector<std::uint32_t> chosen;
  for (std::size_t t = 0; t < kept.size(); ++t) {
    if (kept[t] != 0) chosen.push_back(static_cast<std::uint32_t>(t));
  }
  TriangleMesh rest;
  append(rest, mesh, chosen);
  mesh = std::move(rest);
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
  const std::vector<std::uint32_t> root = components(mesh);
  std::map<std::uint32_t, Aabb> boxes;
  for (std::size_t t = 0; t < root.size(); ++t) boxes[root[t]].include(bounds(mesh, t));
  std::map<std::uint32_t, bool> inside;
  for (const auto& [first, box] : boxes) {
    inside[first] = reach.contains(box) &&
                    winding_number(solid, mesh.positions[mesh.triangles[first][0]]) > 0.5;
  }
  std::vector<char> kept(root.size());
  bool all = true;
  for (std::size_t t = 0; t < root.size(); ++t) {
    kept[t] = inside[root[t]] ? 0 : 1;
    all = all && kept[t] != 0;
  }
  if (all) return false;
  keep(mesh, kept);
  return true;
}

}  // namespace cs2mesh
